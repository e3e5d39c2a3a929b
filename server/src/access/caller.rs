//! Who asks.
use loadframe_api::Timestamp;
use loadframe_api::people::{Role, Scope};
use uuid::Uuid;

/// Who asks, by what, and how far that reaches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caller {
    pub identity: Identity,
    /// A session has everything that its person may do.
    pub scope: Scope,
    pub credential: Credential,
    /// When the credential ends by itself.
    pub expires_at: Option<Timestamp>,
}

/// Who a caller is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// The one person of a server without accounts.
    Sole,
    Person(Person),
    /// A worker process.
    Worker,
    /// Whoever has a share link.
    Link(Link),
}

/// A person, as far as the rules look.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Person {
    pub id: Uuid,
    pub name: String,
    pub role: Role,
    pub groups: Vec<Uuid>,
}

/// What a share link shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    pub job: Option<Uuid>,
    pub project: Option<Uuid>,
    pub comparison: Option<Uuid>,
    /// The jobs of the comparison.
    pub compared: Vec<Uuid>,
    pub shows_files: bool,
}

/// By what a caller is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Credential {
    /// By sitting at this machine, or by the secret the server was started with.
    Local,
    Session(Uuid),
    Token(Uuid),
    Link(Uuid),
    /// By the word of a proxy before the server, of this person.
    Proxy(Uuid),
}

impl Credential {
    /// Its id, if it has one.
    pub fn id(self) -> Option<Uuid> {
        match self {
            Self::Local | Self::Proxy(_) => None,
            Self::Session(id) | Self::Token(id) | Self::Link(id) => Some(id),
        }
    }
}

impl Caller {
    /// The one person of a server without accounts, as far as `scope` reaches.
    pub fn sole(scope: Scope) -> Self {
        Self {
            identity: Identity::Sole,
            scope,
            credential: Credential::Local,
            expires_at: None,
        }
    }

    /// A worker that has the secret the server was started with.
    pub fn worker() -> Self {
        Self {
            identity: Identity::Worker,
            scope: Scope::Worker,
            ..Self::sole(Scope::Worker)
        }
    }

    /// The person, where it is one.
    pub fn person(&self) -> Option<&Person> {
        match &self.identity {
            Identity::Person(person) => Some(person),
            _ => None,
        }
    }

    /// The name for the audit log.
    pub fn name(&self) -> &str {
        match &self.identity {
            Identity::Sole => "owner",
            Identity::Person(person) => &person.name,
            Identity::Worker => "worker",
            Identity::Link(_) => "link",
        }
    }

    pub(super) fn reads(&self) -> bool {
        matches!(self.scope, Scope::Read | Scope::Submit | Scope::Everything)
    }

    pub(super) fn changes(&self) -> bool {
        matches!(self.scope, Scope::Submit | Scope::Everything)
            && !matches!(self.identity, Identity::Link(_))
    }

    /// Whether the caller sits in a browser of a person.
    pub(super) fn is_session(&self) -> bool {
        matches!(
            self.credential,
            Credential::Session(_) | Credential::Proxy(_)
        )
    }

    pub(super) fn has_role(&self, role: Role) -> bool {
        self.person().is_some_and(|person| person.role == role)
    }
}
