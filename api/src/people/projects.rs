//! Groups, projects and share links.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::{Named, Visibility};
use crate::Timestamp;

/// People who work together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct GroupView {
    pub id: Uuid,
    pub name: String,
    pub members: Vec<Named>,
    pub created_at: Timestamp,
}

/// `POST /v1/groups`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewGroup {
    #[schemars(length(min = 1, max = 60))]
    pub name: String,
}

/// Jobs that belong together, of a person or of a group.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ProjectView {
    pub id: Uuid,
    pub name: String,
    pub visibility: Visibility,
    pub person: Option<Named>,
    pub group: Option<Named>,
    pub created_at: Timestamp,
    /// An archived project takes no jobs, and its jobs are listed only when it is asked for.
    pub archived_at: Option<Timestamp>,
}

/// `POST /v1/projects`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewProject {
    #[schemars(length(min = 1, max = 60))]
    pub name: String,
    pub visibility: Visibility,
    /// The group it belongs to; left out, it is your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub group: Option<Uuid>,
}

/// `PATCH /v1/projects/{id}`; what is left out stays as it is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ProjectChanges {
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(min = 1, max = 60))]
    pub name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Visibility")]
    pub visibility: Option<Visibility>,
    /// Hands it over to a person.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub person: Option<Uuid>,
    /// Hands it over to a group.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub group: Option<Uuid>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "bool")]
    pub archived: Option<bool>,
}

/// `POST /v1/shares`: a link for one job, one project or one comparison.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewShare {
    /// The job it shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub job: Option<Uuid>,
    /// The project whose jobs it shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub project: Option<Uuid>,
    /// The comparison it shows, with its jobs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub comparison: Option<Uuid>,
    /// Whether files, snapshots and log are shown too.
    #[serde(default)]
    pub files: bool,
    /// Days it is good for.
    #[serde(default = "a_month")]
    #[schemars(range(min = 1, max = 365))]
    pub days: u32,
}

fn a_month() -> u32 {
    30
}

/// A share link, without its secret.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ShareView {
    pub id: Uuid,
    pub job: Option<Uuid>,
    pub project: Option<Uuid>,
    pub comparison: Option<Uuid>,
    pub files: bool,
    /// Who made it.
    pub person: Named,
    pub created_at: Timestamp,
    pub expires_at: Timestamp,
    pub revoked_at: Option<Timestamp>,
    /// Visits: an address counts once an hour.
    pub uses: u64,
    pub last_used_at: Option<Timestamp>,
}

/// A share link just made; the only time its secret is seen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ShareMade {
    pub id: Uuid,
    /// The part of the page's address after the server's, the secret behind `#`: no server sees it.
    pub path: String,
    pub expires_at: Timestamp,
}
