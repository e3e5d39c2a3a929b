//! Large bodies without large memory.
//!
//! A body is read while there is room for what comes ([`super::body_budget`]); else it waits for a
//! moment unread, which costs a connection and no memory, and is then sent away with 503. How slowly
//! it may come is the connection's to say ([`crate::connections`]).
use std::error::Error;

use axum::body::{Body, Bytes};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};
use loadframe_api::{Message, SubmissionError};
use tokio::time::{Instant, timeout_at};
use tokio_stream::StreamExt;

use super::body_budget::{LARGEST, LONGEST_BEYOND, Room, SMALL};
use super::checks::Client;
use super::problem::{
    ApiError, BAD_REQUEST, INVALID, NOT_JSON_TYPE, Result, TOO_LARGE, is_too_slow, too_slow,
};
use super::state::AppState;

/// A JSON body as sent, with its room in the budget until it is dropped.
#[derive(Debug)]
pub(super) struct JsonBody {
    pub(super) bytes: Bytes,
    /// Who sent it.
    pub(super) client: Client,
    _room: Room,
}

impl FromRequest<AppState> for JsonBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self> {
        if !is_json(request.headers()) {
            let detail = "send it with `Content-Type: application/json`";
            return Err(ApiError::new(NOT_JSON_TYPE, detail));
        }
        let length = content_length(request.headers());
        if length.is_some_and(|length| length > LARGEST) {
            return Err(too_large());
        }
        let client = state.checks.client(&request);
        let mut room = state.bodies.begin();
        let bytes = read(request.into_body(), length, &mut room).await?;
        Ok(Self {
            bytes,
            client,
            _room: room,
        })
    }
}

/// Reads a body to its end, of at most so many bytes as it says.
async fn read(body: Body, length: Option<usize>, room: &mut Room) -> Result<Bytes> {
    // what is reserved takes memory only where something is written
    let mut bytes = Vec::with_capacity(length.unwrap_or_default());
    let most = length.unwrap_or(LARGEST);
    let mut pieces = body.into_data_stream();
    let mut end = None;
    loop {
        if room.is_beyond() {
            end.get_or_insert_with(|| Instant::now() + LONGEST_BEYOND);
        }
        let next = pieces.next();
        let piece = match end {
            None => next.await,
            Some(end) => timeout_at(end, next).await.map_err(|_| too_slow())?,
        };
        let Some(piece) = piece else {
            return Ok(bytes.into());
        };
        let piece = piece.map_err(|error| broken(&error))?;
        if bytes.len() + piece.len() > most {
            return Err(too_large());
        }
        room.grow(bytes.len() + piece.len()).await?;
        bytes.extend_from_slice(&piece);
    }
}

fn too_large() -> ApiError {
    ApiError::new(TOO_LARGE, format!("at most {} MB are taken", LARGEST >> 20))
}

/// A body that did not come to its end.
fn broken(error: &(dyn Error + 'static)) -> ApiError {
    if is_too_slow(error) {
        return too_slow();
    }
    ApiError::new(BAD_REQUEST, "the body broke off")
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
