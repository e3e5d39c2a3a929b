//! `/v1/shares`: links that show one job or one project to whoever has them.
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use loadframe_api::people::{NewShare, Role, ShareMade, ShareView};
use loadframe_api::{Page, Violation};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Change, ManageOwn, Permit};
use super::super::problem::{ApiError, INVALID, Result};
use crate::access::Action;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(revoke))
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct ShareQuery {
    /// Only links to this job.
    #[param(value_type = Uuid, required = false)]
    job: Option<Uuid>,
}

/// List share links
///
/// One's own and those to one's jobs; administrators see all.
#[utoipa::path(get, operation_id = "list_shares", path = "/v1/shares", tag = "People",
    params(ShareQuery),
    responses((status = 200, description = "The newest first, without their secrets", body = ref("#/components/schemas/ShareViewPage"))))]
async fn list(
    permit: Permit<ManageOwn>,
    Query(query): Query<ShareQuery>,
) -> Result<Json<Page<ShareView>>> {
    let sight = permit.call.sight(&permit.store).await?;
    let person = permit.call.person()?.id;
    let items = permit.store.shares(person, &sight, query.job).await?;
    Ok(Json(Page::whole(items)))
}

/// Make a share link
///
/// Whoever has it reads that job, or the jobs of that project, and nothing else, without an account.
#[utoipa::path(post, operation_id = "create_share", path = "/v1/shares", tag = "People",
    request_body(content = ref("#/components/schemas/NewShare"), description = "What it shows, and for how long"),
    responses((status = 201, description = "The link", body = ref("#/components/schemas/ShareMade")),
              (status = 404, description = "There is no such job or project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<Change>,
    body: JsonBody,
) -> Result<(StatusCode, Json<ShareMade>)> {
    let new: NewShare = message(&state, body).await?;
    let person = permit.call.person()?.id;
    match (new.job, new.project) {
        (Some(job), None) => {
            permit
                .call
                .ask_of_job(&state.store, Action::Change, job)
                .await?;
        }
        (None, Some(project)) => {
            permit
                .call
                .ask_of_project(&state.store, Action::Change, project)
                .await?;
        }
        _ => {
            let violation = Violation::new("", "one_object", "a link shows one job or one project")
                .allowed("one of: job, project");
            let refusal = ApiError::new(INVALID, "see what is wrong with it");
            return Err(refusal.violations(vec![violation]));
        }
    }
    let made = permit.store.create_share(person, new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Take a share link back
#[utoipa::path(delete, operation_id = "revoke_share", path = "/v1/shares/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the link")),
    responses((status = 204, description = "It shows nothing any more"),
              (status = 404, description = "You have no such link")))]
async fn revoke(permit: Permit<ManageOwn>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    let person = permit.call.person()?;
    let is_administrator = person.role == Role::Administrator;
    permit
        .store
        .revoke_share(person.id, is_administrator, id)
        .await?;
    Ok(StatusCode::NO_CONTENT)
}
