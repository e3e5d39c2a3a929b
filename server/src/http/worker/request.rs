//! What a worker's request carries: its lease.
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use loadframe_api::worker::LEASE_TOKEN_HEADER;
use uuid::Uuid;

use super::super::permit::{Permit, Work};
use super::super::problem::{ApiError, BAD_REQUEST, Result};
use super::super::state::AppState;
use crate::store::{LeaseKey, StoreError};

/// The lease a request is made under.
pub(super) struct LeaseCredentials(pub(super) LeaseKey);

impl FromRequestParts<AppState> for LeaseCredentials {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self> {
        use axum::extract::RawPathParams;
        Permit::<Work>::from_request_parts(parts, state).await?;
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

/// Counts writes that came under a lost lease.
pub(super) fn counted<T>(written: Result<T, StoreError>) -> Result<T> {
    if matches!(written, Err(StoreError::LeaseLost)) {
        metrics::counter!("loadframe_leases_lost_total").increment(1);
    }
    Ok(written?)
}
