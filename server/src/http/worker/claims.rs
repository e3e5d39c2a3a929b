//! `POST /v1/worker/claims`: a worker waits for a job.
use std::time::Duration;

use axum::Json;
use axum::extract::State;
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use loadframe_api::worker::ClaimRequest;
use loadframe_client::direct::DIRECT_FROM_HEADER;
use tokio::time::{Instant, timeout_at};

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Permit, Work};
use super::super::problem::{ApiError, Result, TOKEN_NEEDED};

/// A waiting worker looks again at least this often: its row tells that it is there.
const LOOK_EVERY: Duration = Duration::from_secs(2);

/// Claim a job
///
/// Answers with the next job for this worker, and waits up to `wait_s` seconds for one. Jobs go by
/// priority, then in the order of their submission. A worker whose answer was lost on the way
/// claims again and is given the same lease. The header `Loadframe-Direct-From` of the answer, where files
/// are in a bucket, says from how many bytes on the worker may send a file there by itself.
#[utoipa::path(post, path = "/v1/worker/claims", tag = "Worker",
    request_body(content = ref("#/components/schemas/ClaimRequest"), description = "Who asks, and for what"),
    responses((status = 200, description = "A job, under a lease", body = ref("#/components/schemas/Lease"),
               headers(("Loadframe-Direct-From" = String))),
              (status = 204, description = "No job came"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema")))]
pub(super) async fn claim(
    State(state): State<AppState>,
    permit: Permit<Work>,
    body: JsonBody,
) -> Result<Response> {
    let request: ClaimRequest = message(&state, body).await?;
    let end = Instant::now() + Duration::from_secs_f64(request.wait_s);
    let mut waiting = state.store.wait_in_line(&request);
    loop {
        waiting.looks();
        if let Some(lease) = state.store.claim(&request).await? {
            metrics::counter!("loadframe_claims_total").increment(1);
            let mut answer = Json(lease).into_response();
            if let Some(bytes) = state.store.direct_from() {
                let headers = answer.headers_mut();
                headers.insert(DIRECT_FROM_HEADER, HeaderValue::from(bytes));
            }
            return Ok(answer);
        }
        let now = Instant::now();
        if now >= end {
            return Ok(StatusCode::NO_CONTENT.into_response());
        }
        let look_again = end.min(now + LOOK_EVERY);
        tokio::select! {
            // its end or a call: either way the next look tells
            _ = timeout_at(look_again, waiting.called()) => {}
            () = state.stopping.cancelled() => {
                return Err(ApiError::busy("the server is stopping", 1));
            }
        }
        // a token that was revoked while it waited gets no job
        if state
            .store
            .caller_again(&permit.call.caller)
            .await?
            .is_none()
        {
            return Err(ApiError::new(
                TOKEN_NEEDED,
                "this token is not in force any more",
            ));
        }
    }
}
