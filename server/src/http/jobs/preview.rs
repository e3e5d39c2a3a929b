//! `POST /v1/jobs/preview`: the specimen, before the job is submitted.
//!
//! What draws it is part of the engine, which this library does not know: whoever composes the executable
//! hands it in ([`crate::ServeConfig::preview`]). It has turns of its own, so that no submission waits for it.
use axum::Json;
use axum::extract::State;
use loadframe_api::{Extent, Preview, Violation};
use tokio::sync::oneshot;
use tokio_util::sync::CancellationToken;

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
              (status = 422, description = "The job cannot be accepted, there is no such specimen, it is too large to be drawn, or it takes too long")))]
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
    // whoever has left, or waited too long, wants it no more
    let given_up = CancellationToken::new();
    let _given_up = given_up.clone().drop_guard();
    let (began, begins) = oneshot::channel();
    let draw = move || {
        let _ = began.send(());
        let drawn = draw(&spec, &given_up);
        // its room is kept until then
        drop(body);
        drawn
    };
    let time_is_over = async {
        // its turn has yet to come
        if begins.await.is_err() {
            std::future::pending::<()>().await;
        }
        tokio::time::sleep(state.preview_time).await;
    };
    let drawn = tokio::select! {
        drawn = state.pictures.run(client, draw) => drawn?,
        () = time_is_over => Ok(None),
    };
    match drawn {
        Ok(Some(preview)) => Ok(Json(preview)),
        Ok(None) => {
            let seconds = state.preview_time.as_secs_f64();
            let detail = format!(
                "the specimen was not made within {seconds} s, which is all that a picture gets; a job makes it in its own time"
            );
            let violation = Violation::new("/spec", "too_long_to_draw", detail.clone());
            Err(ApiError::new(INVALID, detail).violations(vec![violation]))
        }
        Err(reason) => {
            let detail = format!("the specimen cannot be made: {reason}");
            Err(ApiError::new(INVALID_JOB, detail))
        }
    }
}
