//! `/v1/invitations`: how people come.
use std::time::Instant;

use axum::Json;
use axum::extract::{Extension, Path, State};
use axum::http::{HeaderMap, Method, StatusCode, Uri};
use loadframe_api::Page;
use loadframe_api::people::{
    Acceptance, InvitationMade, InvitationView, NewInvitation, PersonView,
};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::guard::too_many;
use super::super::permit::{Administer, Permit, Trace};
use super::super::problem::Result;
use super::sessions::is_secure;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, invite))
        .routes(routes!(accept))
        .routes(routes!(revoke))
}

/// Invite somebody
///
/// Give the person the address of the page with `path` behind it; it is shown this once.
#[utoipa::path(post, operation_id = "invite", path = "/v1/invitations", tag = "People",
    request_body(content = ref("#/components/schemas/NewInvitation"), description = "Role and groups"),
    responses((status = 201, description = "The invitation", body = ref("#/components/schemas/InvitationMade")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn invite(
    State(state): State<AppState>,
    permit: Permit<Administer>,
    body: JsonBody,
) -> Result<(StatusCode, Json<InvitationMade>)> {
    let new: NewInvitation = message(&state, body).await?;
    let made = permit.store.invite(new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// List the invitations
#[utoipa::path(get, operation_id = "list_invitations", path = "/v1/invitations", tag = "People",
    responses((status = 200, description = "The newest first", body = ref("#/components/schemas/InvitationViewPage"))))]
async fn list(permit: Permit<Administer>) -> Result<Json<Page<InvitationView>>> {
    let items = permit.store.invitations().await?;
    Ok(Json(Page::whole(items)))
}

/// Take an invitation back
#[utoipa::path(delete, operation_id = "revoke_invitation", path = "/v1/invitations/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the invitation")),
    responses((status = 204, description = "It is not in force any more"),
              (status = 404, description = "There is no such invitation"),
              (status = 409, description = "It was accepted")))]
async fn revoke(permit: Permit<Administer>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    permit.store.revoke_invitation(id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Accept an invitation
///
/// Opens the account; signing in follows.
#[utoipa::path(post, operation_id = "accept_invitation", path = "/v1/invitations/accept", tag = "People",
    request_body(content = ref("#/components/schemas/Acceptance"), description = "The secret of the link, a name and a password"),
    responses((status = 201, description = "The account is open", body = ref("#/components/schemas/PersonView")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The invitation is not in force, or name or password cannot be taken, see `violations`")))]
async fn accept(
    State(state): State<AppState>,
    Extension(trace): Extension<Trace>,
    method: Method,
    uri: Uri,
    headers: HeaderMap,
    body: JsonBody,
) -> Result<(StatusCode, Json<PersonView>)> {
    state.access.names.demand_origin(&method, &uri, &headers)?;
    is_secure(&state, &headers)?;
    let given: Acceptance = message(&state, body).await?;
    let wrong = &state.access.wrong_passwords;
    let slow = |wait| too_many("too many wrong invitations, wait a moment", wait);
    wrong.check(&trace.address, Instant::now()).map_err(slow)?;
    let store = state.store.acting(trace.actor(None));
    match store.accept_invitation(given).await {
        Ok(person) => Ok((StatusCode::CREATED, Json(person))),
        Err(error) => {
            wrong.count(trace.address, Instant::now()).map_err(slow)?;
            Err(error.into())
        }
    }
}
