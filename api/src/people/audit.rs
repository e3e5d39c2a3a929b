//! What was done, by whom.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::Timestamp;

/// A line of the audit log, which only grows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AuditEntry {
    pub number: u64,
    pub at: Timestamp,
    /// Who: the name the person had then, `link` for a share link, `shell` for a command on the server.
    pub who: String,
    pub person: Option<Uuid>,
    /// Id of the session, token or link that was used.
    pub credential: Option<Uuid>,
    /// What was done: `job.submitted`, `share.read`, `person.changed`, …
    pub action: String,
    /// Id of what it was done to.
    pub object: Option<Uuid>,
    /// More about it, never a secret.
    pub detail: String,
    /// Id of the request, as answered in `X-Request-Id`.
    pub request: Option<Uuid>,
    pub address: String,
}
