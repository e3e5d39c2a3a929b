//! What waits for workers, and the allocations of batch systems that are asked for them.
//!
//! Reports are kept in memory: they are news, repeated every half minute by whoever has them.
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

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

/// A report is forgotten after so long [ms].
const REMEMBERED: i64 = 600_000;
/// Sources whose reports are kept; beyond it the one silent for longest is forgotten.
const MOST_SOURCES: usize = 50;

/// The latest report of every source.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Reports(Arc<Mutex<BTreeMap<String, ReportedAllocations>>>);

impl Reports {
    fn take(&self, report: AllocationReport, now: Timestamp) {
        let mut reports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let latest = ReportedAllocations {
            source: report.source.clone(),
            reported_at: now,
            allocations: report.allocations,
            trouble: report.trouble,
        };
        reports.insert(report.source, latest);
        if reports.len() > MOST_SOURCES
            && let Some(oldest) = reports.values().min_by_key(|report| report.reported_at)
        {
            let oldest = oldest.source.clone();
            reports.remove(&oldest);
        }
    }

    fn latest(&self, now: Timestamp) -> Vec<ReportedAllocations> {
        let mut reports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        reports.retain(|_, report| now.0 - report.reported_at.0 < REMEMBERED);
        reports.values().cloned().collect()
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::allocations::AllocationView;

    fn report(source: &str, state: &str) -> AllocationReport {
        AllocationReport {
            source: source.to_owned(),
            allocations: vec![AllocationView {
                id: "7_0".to_owned(),
                state: state.to_owned(),
                reason: None,
            }],
            trouble: None,
        }
    }

    #[test]
    fn a_report_takes_the_place_of_the_one_before_and_is_forgotten_in_time() {
        let reports = Reports::default();
        reports.take(report("slurm on a", "PENDING"), Timestamp(0));
        reports.take(report("slurm on b", "PENDING"), Timestamp(1));
        reports.take(report("slurm on a", "RUNNING"), Timestamp(2));
        let latest = reports.latest(Timestamp(3));
        let states: Vec<&str> = latest
            .iter()
            .map(|report| report.allocations[0].state.as_str())
            .collect();
        assert_eq!(states, ["RUNNING", "PENDING"]);
        let later = reports.latest(Timestamp(REMEMBERED + 1));
        assert_eq!(later.len(), 1, "{later:?}");
    }

    #[test]
    fn sources_are_bounded() {
        let reports = Reports::default();
        for number in 0..200 {
            reports.take(report(&number.to_string(), "PENDING"), Timestamp(number));
        }
        let latest = reports.latest(Timestamp(200));
        assert_eq!(latest.len(), MOST_SOURCES);
        assert!(latest.iter().all(|report| report.reported_at.0 >= 150));
    }
}
