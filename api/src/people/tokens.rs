//! Access tokens.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::{Named, Scope};
use crate::Timestamp;

/// `POST /v1/tokens`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewToken {
    /// What it is for.
    #[schemars(length(min = 1, max = 60))]
    pub name: String,
    /// `read`, `submit` or `worker`.
    pub scope: Scope,
    /// Days it is good for; left out, until it is revoked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32", range(min = 1, max = 3650))]
    pub days: Option<u32>,
}

/// An access token, without its secret.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TokenView {
    pub id: Uuid,
    pub name: String,
    pub scope: Scope,
    /// Whose it is; tokens of workers and of a server without accounts have no owner.
    pub person: Option<Named>,
    pub created_at: Timestamp,
    pub expires_at: Option<Timestamp>,
    /// To the minute.
    pub last_used_at: Option<Timestamp>,
    pub revoked_at: Option<Timestamp>,
}

/// A token just made; the only time its secret is seen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TokenMade {
    pub id: Uuid,
    pub name: String,
    pub scope: Scope,
    pub expires_at: Option<Timestamp>,
    pub secret: String,
}
