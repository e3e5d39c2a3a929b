//! Who makes a change.
use uuid::Uuid;

/// Who makes a change, for the audit log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Actor {
    pub who: String,
    pub person: Option<Uuid>,
    /// Id of the session, token or link.
    pub credential: Option<Uuid>,
    pub request: Option<Uuid>,
    pub address: String,
}

impl Actor {
    /// A command on the server's own machine.
    pub fn shell() -> Self {
        Self::named("shell")
    }

    /// Nobody in particular, under a word of its own.
    pub(in super::super) fn named(who: &str) -> Self {
        Self {
            who: who.to_owned(),
            person: None,
            credential: None,
            request: None,
            address: String::new(),
        }
    }
}
