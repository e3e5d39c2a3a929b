//! Why a job waits.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `GET /v1/jobs/{id}/waiting`: what a queued job needs, and why it does not run yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WaitingView {
    pub code: WaitCode,
    /// The same for people.
    pub reason: String,
    /// As in the job.
    pub position: Option<u64>,
    pub needs: NeedsView,
    /// Workers that are there.
    pub workers: u32,
    /// Of these, workers that have all that it needs.
    pub suitable: u32,
}

/// What a worker must have for a job, rounded up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NeedsView {
    /// Memory [MB].
    pub memory_mb: f64,
    /// Room for its files [MB].
    pub disk_mb: f64,
    /// Time in one go [s] on one core of a typical machine (1e8 bond evaluations a second); the time between
    /// checkpoints where it leaves some.
    pub core_s: f64,
    pub threads: u32,
    /// The earliest version of the engine that knows its spec; `null` for jobs of earlier versions.
    pub version: Option<String>,
}

/// Why a job waits, for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WaitCode {
    /// No worker is there.
    NoWorker,
    /// No worker computes its kind.
    Kind,
    /// All workers are of versions that may not know its spec.
    Version,
    /// No worker has so many threads.
    Threads,
    /// No worker has so much memory.
    Memory,
    /// No worker has room for its files.
    Disk,
    /// All workers end too soon.
    Time,
    /// Each need is met by some worker, but no worker meets all.
    NoSingleWorker,
    /// Its owner has as many jobs running as they may.
    RunningLimit,
    /// Suitable workers are given no jobs after faults of their machines.
    SetAside,
    /// Suitable workers are at work, or others' jobs come first.
    Turn,
}
