//! `PATCH /v1/jobs/{id}`.
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use loadframe_api::{JobChanges, Message};

use super::super::AppState;
use super::super::body::JsonBody;
use super::super::conditional::EntityTag;
use super::super::permit::{Change, JobPermit};
use super::super::problem::Result;
use crate::access::Action;
use crate::store::JobEdit;

/// Change name, notes, tags, priority or the overrun factor
///
/// What is left out stays as it is (JSON Merge Patch, RFC 7396, without deletions). The spec of a
/// job never changes. Of two people who edit at once, who sends `If-Match` overwrites nothing unseen.
#[utoipa::path(patch, operation_id = "change_job", path = "/v1/jobs/{id}", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job"),
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
    job: JobPermit<Change>,
    headers: HeaderMap,
    body: JsonBody,
) -> Result<Response> {
    let client = body.client;
    let read = move || JobChanges::from_slice(&body.bytes);
    let JobChanges {
        name,
        notes,
        tags,
        priority,
        overrun_factor,
        project,
    } = state.checks.run(client, read).await??;
    if let Some(project) = project {
        let wanted = job
            .call
            .ask_of_project(&state.store, Action::Submit, project);
        wanted.await?;
    }
    // only what would be done otherwise depends on it (RFC 9110, 13.2.1)
    let known_version = EntityTag::version_to_match(&headers)?;
    let edit = JobEdit {
        name,
        notes,
        tags,
        priority,
        overrun_factor,
        project,
        known_version,
    };
    job.store.edit(job.id, edit).await?;
    let tag = EntityTag::of_job(state.store.job_state(job.id).await?);
    Ok(tag.json(&state.store.job(job.id).await?))
}
