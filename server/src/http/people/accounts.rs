//! `/v1/people`: everybody, roles, leaving, handing over; and one's own password.
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::Page;
use loadframe_api::people::{HandOver, PasswordChange, PersonChanges, PersonView};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Administer, ManageOwn, Permit, ReadPeople};
use super::super::problem::Result;
use super::sessions::check_password;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list))
        .routes(routes!(change))
        .routes(routes!(hand_over))
        .routes(routes!(change_password))
}

/// List the people
#[utoipa::path(get, operation_id = "list_people", path = "/v1/people", tag = "People",
    responses((status = 200, description = "Everybody, by name", body = ref("#/components/schemas/PersonViewPage"))))]
async fn list(permit: Permit<ReadPeople>) -> Result<Json<Page<PersonView>>> {
    let items = permit.store.people().await?;
    Ok(Json(Page::whole(items)))
}

/// Change a person's role, or end or open the account
#[utoipa::path(patch, operation_id = "change_person", path = "/v1/people/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the person")),
    request_body(content = ref("#/components/schemas/PersonChanges"), description = "What to change"),
    responses((status = 200, description = "The person", body = ref("#/components/schemas/PersonView")),
              (status = 404, description = "There is no such person"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "It is the last administrator"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The changes cannot be made, see `violations`")))]
async fn change(
    State(state): State<AppState>,
    permit: Permit<Administer>,
    Path(id): Path<Uuid>,
    body: JsonBody,
) -> Result<Json<PersonView>> {
    let changes: PersonChanges = message(&state, body).await?;
    Ok(Json(permit.store.change_person(id, changes).await?))
}

/// Hand over
///
/// All jobs and projects of a person get another owner, as when somebody leaves.
#[utoipa::path(post, operation_id = "hand_over", path = "/v1/people/{id}/hand-over", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the person who has them")),
    request_body(content = ref("#/components/schemas/HandOver"), description = "Who gets them"),
    responses((status = 204, description = "They are handed over"),
              (status = 404, description = "There is no such person"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The other cannot own jobs, see `violations`")))]
async fn hand_over(
    State(state): State<AppState>,
    permit: Permit<Administer>,
    Path(id): Path<Uuid>,
    body: JsonBody,
) -> Result<StatusCode> {
    let HandOver { to } = message(&state, body).await?;
    permit.store.hand_over(id, to).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Change my password
///
/// Ends all other sessions.
#[utoipa::path(put, operation_id = "change_password", path = "/v1/me/password", tag = "People",
    request_body(content = ref("#/components/schemas/PasswordChange"), description = "The password so far, and the new one"),
    responses((status = 204, description = "It is changed"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The new one cannot be taken, see `violations`")))]
async fn change_password(
    State(state): State<AppState>,
    permit: Permit<ManageOwn>,
    body: JsonBody,
) -> Result<StatusCode> {
    let given: PasswordChange = message(&state, body).await?;
    let person = permit.call.person()?;
    check_password(&state, &permit.call.trace, &person.name, given.current).await?;
    let session = permit.call.caller.credential.id();
    permit
        .store
        .set_password(person.id, &given.new, session)
        .await?;
    Ok(StatusCode::NO_CONTENT)
}
