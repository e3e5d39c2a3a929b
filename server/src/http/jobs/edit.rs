//! `PATCH /v1/jobs/{id}`.
use axum::Json;
use axum::extract::State;
use loadframe_api::{JobChanges, JobView, Message};

use super::super::AppState;
use super::super::body::JsonBody;
use super::super::permit::{Change, JobPermit};
use super::super::problem::Result;
use crate::access::Action;
use crate::store::JobEdit;

/// Change name, notes, tags or priority
///
/// What is left out stays as it is (JSON Merge Patch, RFC 7396, without deletions). The spec of a
/// job never changes.
#[utoipa::path(patch, operation_id = "change_job", path = "/v1/jobs/{id}", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    request_body(content = ref("#/components/schemas/JobChanges"), description = "What to change"),
    responses((status = 200, description = "The changed job", body = ref("#/components/schemas/JobView")),
              (status = 404, description = "There is no such job"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is larger than 32 MB"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The changes cannot be made, see `violations`")))]
pub(super) async fn edit(
    State(state): State<AppState>,
    job: JobPermit<Change>,
    body: JsonBody,
) -> Result<Json<JobView>> {
    let client = body.client;
    let read = move || JobChanges::from_slice(&body.bytes);
    let JobChanges {
        name,
        notes,
        tags,
        priority,
        project,
    } = state.checks.run(client, read).await??;
    if let Some(project) = project {
        let wanted = job
            .call
            .ask_of_project(&state.store, Action::Submit, project);
        wanted.await?;
    }
    let edit = JobEdit {
        name,
        notes,
        tags,
        priority,
        project,
    };
    Ok(Json(job.store.edit(job.id, edit).await?))
}
