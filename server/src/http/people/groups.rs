//! `/v1/groups`: people who work together.
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::Page;
use loadframe_api::people::{GroupView, NewGroup};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Administer, Permit, ReadPeople};
use super::super::problem::Result;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(add, remove))
}

/// List the groups
#[utoipa::path(get, operation_id = "list_groups", path = "/v1/groups", tag = "People",
    responses((status = 200, description = "All groups with their members", body = ref("#/components/schemas/GroupViewPage"))))]
async fn list(permit: Permit<ReadPeople>) -> Result<Json<Page<GroupView>>> {
    let items = permit.store.groups().await?;
    Ok(Json(Page::whole(items)))
}

/// Make a group
#[utoipa::path(post, operation_id = "create_group", path = "/v1/groups", tag = "People",
    request_body(content = ref("#/components/schemas/NewGroup"), description = "Its name"),
    responses((status = 201, description = "The group", body = ref("#/components/schemas/GroupView")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<Administer>,
    body: JsonBody,
) -> Result<(StatusCode, Json<GroupView>)> {
    let NewGroup { name } = message(&state, body).await?;
    let made = permit.store.create_group(&name).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Put a person into a group
#[utoipa::path(put, operation_id = "add_member", path = "/v1/groups/{id}/members/{person}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the group"), ("person" = Uuid, Path, description = "Id of the person")),
    responses((status = 204, description = "The person is a member"),
              (status = 404, description = "There is no such group or person")))]
async fn add(
    permit: Permit<Administer>,
    Path((id, person)): Path<(Uuid, Uuid)>,
) -> Result<StatusCode> {
    permit.store.set_member(id, person, true).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Take a person out of a group
#[utoipa::path(delete, operation_id = "remove_member", path = "/v1/groups/{id}/members/{person}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the group"), ("person" = Uuid, Path, description = "Id of the person")),
    responses((status = 204, description = "The person is no member"),
              (status = 404, description = "There is no such group or person")))]
async fn remove(
    permit: Permit<Administer>,
    Path((id, person)): Path<(Uuid, Uuid)>,
) -> Result<StatusCode> {
    permit.store.set_member(id, person, false).await?;
    Ok(StatusCode::NO_CONTENT)
}
