//! What a worker says under its lease.
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use loadframe_api::worker::{
    CompleteRequest, FailRequest, FaultRequest, HeartbeatAnswer, ProgressReport, ReleaseReason,
    ReleaseRequest,
};

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::problem::Result;
use super::request::{LeaseCredentials, counted};

/// Extend the lease
///
/// Tells the server that the worker lives; the answer says what the user wants of the attempt.
#[utoipa::path(post, path = "/v1/worker/leases/{id}/heartbeat", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    responses((status = 200, description = "The lease is extended", body = ref("#/components/schemas/HeartbeatAnswer")),
              (status = 409, description = "The lease is no longer held")))]
pub(super) async fn heartbeat(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
) -> Result<Json<HeartbeatAnswer>> {
    let command = counted(state.store.heartbeat(key).await)?;
    Ok(Json(HeartbeatAnswer { command }))
}

/// Report progress, curve points and log lines
///
/// Counts as a heartbeat. Points are numbered; those the server has already are passed over, so a
/// report may be repeated. A gap is refused.
#[utoipa::path(post, path = "/v1/worker/leases/{id}/progress", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/ProgressReport"), description = "What is new"),
    responses((status = 200, description = "The report is stored", body = ref("#/components/schemas/HeartbeatAnswer")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema, or leaves a gap in the curve")))]
pub(super) async fn progress(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    body: JsonBody,
) -> Result<Json<HeartbeatAnswer>> {
    let report: ProgressReport = message(&state, body).await?;
    let points = report.points.as_ref().map_or(0, |block| block.rows.len());
    let command = counted(state.store.report(key, &report).await)?;
    metrics::counter!("loadframe_curve_points_total").increment(points as u64);
    Ok(Json(HeartbeatAnswer { command }))
}

/// Publish the result
///
/// Every file must have been uploaded under this lease with the same content. From here on the job
/// has succeeded, unless it was cancelled before: then it is cancelled, and nothing is published.
/// The same message may be repeated.
#[utoipa::path(post, path = "/v1/worker/leases/{id}/complete", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/CompleteRequest"), description = "The outcome and its files"),
    responses((status = 204, description = "The job has ended"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema, files are missing, or the outcome is of another spec")))]
pub(super) async fn complete(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    body: JsonBody,
) -> Result<StatusCode> {
    let request: CompleteRequest = message(&state, body).await?;
    counted(state.store.complete(key, &request).await)?;
    Ok(StatusCode::NO_CONTENT)
}

/// End the job without a result
///
/// The same message may be repeated.
#[utoipa::path(post, path = "/v1/worker/leases/{id}/fail", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/FailRequest"), description = "What happened"),
    responses((status = 204, description = "The job has ended"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema")))]
pub(super) async fn fail(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    body: JsonBody,
) -> Result<StatusCode> {
    let request: FailRequest = message(&state, body).await?;
    counted(state.store.fail(key, &request).await)?;
    Ok(StatusCode::NO_CONTENT)
}

/// Send the job to another machine
///
/// For a fault of this one: a full disk, no memory, no threads. It costs the job nothing; this machine is
/// given no jobs for a while, the longer the more often. A job that three machines could not carry out
/// has failed. The same message may be repeated.
#[utoipa::path(post, path = "/v1/worker/leases/{id}/fault", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/FaultRequest"), description = "What is wrong with the machine"),
    responses((status = 204, description = "The job goes to another machine"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema")))]
pub(super) async fn fault(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    body: JsonBody,
) -> Result<StatusCode> {
    let request: FaultRequest = message(&state, body).await?;
    counted(state.store.fault(key, &request).await)?;
    Ok(StatusCode::NO_CONTENT)
}

/// Give the lease back
///
/// The job is cancelled or paused if its user asked for that, paused if it has taken more than its limits,
/// and else queued again, at no charge.
/// The same message may be repeated.
#[utoipa::path(post, path = "/v1/worker/leases/{id}/release", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/ReleaseRequest"), description = "Why"),
    responses((status = 204, description = "The lease is given back"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema")))]
pub(super) async fn release(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    body: JsonBody,
) -> Result<StatusCode> {
    let request: ReleaseRequest = message(&state, body).await?;
    let released = match request.reason {
        ReleaseReason::BeyondEstimate => {
            let detail = request
                .detail
                .as_deref()
                .unwrap_or("it has taken more than its limit");
            state.store.exceed_estimate(key, detail).await
        }
        reason => state.store.release(key, reason).await,
    };
    counted(released)?;
    Ok(StatusCode::NO_CONTENT)
}
