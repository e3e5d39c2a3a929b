//! `/v1/mails`: addresses that get e-mail of what happens.
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::people::{MailVerification, MailView, NewMail};
use loadframe_api::{Page, Violation};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{ManageOwn, Permit};
use super::super::problem::{ApiError, INVALID, Result};
use crate::access::Action;
use crate::mail::is_address;
use crate::store::StoreError;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(verify))
        .routes(routes!(remove))
}

/// List my addresses
#[utoipa::path(get, operation_id = "list_mails", path = "/v1/mails", tag = "People",
    responses((status = 200, description = "The newest first", body = ref("#/components/schemas/MailViewPage"))))]
async fn list(permit: Permit<ManageOwn>) -> Result<Json<Page<MailView>>> {
    let person = permit.call.person()?.id;
    Ok(Json(Page::whole(permit.store.mails(person).await?)))
}

/// Get e-mail
///
/// Of jobs of yours, or of a project that you hold. A link is sent to the address first, and nothing else
/// until it was followed.
#[utoipa::path(post, operation_id = "create_mail", path = "/v1/mails", tag = "People",
    request_body(content = ref("#/components/schemas/NewMail"), description = "Address, events, project"),
    responses((status = 201, description = "The address; a link is on its way", body = ref("#/components/schemas/MailView")),
              (status = 404, description = "There is no such project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "This server sends no e-mail"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<ManageOwn>,
    body: JsonBody,
) -> Result<(StatusCode, Json<MailView>)> {
    let new: NewMail = message(&state, body).await?;
    let person = permit.call.person()?.id;
    if let Some(project) = new.project {
        let asked = permit
            .call
            .ask_of_project(&state.store, Action::Change, project);
        asked.await?;
    }
    if !is_address(&new.address) {
        let violation = Violation::new("/address", "address", "this is no address of e-mail")
            .value(new.address)
            .allowed("an address such as anna@example.org");
        let refusal = ApiError::new(INVALID, "see what is wrong with it");
        return Err(refusal.violations(vec![violation]));
    }
    if state.ways.mailer.is_none() {
        let sentence = "this server sends no e-mail: it was started without --mail";
        return Err(StoreError::Conflict(sentence.to_owned()).into());
    }
    let made = permit.store.create_mail(person, new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Verify an address
///
/// By what the link ends with that was sent there, within two days.
#[utoipa::path(post, operation_id = "verify_mail", path = "/v1/mails/verify", tag = "People",
    request_body(content = ref("#/components/schemas/MailVerification"), description = "The secret of the link"),
    responses((status = 204, description = "From now on it gets e-mail"),
              (status = 404, description = "The link is none, is over, or was sent for somebody else"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The body is not as it should be, see `violations`")))]
async fn verify(
    State(state): State<AppState>,
    permit: Permit<ManageOwn>,
    body: JsonBody,
) -> Result<StatusCode> {
    let link: MailVerification = message(&state, body).await?;
    let person = permit.call.person()?.id;
    permit.store.verify_mail(person, &link).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// End an address
#[utoipa::path(delete, operation_id = "remove_mail", path = "/v1/mails/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the address")),
    responses((status = 204, description = "It gets no e-mail any more"),
              (status = 404, description = "You have no such address")))]
async fn remove(permit: Permit<ManageOwn>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    let person = permit.call.person()?.id;
    permit.store.remove_mail(person, id).await?;
    Ok(StatusCode::NO_CONTENT)
}
