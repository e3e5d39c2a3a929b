//! Large bodies without large memory.
//!
//! A body is admitted only while the bodies under way fit a fixed budget; others wait for a
//! moment unread, which costs a connection and no memory, and are then sent away with 503.
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Bytes, to_bytes};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use super::AppState;
use super::problem::{ApiError, BAD_REQUEST, NOT_JSON_TYPE, Result, TOO_LARGE, TOO_SLOW};

/// Largest submission [bytes]: an explicit network of about half a million bonds.
pub(super) const LARGEST: usize = 32 << 20;
/// Bodies up to this many bytes are small; they do not wait behind large ones.
pub(super) const SMALL: usize = 64 << 10;
/// Small bodies read at once.
const SMALL_AT_ONCE: usize = 512;
/// A large body counts in these units [bytes]; all at once may have as many as the largest one.
const UNIT: usize = 1 << 10;
/// How long a body waits to be admitted.
const PATIENCE: Duration = Duration::from_secs(10);
/// How long a body may take to arrive: the largest one at 0.5 MB/s.
const ARRIVAL: Duration = Duration::from_secs(60);

/// Room for bodies.
#[derive(Clone, Debug)]
pub(super) struct BodyBudget {
    small: Arc<Semaphore>,
    large: Arc<Semaphore>,
}

impl Default for BodyBudget {
    fn default() -> Self {
        Self {
            small: Arc::new(Semaphore::new(SMALL_AT_ONCE)),
            large: Arc::new(Semaphore::new(LARGEST / UNIT)),
        }
    }
}

impl BodyBudget {
    async fn admit(&self, length: usize) -> Result<OwnedSemaphorePermit> {
        let (room, units) = if length <= SMALL {
            (&self.small, 1)
        } else {
            (&self.large, length.div_ceil(UNIT))
        };
        let units = u32::try_from(units).unwrap_or(u32::MAX);
        match timeout(PATIENCE, room.clone().acquire_many_owned(units)).await {
            Ok(Ok(permit)) => Ok(permit),
            _ => Err(ApiError::busy("too many large bodies are on their way", 5)),
        }
    }
}

/// A JSON body as sent, with its room in the budget until it is dropped.
#[derive(Debug)]
pub(super) struct JsonBody {
    pub(super) bytes: Bytes,
    _room: OwnedSemaphorePermit,
}

impl FromRequest<AppState> for JsonBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self> {
        if !is_json(request.headers()) {
            let detail = "send it with `Content-Type: application/json`";
            return Err(ApiError::new(NOT_JSON_TYPE, detail));
        }
        let too_large =
            || ApiError::new(TOO_LARGE, format!("at most {} MB are taken", LARGEST >> 20));
        // without a length, the body may turn out to be the largest
        let length = content_length(request.headers()).unwrap_or(LARGEST);
        if length > LARGEST {
            return Err(too_large());
        }
        let room = state.bodies.admit(length).await?;
        let reading = to_bytes(request.into_body(), length);
        match timeout(ARRIVAL, reading).await {
            Ok(Ok(bytes)) => Ok(Self { bytes, _room: room }),
            Ok(Err(error)) if is_too_long(&error) => Err(too_large()),
            Ok(Err(_)) => Err(ApiError::new(BAD_REQUEST, "the body broke off")),
            Err(_) => {
                let detail = format!("a body may take {} s", ARRIVAL.as_secs());
                Err(ApiError::new(TOO_SLOW, detail))
            }
        }
    }
}

fn is_too_long(error: &axum::Error) -> bool {
    let mut cause: Option<&dyn std::error::Error> = Some(error);
    while let Some(error) = cause {
        if error.to_string().contains("length limit exceeded") {
            return true;
        }
        cause = error.source();
    }
    false
}

fn content_length(headers: &HeaderMap) -> Option<usize> {
    headers
        .get(header::CONTENT_LENGTH)?
        .to_str()
        .ok()?
        .parse()
        .ok()
}

/// `application/json` or anything `+json`.
fn is_json(headers: &HeaderMap) -> bool {
    let value = headers.get(header::CONTENT_TYPE);
    let text = value.and_then(|value| value.to_str().ok()).unwrap_or("");
    let essence = text.split(';').next().unwrap_or("").trim();
    let essence = essence.to_ascii_lowercase();
    essence == "application/json"
        || (essence.starts_with("application/") && essence.ends_with("+json"))
}
