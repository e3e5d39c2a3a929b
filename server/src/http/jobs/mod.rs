//! `/v1/jobs`: submit, list, read, change, delete, and ask for things.
mod edit;
mod fields;
mod list;
mod preview;
mod submit;

use axum::Json;
use axum::extract::Query;
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use loadframe_api::{JobView, WaitingView};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::conditional::EntityTag;
use super::permit::{Change, JobPermit, Read};
use super::problem::Result;
use crate::store::UserAction;

pub(super) use list::{kind_schema, outcome_schema, status_schema};
pub(super) use submit::DryRun;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(submit::create, list::list))
        .routes(routes!(read, edit::edit, delete))
        .routes(routes!(fields::fields))
        .routes(routes!(preview::preview))
        .routes(routes!(waiting))
        .routes(routes!(cancel))
        .routes(routes!(pause))
        .routes(routes!(resume))
        .routes(routes!(retry))
}

/// Read a job
///
/// With its normalised spec and, once succeeded, its results. Cheap to ask again: send the `ETag`
/// back as `If-None-Match`.
#[utoipa::path(get, operation_id = "read_job", path = "/v1/jobs/{id}", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job"),
           ("If-None-Match" = Option<String>, Header, description = "`ETag` of the answer you have")),
    responses((status = 200, description = "The job", body = ref("#/components/schemas/JobView"), headers(("ETag" = String))),
              (status = 304, description = "It has not changed"),
              (status = 404, description = "There is no such job")))]
async fn read(job: JobPermit<Read>, headers: HeaderMap) -> Result<Response> {
    // the version before the content: a change in between makes the next question ask again
    let tag = EntityTag::of_job(job.store.job_state(job.id).await?);
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    Ok(tag.json(&job.store.job(job.id).await?))
}

/// Why does a job wait?
///
/// What a queued job needs of a worker, how many of those that are there have it, and a sentence on why it
/// does not run yet.
#[utoipa::path(get, operation_id = "read_waiting", path = "/v1/jobs/{id}/waiting", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "Why it waits", body = ref("#/components/schemas/WaitingView")),
              (status = 404, description = "There is no such job"),
              (status = 409, description = "It is not queued")))]
async fn waiting(job: JobPermit<Read>) -> Result<Json<WaitingView>> {
    Ok(Json(job.store.waiting(job.id).await?))
}

/// How to delete.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Deletion {
    /// Frees its files at once; it cannot be brought back then.
    #[serde(default)]
    for_good: bool,
}

/// Delete a job
///
/// With its results, curve, log and files. It can be brought back for a while (`/v1/trash`), unless it is
/// deleted for good. A running job has to be cancelled first.
#[utoipa::path(delete, operation_id = "delete_job", path = "/v1/jobs/{id}", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job"), Deletion),
    responses((status = 204, description = "It is in the trash, or gone for good"),
              (status = 404, description = "There is no such job"),
              (status = 409, description = "It is running")))]
async fn delete(job: JobPermit<Change>, Query(deletion): Query<Deletion>) -> Result<StatusCode> {
    match deletion.for_good {
        true => job.store.delete(job.id).await?,
        false => job.store.discard(job.id).await?,
    }
    Ok(StatusCode::NO_CONTENT)
}

/// Cancel a job
///
/// A queued or paused job ends at once, a running one within two seconds; what was computed so
/// far is kept as its curve.
#[utoipa::path(post, operation_id = "cancel_job", path = "/v1/jobs/{id}/cancel", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The job; cancelled, or about to be", body = ref("#/components/schemas/JobView")),
              (status = 404, description = "There is no such job"),
              (status = 409, description = "It has ended already")))]
async fn cancel(job: JobPermit<Change>) -> Result<Json<JobView>> {
    request(job, UserAction::Cancel).await
}

/// Pause a job
///
/// A running job leaves a checkpoint and frees its worker.
#[utoipa::path(post, operation_id = "pause_job", path = "/v1/jobs/{id}/pause", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The job; paused, or about to be", body = ref("#/components/schemas/JobView")),
              (status = 404, description = "There is no such job"),
              (status = 409, description = "It has ended")))]
async fn pause(job: JobPermit<Change>) -> Result<Json<JobView>> {
    request(job, UserAction::Pause).await
}

/// Resume a paused job
///
/// It is queued again and goes on from its checkpoint.
#[utoipa::path(post, operation_id = "resume_job", path = "/v1/jobs/{id}/resume", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The job, queued", body = ref("#/components/schemas/JobView")),
              (status = 404, description = "There is no such job"),
              (status = 409, description = "It has ended")))]
async fn resume(job: JobPermit<Change>) -> Result<Json<JobView>> {
    request(job, UserAction::Resume).await
}

/// Run a job again
///
/// For jobs that ended without a result; earlier attempts stay on record.
#[utoipa::path(post, operation_id = "retry_job", path = "/v1/jobs/{id}/retry", tag = "Jobs",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The job, queued", body = ref("#/components/schemas/JobView")),
              (status = 404, description = "There is no such job"),
              (status = 409, description = "It has a result, is running or paused")))]
async fn retry(job: JobPermit<Change>) -> Result<Json<JobView>> {
    request(job, UserAction::Retry).await
}

async fn request(job: JobPermit<Change>, action: UserAction) -> Result<Json<JobView>> {
    Ok(Json(job.store.request(job.id, action).await?))
}
