//! What a worker's request carries: its lease, its message.
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use loadframe_api::worker::LEASE_TOKEN_HEADER;
use loadframe_api::{Message, SubmissionError};
use uuid::Uuid;

use super::super::body::JsonBody;
use super::super::body_budget::SMALL;
use super::super::problem::{ApiError, BAD_REQUEST, INVALID, Result};
use super::super::state::AppState;
use crate::store::{LeaseKey, StoreError};

/// The lease a request is made under.
pub(super) struct LeaseCredentials(pub(super) LeaseKey);

impl FromRequestParts<AppState> for LeaseCredentials {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self> {
        use axum::extract::RawPathParams;
        let bad = |detail: String| ApiError::new(BAD_REQUEST, detail);
        let params = RawPathParams::from_request_parts(parts, state)
            .await
            .map_err(|error| bad(error.to_string()))?;
        let id = params.iter().find(|(name, _)| *name == "id");
        let id = id.and_then(|(_, text)| Uuid::try_parse(text).ok());
        let id = id.ok_or_else(|| bad("the lease's id is not a UUID".to_owned()))?;
        let token = parts.headers.get(LEASE_TOKEN_HEADER);
        let token = token.and_then(|value| Uuid::try_parse_ascii(value.as_bytes()).ok());
        let token = token.ok_or_else(|| {
            bad("the header Loadframe-Lease-Token must hold the lease's token".to_owned())
        })?;
        Ok(Self(LeaseKey { id, token }))
    }
}

/// Reads a worker's message, a large one where it holds up nobody.
pub(super) async fn message<T>(state: &AppState, body: JsonBody) -> Result<T>
where
    T: Message + Send + 'static,
{
    let read = if body.bytes.len() <= SMALL {
        T::from_slice(&body.bytes)
    } else {
        let client = body.client;
        state
            .checks
            .run(client, move || T::from_slice(&body.bytes))
            .await?
    };
    read.map_err(|error| match error {
        SubmissionError::Invalid(violations) => {
            ApiError::new(INVALID, "the message does not fit its schema").violations(violations)
        }
        syntax => syntax.into(),
    })
}

/// Counts writes that came under a lost lease.
pub(super) fn counted<T>(written: Result<T, StoreError>) -> Result<T> {
    if matches!(written, Err(StoreError::LeaseLost)) {
        metrics::counter!("loadframe_leases_lost_total").increment(1);
    }
    Ok(written?)
}
