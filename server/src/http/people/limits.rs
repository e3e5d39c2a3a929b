//! `/v1/me/limits` and `/v1/people/{id}/limits`: how much a person may use.
use axum::Json;
use axum::extract::{Path, State};
use loadframe_api::people::{Allowance, PersonLimits};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Administer, Permit, Read};
use super::super::problem::Result;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(read))
        .routes(routes!(set))
}

/// How much may I use?
///
/// Limits, use, and what is left. Whoever is no person with an account has no limits.
#[utoipa::path(get, operation_id = "read_my_limits", path = "/v1/me/limits", tag = "People",
    responses((status = 200, description = "Limits, use and what is left", body = ref("#/components/schemas/Allowance"))))]
async fn read(permit: Permit<Read>) -> Result<Json<Allowance>> {
    let allowance = match permit.call.caller.person() {
        Some(person) => permit.store.allowance(person.id).await?,
        None => Allowance::default(),
    };
    Ok(Json(allowance))
}

/// Set how much a person may use
///
/// All limits at once; what is left out has none. Running jobs go on where they are more than may run
/// now, and queued ones stay queued.
#[utoipa::path(put, operation_id = "set_limits", path = "/v1/people/{id}/limits", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the person")),
    request_body(content = ref("#/components/schemas/PersonLimits"), description = "The limits"),
    responses((status = 200, description = "Limits, use and what is left", body = ref("#/components/schemas/Allowance")),
              (status = 404, description = "There is no such person"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The limits cannot be set, see `violations`")))]
async fn set(
    State(state): State<AppState>,
    permit: Permit<Administer>,
    Path(id): Path<Uuid>,
    body: JsonBody,
) -> Result<Json<Allowance>> {
    let limits: PersonLimits = message(&state, body).await?;
    Ok(Json(permit.store.set_limits(id, limits).await?))
}
