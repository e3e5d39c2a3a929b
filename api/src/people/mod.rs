//! People, and who shares what with whom: the vocabulary of a server that a group uses.
//!
//! A [`Role`] says what a person may do, a [`Scope`] how much of that a token may, a [`Visibility`]
//! who sees a project. What they allow together is decided by the server alone.
mod accounts;
mod audit;
mod limits;
mod mails;
mod order;
mod projects;
mod sign_in;
mod tokens;
mod webhooks;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

pub use accounts::{
    Acceptance, CallerKind, CallerView, HandOver, InvitationMade, InvitationView, NewInvitation,
    PasswordChange, PersonChanges, PersonView, SessionView, SignIn,
};
pub use audit::AuditEntry;
pub use limits::{Allowance, PersonLeft, PersonLimits, PersonUse};
pub use mails::{MailVerification, MailView, NewMail};
pub use order::{Deleted, DiskUse, FileKind, FilesOfJobs, RetentionRule, RetentionView, TrashView};
pub use projects::{
    GroupView, NewGroup, NewProject, NewShare, ProjectChanges, ProjectView, ShareMade, ShareView,
};
pub use sign_in::{SignInBegun, SignInWays};
pub use tokens::{NewToken, TokenMade, TokenView};
pub use webhooks::{NewWebhook, WebhookEvent, WebhookMade, WebhookView};

/// What a person may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Sees everything and looks after people, groups and tokens of workers.
    Administrator,
    /// Submits jobs and shares them.
    Member,
    /// Reads what its groups share.
    Guest,
}

/// What a token may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// Read what its owner may read.
    Read,
    /// That, and submit and change what its owner may; never look after people.
    Submit,
    /// Claim jobs, and write under the leases it got; nothing else.
    Worker,
    /// Everything: tokens of before there were scopes, and the secret a server is started with.
    Everything,
}

/// Who sees a project and its jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Visibility {
    /// Its person.
    Private,
    /// Its group, or all who are in a group with its person.
    Group,
    /// Every member of this server.
    Everyone,
}

/// Something that has a name: a person, a group or a project.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Named {
    pub id: Uuid,
    pub name: String,
}
