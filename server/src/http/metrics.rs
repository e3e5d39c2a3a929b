//! Prometheus metrics: requests as they are counted, the queue as it is when asked.
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use axum::extract::{MatchedPath, Request};
use axum::http::header;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::permit::{Permit, ReadMetrics};
use super::problem::{ApiError, Result};

/// Upper bounds [s] of the buckets of request times: from a cached read to a long poll.
const BUCKETS: &[f64] = &[
    0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0,
];

/// How often recorded times are folded into buckets.
const FOLDING: Duration = Duration::from_secs(5);

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(read))
}

/// The recorder of this process, installed on first use.
fn recorder() -> Option<&'static PrometheusHandle> {
    static HANDLE: OnceLock<Option<PrometheusHandle>> = OnceLock::new();
    let handle = HANDLE.get_or_init(|| {
        let builder = PrometheusBuilder::new().set_buckets(BUCKETS).ok()?;
        let handle = builder.install_recorder().ok()?;
        describe();
        Some(handle)
    });
    handle.as_ref()
}

fn describe() {
    use metrics::{
        describe_counter as counter, describe_gauge as gauge, describe_histogram as histogram,
    };
    histogram!(
        "loadframe_http_request_seconds",
        "Time to an answer's head by route, method and status"
    );
    counter!("loadframe_submissions_total", "Jobs accepted, by kind");
    counter!("loadframe_claims_total", "Jobs handed to workers");
    counter!("loadframe_curve_points_total", "Curve points stored");
    counter!(
        "loadframe_leases_lost_total",
        "Writes of workers refused because the lease had ended"
    );
    gauge!(
        "loadframe_connections",
        "Connections when the last was accepted"
    );
    counter!(
        "loadframe_connections_ended_total",
        "Connections ended because their client was slow, was displaced by another, or found no place"
    );
    counter!(
        "loadframe_requests_refused_total",
        "Requests refused because too many a second came with one token or from one address"
    );
    gauge!("loadframe_jobs", "Jobs by status, finished ones by outcome");
    gauge!(
        "loadframe_queue_age_seconds",
        "How long the oldest queued job has been waiting"
    );
    gauge!(
        "loadframe_workers_alive",
        "Workers heard of within their lease"
    );
    gauge!(
        "loadframe_workers_set_aside",
        "Of these, workers that are given no jobs for a while after a fault of their machine"
    );
    gauge!(
        "loadframe_attempts_lost",
        "Attempts that ended because their worker fell silent"
    );
    gauge!(
        "loadframe_store_full",
        "1 while the disk is full: jobs, results and claims wait"
    );
    gauge!(
        "loadframe_store_restarts",
        "How often the writer and the collector of the store were taken up again after they failed"
    );
    gauge!(
        "loadframe_files_unnamed",
        "Stored files that no job names, which wait before they are removed"
    );
    gauge!(
        "loadframe_files_lost",
        "Files that jobs name and that the last scrub found missing or changed"
    );
    gauge!(
        "loadframe_file_bytes",
        "Size of all stored result files and checkpoints"
    );
}

/// Prometheus metrics
#[utoipa::path(get, operation_id = "read_metrics", path = "/metrics", tag = "Service",
    responses((status = 200, description = "Metrics as Prometheus text", body = String, content_type = "text/plain")))]
async fn read(permit: Permit<ReadMetrics>) -> Result<Response> {
    let Some(recorder) = recorder() else {
        return Err(ApiError::busy(
            "another recorder of metrics is in place",
            60,
        ));
    };
    let counts = permit.store.counts().await?;
    let jobs = [
        ("queued", counts.queued),
        ("running", counts.running),
        ("paused", counts.paused),
        ("succeeded", counts.succeeded),
        ("failed", counts.failed),
        ("cancelled", counts.cancelled),
        ("timed_out", counts.timed_out),
        ("quarantined", counts.quarantined),
    ];
    for (status, count) in jobs {
        metrics::gauge!("loadframe_jobs", "status" => status).set(count as f64);
    }
    metrics::gauge!("loadframe_queue_age_seconds").set(counts.oldest_queued_s);
    metrics::gauge!("loadframe_workers_alive").set(counts.workers_alive as f64);
    metrics::gauge!("loadframe_workers_set_aside").set(counts.workers_set_aside as f64);
    metrics::gauge!("loadframe_attempts_lost").set(counts.attempts_lost as f64);
    metrics::gauge!("loadframe_file_bytes").set(counts.file_bytes as f64);
    metrics::gauge!("loadframe_store_full").set(f64::from(u8::from(counts.is_full)));
    for (task, restarts) in [
        ("writer", counts.writer_restarts),
        ("collector", counts.collector_restarts),
    ] {
        metrics::gauge!("loadframe_store_restarts", "task" => task).set(restarts as f64);
    }
    metrics::gauge!("loadframe_files_unnamed").set(counts.files_unnamed as f64);
    metrics::gauge!("loadframe_files_lost").set(counts.files_lost as f64);
    let media_type = "text/plain; version=0.0.4; charset=utf-8";
    Ok(([(header::CONTENT_TYPE, media_type)], recorder.render()).into_response())
}

/// Folds what was recorded into its buckets now and then, so that a server nobody scrapes does
/// not keep every single time.
pub(crate) async fn keep_folded() {
    let mut pause = tokio::time::interval(FOLDING);
    loop {
        pause.tick().await;
        if let Some(recorder) = recorder() {
            recorder.run_upkeep();
        }
    }
}

/// Times every request.
pub(super) async fn count(request: Request, next: Next) -> Response {
    recorder();
    let start = Instant::now();
    let route = request.extensions().get::<MatchedPath>();
    // what no route matches is one series, not as many as people can think of
    let route = route.map_or_else(|| "other".to_owned(), |path| path.as_str().to_owned());
    let method = match request.method().as_str() {
        known @ ("GET" | "HEAD" | "POST" | "PUT" | "PATCH" | "DELETE" | "OPTIONS") => {
            known.to_owned()
        }
        _ => "other".to_owned(),
    };
    let response = next.run(request).await;
    let status = response.status().as_u16().to_string();
    metrics::histogram!("loadframe_http_request_seconds", "route" => route, "method" => method, "status" => status)
        .record(start.elapsed().as_secs_f64());
    response
}
