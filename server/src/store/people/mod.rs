//! People, their secrets, groups, projects and links, and the log of what was done.
//!
//! Who a secret belongs to and whose an object is stands in [`callers`]; what is allowed is decided by
//! [`crate::access`]. A change that a request makes carries its [`Actor`], under which [`audit`] writes
//! it down in the same transaction.
mod accounts;
mod actor;
mod audit;
mod callers;
mod checks;
mod comparisons;
mod groups;
mod identities;
mod invitations;
mod limits;
mod line;
mod listing;
mod mails;
mod names;
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

pub use actor::Actor;
pub use audit::AuditFilter;
pub use identities::{Admission, Arrival, Identity};
pub(super) use limits::admission;
pub(super) use line::Line;
pub use outbox::{Due, DueEvent};
pub(super) use projects::takes_no_jobs;
pub use remembered::{AccessState, Versions};
pub use retention::ANNOUNCED;
pub use sessions::NewSession;
pub use shares::ShareFilter;
pub(super) use webhook_key::WEBHOOK_KEY;
pub use webhooks::Channel;
