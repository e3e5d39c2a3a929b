//! People, their secrets, groups, projects and links, and the log of what was done.
//!
//! Who a secret belongs to and whose an object is stands in [`callers`]; what is allowed is decided by
//! [`crate::access`]. A change that a request makes carries its [`Actor`], under which [`audit`] writes
//! it down in the same transaction.
mod accounts;
mod actor;
mod audit;
mod callers;
mod comparisons;
mod groups;
mod identities;
mod invitations;
mod limits;
mod line;
mod listing;
mod mails;
mod outbox;
mod projects;
mod remembered;
mod retention;
mod secret;
mod sessions;
mod shares;
mod storage;
mod tokens;
mod webhook_key;
mod webhooks;

use loadframe_api::Violation;

use super::error::{Result, StoreError};
use super::{Inner, Store};
pub use actor::Actor;
pub use audit::AuditFilter;
pub use identities::{Admission, Arrival, Identity};
pub(super) use limits::admission;
pub(super) use line::Line;
pub use outbox::{Due, DueEvent};
pub(super) use projects::takes_no_jobs;
pub use remembered::AccessState;
pub use retention::ANNOUNCED;
pub use sessions::NewSession;
pub(super) use webhook_key::WEBHOOK_KEY;
pub use webhooks::Channel;

/// Longest name of a person, group, project or token [characters].
const LONGEST_NAME: usize = 60;

impl Store {
    /// A handle whose changes are written down as those of `actor`.
    #[must_use]
    pub fn acting(&self, actor: Actor) -> Self {
        let inner: &std::sync::Arc<Inner> = &self.0;
        Self(inner.clone(), Some(std::sync::Arc::new(actor)))
    }
}

/// A name without spaces around it.
///
/// # Errors
/// [`StoreError::Refused`] where it is empty, long or has characters that cannot be seen.
fn clean_name(pointer: &str, name: &str) -> Result<String> {
    let trimmed = name.trim();
    let count = trimmed.chars().count();
    // direction marks and the like would let one name look like another's
    let is_seen = |c: char| {
        !c.is_control()
            && !matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
    };
    if (1..=LONGEST_NAME).contains(&count) && trimmed.chars().all(is_seen) {
        return Ok(trimmed.to_owned());
    }
    let detail = "this is not a name that others can read";
    let violation = Violation::new(pointer, "name", detail).value(name);
    let allowed = format!("1 … {LONGEST_NAME} characters that can be seen");
    Err(StoreError::Refused(vec![violation.allowed(allowed)]))
}

/// The form in which names are compared.
fn folded(name: &str) -> String {
    name.to_lowercase()
}

/// One thing wrong with a request.
fn refused(
    pointer: &str,
    code: &str,
    detail: impl Into<String>,
    value: impl Into<serde_json::Value>,
    allowed: &str,
) -> StoreError {
    let violation = Violation::new(pointer, code, detail).value(value);
    StoreError::Refused(vec![violation.allowed(allowed)])
}
