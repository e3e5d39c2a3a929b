//! What of old jobs is removed, and what fills the disk.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::Named;
use crate::{JobKind, Timestamp};

/// What the files of a project are kept for. Snapshots go before curves and other tables; outcomes, logs
/// and specs are never removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RetentionRule {
    /// Days after its end that a job keeps its snapshots; left out, for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32", range(min = 1, max = 36500))]
    pub snapshots_days: Option<u32>,
    /// Days after its end that a job keeps its curves and other tables, no fewer than its snapshots; left
    /// out, for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32", range(min = 1, max = 36500))]
    pub curves_days: Option<u32>,
}

/// Jobs and their files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FilesOfJobs {
    pub jobs: u64,
    pub files: u64,
    /// Bytes, a file that several jobs have counted for each.
    pub bytes: u64,
}

/// `GET /v1/projects/{id}/retention`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RetentionView {
    /// The rule that is set; empty where all is kept.
    pub rule: RetentionRule,
    /// From when on the rule removes something.
    pub in_force_at: Option<Timestamp>,
    /// What the rule, or the one that was asked about, would remove as of today.
    pub would_remove: FilesOfJobs,
    /// What was removed and can be brought back.
    pub removed: FilesOfJobs,
    /// When the oldest of that is gone for good.
    pub gone_at: Option<Timestamp>,
}

/// Kinds of stored files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FileKind {
    Outcome,
    Snapshots,
    /// Curves and other tables.
    Curves,
    /// Logs and what else a kind of job writes.
    Others,
    /// Checkpoints of jobs without a result.
    Checkpoints,
    /// All files of jobs that were deleted and can be brought back.
    Trash,
}

/// What fills the disk: files of one kind, of one person in one project.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct DiskUse {
    pub person: Option<Named>,
    pub project: Option<Named>,
    pub kind: FileKind,
    pub files: u64,
    /// Bytes, a file that several jobs have counted for each.
    pub bytes: u64,
}

/// What can be brought back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Deleted {
    /// A job.
    Job,
    /// A project with its jobs.
    Project,
    /// Files of a project's jobs, which its rule removed.
    Files,
}

/// Something in the trash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TrashView {
    /// Of the job; of the project for a project or its files.
    pub id: Uuid,
    pub what: Deleted,
    /// Name of the job or project.
    pub name: String,
    /// Kind of the job.
    pub kind: Option<JobKind>,
    /// Whose the job or project is.
    pub owner: Option<Named>,
    /// Project of the job.
    pub project: Option<Named>,
    pub deleted_at: Timestamp,
    /// Who deleted it, by name.
    pub deleted_by: String,
    /// From then on it cannot be brought back; of files, the first of them.
    pub gone_at: Timestamp,
    pub jobs: u64,
    pub files: u64,
    /// Bytes, a file that several jobs have counted for each.
    pub bytes: u64,
}
