//! `/v1/webhooks`: addresses that are told what happens.
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::people::{NewWebhook, WebhookMade, WebhookView};
use loadframe_api::{Page, Violation};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{ManageOwn, Permit};
use super::super::problem::{ApiError, INVALID, Result};
use crate::access::Action;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(remove))
}

/// List my webhooks
#[utoipa::path(get, operation_id = "list_webhooks", path = "/v1/webhooks", tag = "People",
    responses((status = 200, description = "The newest first, without their secrets", body = ref("#/components/schemas/WebhookViewPage"))))]
async fn list(permit: Permit<ManageOwn>) -> Result<Json<Page<WebhookView>>> {
    let person = permit.call.person()?.id;
    Ok(Json(Page::whole(permit.store.webhooks(person).await?)))
}

/// Make a webhook
///
/// Its secret is shown this once. It is told of jobs of yours, or of a project that you hold. Private
/// addresses are refused unless the server was told to take them.
#[utoipa::path(post, operation_id = "create_webhook", path = "/v1/webhooks", tag = "People",
    request_body(content = ref("#/components/schemas/NewWebhook"), description = "Address, events, project"),
    responses((status = 201, description = "The webhook", body = ref("#/components/schemas/WebhookMade")),
              (status = 404, description = "There is no such project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<ManageOwn>,
    body: JsonBody,
) -> Result<(StatusCode, Json<WebhookMade>)> {
    let new: NewWebhook = message(&state, body).await?;
    let person = permit.call.person()?.id;
    if let Some(project) = new.project {
        let asked = permit
            .call
            .ask_of_project(&state.store, Action::Change, project);
        asked.await?;
    }
    state
        .ways
        .addresses
        .look_up(&new.url)
        .await
        .map_err(|error| {
            let violation = Violation::new("/url", "address", error.to_string())
                .value(new.url.clone())
                .allowed("an address of http or https in the open internet");
            ApiError::new(INVALID, "see what is wrong with it").violations(vec![violation])
        })?;
    let made = permit.store.create_webhook(person, new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// End a webhook
#[utoipa::path(delete, operation_id = "remove_webhook", path = "/v1/webhooks/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the webhook")),
    responses((status = 204, description = "It is told nothing any more"),
              (status = 404, description = "You have no such webhook")))]
async fn remove(permit: Permit<ManageOwn>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    let person = permit.call.person()?.id;
    permit.store.remove_webhook(person, id).await?;
    Ok(StatusCode::NO_CONTENT)
}
