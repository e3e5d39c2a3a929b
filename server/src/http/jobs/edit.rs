//! `PATCH /v1/jobs/{id}`.
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::response::Response;
use loadframe_api::{JobChanges, Message};
use uuid::Uuid;

use super::super::AppState;
use super::super::body::JsonBody;
use super::super::conditional::EntityTag;
use super::super::problem::Result;
use crate::store::JobEdit;

/// Change name, notes, tags or priority
///
/// What is left out stays as it is (JSON Merge Patch, RFC 7396, without deletions). The spec of a
/// job never changes. Of two people who edit at once, who sends `If-Match` overwrites nothing unseen.
#[utoipa::path(patch, operation_id = "change_job", path = "/v1/jobs/{id}", tag = "Jobs",
    params(("id" = Uuid, Path, description = "Id of the job"),
           ("If-Match" = Option<String>, Header, description = "`ETag` of the job as you read it, or the number of an event of its stream in quotes: what somebody else has changed since is not overwritten")),
    request_body(content = ref("#/components/schemas/JobChanges"), description = "What to change"),
    responses((status = 200, description = "The changed job", body = ref("#/components/schemas/JobView"), headers(("ETag" = String))),
              (status = 404, description = "There is no such job"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 412, description = "Name, notes, tags or priority have been changed since what `If-Match` names"),
              (status = 413, description = "The body is larger than 32 MB"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The changes cannot be made, see `violations`")))]
pub(super) async fn edit(
    State(state): State<AppState>,
    Path(id): Path<Uuid>,
    headers: HeaderMap,
    body: JsonBody,
) -> Result<Response> {
    let known_version = EntityTag::version_to_match(&headers)?;
    let client = body.client;
    let read = move || JobChanges::from_slice(&body.bytes);
    let JobChanges {
        name,
        notes,
        tags,
        priority,
    } = state.checks.run(client, read).await??;
    let edit = JobEdit {
        name,
        notes,
        tags,
        priority,
        known_version,
    };
    state.store.edit(id, edit).await?;
    let tag = EntityTag::weak(state.store.job_version(id).await?);
    Ok(tag.json(&state.store.job(id).await?))
}
