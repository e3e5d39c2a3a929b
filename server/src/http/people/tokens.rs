//! `/v1/tokens`: one's own tokens, and those of workers.
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::Page;
use loadframe_api::people::{NewToken, Role, Scope, TokenMade, TokenView};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{ManageOwn, Permit};
use super::super::problem::Result;
use crate::access::{Action, Object};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(revoke))
}

/// List tokens
///
/// One's own; administrators see all.
#[utoipa::path(get, operation_id = "list_tokens", path = "/v1/tokens", tag = "People",
    responses((status = 200, description = "The newest first, without their secrets", body = ref("#/components/schemas/TokenViewPage"))))]
async fn list(permit: Permit<ManageOwn>) -> Result<Json<Page<TokenView>>> {
    let items = permit.store.tokens(whose(&permit)?).await?;
    Ok(Json(Page::whole(items)))
}

/// Make a token
///
/// Its secret is shown this once. Administrators make those of workers, which see the spec of every job.
#[utoipa::path(post, operation_id = "create_token", path = "/v1/tokens", tag = "People",
    request_body(content = ref("#/components/schemas/NewToken"), description = "What for, and what it may do"),
    responses((status = 201, description = "The token", body = ref("#/components/schemas/TokenMade")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<ManageOwn>,
    body: JsonBody,
) -> Result<(StatusCode, Json<TokenMade>)> {
    let new: NewToken = message(&state, body).await?;
    if new.scope == Scope::Worker {
        permit.call.ask(Action::Administer, Object::Lab)?;
    }
    let person = permit.call.person()?.id;
    let made = permit.store.create_token(Some(person), new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Revoke a token
///
/// The next request that uses it is refused, and streams that were opened with it end.
#[utoipa::path(delete, operation_id = "revoke_token", path = "/v1/tokens/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the token")),
    responses((status = 204, description = "It is out of force"),
              (status = 404, description = "You have no such token")))]
async fn revoke(permit: Permit<ManageOwn>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    permit.store.revoke_token(id, whose(&permit)?).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Whose tokens the caller looks after; nobody in particular's for administrators.
fn whose(permit: &Permit<ManageOwn>) -> Result<Option<Uuid>> {
    let person = permit.call.person()?;
    Ok(Some(person.id).filter(|_| person.role != Role::Administrator))
}
