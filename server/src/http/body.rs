//! Large bodies without large memory.
//!
//! A body is admitted only while the bodies under way fit a fixed budget; others wait for a
//! moment unread, which costs a connection and no memory, and are then sent away with 503.
use std::time::Duration;

use axum::body::{Bytes, to_bytes};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};
use loadframe_api::{Message, SubmissionError};
use tokio::sync::OwnedSemaphorePermit;
use tokio::time::timeout;

use super::body_budget::{LARGEST, SMALL};
use super::checks::Client;
use super::problem::{ApiError, BAD_REQUEST, INVALID, NOT_JSON_TYPE, Result, TOO_LARGE, TOO_SLOW};
use super::state::AppState;

/// How long a body may take to arrive: the largest one at 0.5 MB/s.
const ARRIVAL: Duration = Duration::from_secs(60);

/// A JSON body as sent, with its room in the budget until it is dropped.
#[derive(Debug)]
pub(super) struct JsonBody {
    pub(super) bytes: Bytes,
    /// Who sent it.
    pub(super) client: Client,
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
        let client = state.checks.client(&request);
        let reading = to_bytes(request.into_body(), length);
        match timeout(ARRIVAL, reading).await {
            Ok(Ok(bytes)) => Ok(Self {
                bytes,
                client,
                _room: room,
            }),
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

/// Reads a message, a large one where it holds up nobody.
pub(super) async fn message<T>(state: &AppState, body: JsonBody) -> Result<T>
where
    T: Message + Send + 'static,
{
    let read = if body.bytes.len() <= SMALL {
        T::from_slice(&body.bytes)
    } else {
        let client = body.client;
        let check = move || T::from_slice(&body.bytes);
        state.checks.run(client, check).await?
    };
    read.map_err(|error| match error {
        SubmissionError::Invalid(violations) => {
            ApiError::new(INVALID, "the message does not fit its schema").violations(violations)
        }
        syntax => syntax.into(),
    })
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
