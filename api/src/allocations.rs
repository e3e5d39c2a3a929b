//! What waits, for whoever starts workers on a batch system, and what became of their asking for machines.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Timestamp;

/// Longest list of allocations in a report.
pub const MOST_ALLOCATIONS: usize = 1000;

/// Answer to `GET /v1/worker/backlog`: the jobs that wait, as numbers. It names none of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Backlog {
    /// Jobs that wait; `classes` holds the first 10 000 of them.
    pub waiting: u64,
    /// By the memory that they need, least first.
    pub classes: Vec<BacklogClass>,
}

/// Jobs that wait and need about the same memory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BacklogClass {
    /// Each is estimated to need at most so much memory [MB]: 500 MB and its doubles.
    pub memory_mb: f64,
    pub jobs: u64,
    /// Estimated wall time on one core of the longest of them, and of all [s].
    pub longest_wall_s: f64,
    pub total_wall_s: f64,
}

/// `PUT /v1/worker/allocations`: what a batch system gives to workers, as whoever asks it for machines
/// sees it. The next report of the same source takes its place; one is forgotten after ten minutes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AllocationReport {
    /// Who reports, such as `slurm on login1`.
    #[schemars(length(min = 1, max = 200))]
    pub source: String,
    #[schemars(length(max = MOST_ALLOCATIONS))]
    pub allocations: Vec<AllocationView>,
    /// Why no more machines are asked for, where that is so.
    #[serde(default)]
    #[schemars(length(max = 2000))]
    pub trouble: Option<String>,
}

/// An allocation of a batch system.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AllocationView {
    /// What the batch system's commands call it.
    #[schemars(length(min = 1, max = 100))]
    pub id: String,
    /// In the batch system's word, such as `PENDING` or `RUNNING`.
    #[schemars(length(min = 1, max = 100))]
    pub state: String,
    /// Why it waits, in the batch system's word.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(max = 500))]
    pub reason: Option<String>,
}

/// The latest report of a source.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ReportedAllocations {
    pub source: String,
    pub reported_at: Timestamp,
    pub allocations: Vec<AllocationView>,
    pub trouble: Option<String>,
}
