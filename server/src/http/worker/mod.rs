//! The worker's side: claims, and what is written under a lease.
//!
//! A lease is its id in the path and its token in the `Loadframe-Lease-Token` header. Whatever is
//! written under one that is no longer held is refused with 409 and changes nothing.
mod claims;
mod leases;
mod uploads;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use loadframe_api::worker::LEASE_TOKEN_HEADER;
use loadframe_api::{Message, SubmissionError};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::AppState;
use super::body::JsonBody;
use super::problem::{ApiError, BAD_REQUEST, INVALID, Result};
use crate::store::{LeaseKey, StoreError};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(claims::claim))
        .routes(routes!(leases::heartbeat))
        .routes(routes!(leases::progress))
        .routes(routes!(leases::complete))
        .routes(routes!(leases::fail))
        .routes(routes!(leases::release))
        .merge(uploads::router())
}

/// The lease a request is made under.
struct HeldLease(LeaseKey);

impl FromRequestParts<AppState> for HeldLease {
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

/// Reads a worker's message.
fn message<T: Message>(body: &JsonBody) -> Result<T> {
    T::from_slice(&body.bytes).map_err(|error| match error {
        SubmissionError::Invalid(violations) => {
            ApiError::new(INVALID, "the message does not fit its schema").violations(violations)
        }
        syntax => syntax.into(),
    })
}

/// Counts writes that came under a lost lease.
fn counted<T>(written: Result<T, StoreError>) -> Result<T> {
    if matches!(written, Err(StoreError::LeaseLost)) {
        metrics::counter!("loadframe_leases_lost_total").increment(1);
    }
    Ok(written?)
}
