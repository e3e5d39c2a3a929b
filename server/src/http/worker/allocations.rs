//! What waits for workers, and the allocations of batch systems that are asked for them.
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use loadframe_api::allocations::{AllocationReport, Backlog, ReportedAllocations};
use loadframe_api::{Page, Timestamp};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Permit, ReadWorkers, Work};
use super::super::problem::Result;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(backlog))
        .routes(routes!(report))
        .routes(routes!(list))
}

/// Tell what waits
///
/// How many jobs wait and what they need, for whoever starts workers. A worker's token is enough: it
/// names no job.
#[utoipa::path(get, operation_id = "read_backlog", path = "/v1/worker/backlog", tag = "Worker",
    responses((status = 200, description = "What waits", body = ref("#/components/schemas/Backlog"))))]
async fn backlog(permit: Permit<Work>) -> Result<Json<Backlog>> {
    Ok(Json(permit.store.backlog().await?))
}

/// Report allocations
///
/// What a batch system gives to workers, as whoever asks it for machines sees it.
#[utoipa::path(put, operation_id = "report_allocations", path = "/v1/worker/allocations", tag = "Worker",
    request_body(content = ref("#/components/schemas/AllocationReport"), description = "All allocations of this source"),
    responses((status = 204, description = "The report is kept for ten minutes"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema")))]
async fn report(
    State(state): State<AppState>,
    _permit: Permit<Work>,
    body: JsonBody,
) -> Result<StatusCode> {
    let report: AllocationReport = message(&state, body).await?;
    state.allocations.take(report, Timestamp::now());
    Ok(StatusCode::NO_CONTENT)
}

/// List the allocations
///
/// What batch systems give to workers, by those who asked for it lately.
#[utoipa::path(get, operation_id = "list_allocations", path = "/v1/allocations", tag = "Workers",
    responses((status = 200, description = "The latest report of every source", body = ref("#/components/schemas/ReportedAllocationsPage"))))]
async fn list(
    State(state): State<AppState>,
    _permit: Permit<ReadWorkers>,
) -> Json<Page<ReportedAllocations>> {
    Json(Page::whole(state.allocations.latest(Timestamp::now())))
}
