//! Who a caller is, and how people come and go.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::{Named, PersonLimits, Role, Scope};
use crate::Timestamp;

/// Kinds of callers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CallerKind {
    /// The one person of a server without accounts.
    Sole,
    Person,
    Worker,
    /// Whoever has a share link.
    Share,
}

/// Who the server takes the caller for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CallerView {
    pub kind: CallerKind,
    /// Whether this server has accounts.
    pub accounts: bool,
    /// Whether this server sends e-mail.
    pub mail: bool,
    /// What the token allows; a session allows everything its person may do.
    pub scope: Option<Scope>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub person: Option<PersonView>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<Named>,
    /// The job that a share link shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub job: Option<Uuid>,
    /// The project that a share link shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<Named>,
    /// The comparison that a share link shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Uuid>,
    /// Whether a share link shows files too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub files: Option<bool>,
}

/// A person with an account.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PersonView {
    pub id: Uuid,
    pub name: String,
    pub role: Role,
    pub created_at: Timestamp,
    /// Who has left signs in no more; what they did stays on record.
    pub left_at: Option<Timestamp>,
    /// What the person may use.
    #[serde(default)]
    pub limits: PersonLimits,
}

/// `PATCH /v1/people/{id}`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PersonChanges {
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Role")]
    pub role: Option<Role>,
    /// `true` ends the account with its sessions and tokens, `false` opens it again.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "bool")]
    pub left: Option<bool>,
}

/// `POST /v1/people/{id}/hand-over`: jobs and projects get another owner.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HandOver {
    /// Who gets them.
    pub to: Uuid,
}

/// `POST /v1/sessions`.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignIn {
    #[schemars(length(min = 1, max = 60))]
    pub name: String,
    #[schemars(length(min = 1, max = 200))]
    pub password: String,
}

/// A browser in which somebody is signed in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SessionView {
    pub id: Uuid,
    pub created_at: Timestamp,
    pub last_used_at: Timestamp,
    pub expires_at: Timestamp,
    /// What the browser calls itself.
    pub client: String,
    /// Whether it is the one that asks.
    pub current: bool,
}

/// `PUT /v1/me/password`.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PasswordChange {
    #[schemars(length(min = 1, max = 200))]
    pub current: String,
    #[schemars(length(min = 12, max = 200))]
    pub new: String,
}

/// `POST /v1/invitations`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewInvitation {
    pub role: Role,
    /// Groups the person will be in.
    #[serde(default)]
    #[schemars(length(max = 100))]
    pub groups: Vec<Uuid>,
    /// Days it can be accepted for.
    #[serde(default = "a_week")]
    #[schemars(range(min = 1, max = 90))]
    pub days: u32,
    /// Whose it is: who comes by single sign-on with this address accepts it so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(min = 3, max = 254))]
    pub email: Option<String>,
}

fn a_week() -> u32 {
    7
}

/// An invitation to open an account.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct InvitationView {
    pub id: Uuid,
    pub role: Role,
    pub groups: Vec<Uuid>,
    pub created_at: Timestamp,
    pub expires_at: Timestamp,
    pub accepted_at: Option<Timestamp>,
    pub revoked_at: Option<Timestamp>,
    /// Whose it is, where it is for one address.
    pub email: Option<String>,
}

/// An invitation just made; the only time its secret is seen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct InvitationMade {
    pub id: Uuid,
    /// The part of the page's address after the server's, the secret behind `#`: no server sees it.
    pub path: String,
    pub expires_at: Timestamp,
}

/// `POST /v1/invitations/accept`.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Acceptance {
    #[schemars(length(min = 1, max = 200))]
    pub secret: String,
    /// The name to sign in with, seen by others.
    #[schemars(length(min = 1, max = 60))]
    pub name: String,
    #[schemars(length(min = 12, max = 200))]
    pub password: String,
}

macro_rules! without_secrets {
    ($($type:ident),+) => {
        $(impl std::fmt::Debug for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_struct(stringify!($type)).finish_non_exhaustive()
            }
        })+
    };
}

without_secrets!(SignIn, PasswordChange, Acceptance);
