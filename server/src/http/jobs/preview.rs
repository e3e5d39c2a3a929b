//! `POST /v1/jobs/preview`: the specimen, before the job is submitted.
//!
//! What draws it is part of the engine, which this library does not know: whoever composes the executable
//! hands it in ([`crate::ServeConfig::preview`]). It runs where bodies are checked, with a turn of its own.
use axum::Json;
use axum::extract::State;
use loadframe_api::{Extent, Preview, Violation};

use super::super::AppState;
use super::super::body::JsonBody;
use super::super::permit::{Permit, Submit};
use super::super::problem::{ApiError, INVALID, INVALID_JOB, Result};
use super::submit::read;
use crate::store::StoreError;

/// Parts of the largest specimen that is drawn: some seconds of a core, some 100 MB, a picture of some
/// 10 MB.
const MOST_PARTS: f64 = 200_000.0;

/// Draw the specimen
///
/// Of a job as it would be submitted: what its generator makes of the spec and the seed, before the test, as
/// snapshots of VTK that the page and ParaView show. Beds that are poured are shown as they are before the
/// pouring, which `shows` says. Nothing is stored.
#[utoipa::path(post, operation_id = "preview_job", path = "/v1/jobs/preview", tag = "Jobs",
    request_body(content = ref("#/components/schemas/Submission"), description = "The job"),
    responses((status = 200, description = "Its specimen", body = ref("#/components/schemas/Preview")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "This server draws nothing"),
              (status = 413, description = "The body is larger than 32 MB"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The job cannot be accepted, there is no such specimen, or it is too large to be drawn")))]
pub(super) async fn preview(
    State(state): State<AppState>,
    permit: Permit<Submit>,
    body: JsonBody,
) -> Result<Json<Preview>> {
    let Some(draw) = state.preview else {
        let sentence = "this server draws nothing: it was built without an engine";
        return Err(StoreError::Conflict(sentence.to_owned()).into());
    };
    let client = body.client;
    let (checked, body) = read(&state, &permit.call, body, None).await?;
    let spec = checked.submission.spec;
    let Extent { parts, what } = spec.extent();
    if parts > MOST_PARTS {
        let detail =
            format!("the specimen has about {parts:.0} {what}, which is too much for a picture");
        let violation = Violation::new("/spec", "too_large_to_draw", detail)
            .value(parts.round())
            .allowed(format!("at most {MOST_PARTS}"));
        let refusal = ApiError::new(INVALID, "only smaller specimens are drawn");
        return Err(refusal.violations(vec![violation]));
    }
    let draw = move || {
        let drawn = draw(&spec);
        // its room is kept until then
        drop(body);
        drawn
    };
    let drawn = state.checks.run(client, draw).await?;
    let preview = drawn.map_err(|reason| {
        ApiError::new(
            INVALID_JOB,
            format!("the specimen cannot be made: {reason}"),
        )
    })?;
    Ok(Json(preview))
}
