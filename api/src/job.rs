//! A job as clients see it.
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use uuid::Uuid;

use crate::people::Named;
use crate::worker::FaultCode;
use crate::{JobKind, JobLimits, Quantity, Timestamp};

/// Where a job is in its life; the diagram is in the server's `queue` module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobStatus {
    Queued,
    Running,
    /// Set aside with its checkpoint; `resume` queues it again.
    Paused,
    Finished,
}

/// How a finished job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobOutcome {
    Succeeded,
    Failed,
    Cancelled,
    TimedOut,
    /// Its worker died while running it three times.
    Quarantined,
}

/// Why a job is in its state, for programs; `reason` says it to people.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReasonCode {
    /// Submitted, waiting for a worker.
    Submitted,
    /// Asked to pause; the worker is leaving a checkpoint.
    PauseRequested,
    /// Asked to cancel; the worker is being told.
    CancelRequested,
    PausedByUser,
    ResumedByUser,
    RetriedByUser,
    CancelledByUser,
    /// The worker stopped by plan (shutdown, drain, time limit) and left a checkpoint.
    WorkerReleased,
    /// The worker fell silent beyond its lease.
    WorkerLost,
    /// Lost too many workers.
    TooManyLosses,
    /// The simulation could not give a result.
    SimulationError,
    /// A fault of the worker's machine (disk full, files unreadable): another one is to carry it out.
    WorkerFault,
    /// Machine after machine could not carry it out.
    WorkerError,
    TimeLimit,
    /// It has taken far more than it was estimated to, and is paused.
    BeyondEstimate,
    Completed,
}

/// How an attempt ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AttemptEnd {
    Completed,
    Failed,
    Cancelled,
    Paused,
    /// Planned stop of the worker; costs no attempt.
    Released,
    /// The lease ran out.
    Lost,
    /// A fault of the machine; costs no attempt.
    Faulted,
    TimedOut,
}

/// A job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JobView {
    pub id: Uuid,
    pub kind: JobKind,
    pub name: String,
    pub notes: String,
    pub tags: Vec<String>,
    /// Higher runs first. Of equal ones people take turns, by what they have used lately; each person's run
    /// in order of submission.
    pub priority: i32,
    pub status: JobStatus,
    pub outcome: Option<JobOutcome>,
    pub reason: String,
    pub reason_code: ReasonCode,
    /// 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub progress: f64,
    /// What the simulation is doing.
    pub phase: String,
    /// Estimated time to the end [s], while running.
    pub eta_s: Option<f64>,
    /// Jobs that will run before this one, plus one, while queued: as if people with jobs of its priority took
    /// turns, who has used least first, and every job fitted every worker.
    pub position: Option<u64>,
    /// Number of the current or last attempt; 0 before the first.
    pub attempt: u32,
    pub attempts: Vec<AttemptView>,
    pub created_at: Timestamp,
    pub started_at: Option<Timestamp>,
    pub finished_at: Option<Timestamp>,
    pub updated_at: Timestamp,
    pub spec_sha256: String,
    /// Threads that its worker must have at least, where the submission asked for some.
    #[serde(default)]
    pub threads: Option<u32>,
    /// How many times its estimate the job may take.
    #[serde(default)]
    pub overrun_factor: f64,
    /// What the job may take before it is paused; `null` for jobs of earlier versions.
    #[serde(default)]
    pub limits: Option<JobLimits>,
    /// The normalised spec; only on a single job.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spec: Option<Value>,
    /// Results of a succeeded job, as in `outcome.json`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub summary: Option<IndexMap<String, Quantity>>,
    /// Values of its spec that a list was asked to show, by their pointers; one that the spec does not
    /// have is left out.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub values: IndexMap<String, ShownValue>,
    /// Who submitted it, where the server has accounts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owner: Option<Named>,
    /// The project it belongs to, where the server has accounts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<Named>,
    pub links: JobLinks,
}

/// A value of a spec, in a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShownValue {
    /// A number, text or truth value; of a list or object, what it is.
    pub value: Value,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// Something that jobs can be listed by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FieldView {
    /// `/spec/…` or `/summary/NAME`.
    pub pointer: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// How many of the jobs that were looked at have it.
    pub jobs: u64,
}

/// One worker's go at a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AttemptView {
    pub number: u32,
    /// Label of the worker.
    pub worker: String,
    pub host: String,
    pub started_at: Timestamp,
    pub ended_at: Option<Timestamp>,
    pub end_reason: Option<AttemptEnd>,
    /// Version and commit of the worker's build; empty where that was not noted.
    #[serde(default)]
    pub engine: String,
}

/// Where to go on from a job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct JobLinks {
    #[serde(rename = "self")]
    pub this: String,
    pub page: String,
    pub events: String,
    pub curve: String,
    pub files: String,
    pub archive: String,
    pub outcome: String,
    pub log: String,
}

impl JobLinks {
    /// Links of the job `id`.
    pub fn of(id: Uuid) -> Self {
        let this = format!("/v1/jobs/{id}");
        Self {
            page: format!("/jobs/{id}"),
            events: format!("{this}/events"),
            curve: format!("{this}/curve"),
            files: format!("{this}/files"),
            archive: format!("{this}/archive.zip"),
            outcome: format!("{this}/outcome"),
            log: format!("{this}/log"),
            this,
        }
    }
}

/// A page of a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{T}Page")]
pub struct Page<T> {
    pub items: Vec<T>,
    /// Give this as `cursor` for the next page.
    pub next: Option<String>,
    /// Rows of this page that could not be read and are left out; the server's log names them.
    #[serde(default)]
    pub unreadable: u64,
    /// So many jobs were looked at before the search stopped short of all; `next` goes on from there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopped_after: Option<u64>,
    /// What is sorted is the newest `stopped_after` jobs alone, which were looked at.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub newest_only: bool,
    /// The values that the list is by are being gathered from all jobs, which takes some minutes where there are
    /// a million; from then on it is one of all jobs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub gathering: bool,
}

impl<T> Page<T> {
    /// A list that is one page.
    pub fn whole(items: Vec<T>) -> Self {
        Self {
            items,
            next: None,
            unreadable: 0,
            stopped_after: None,
            newest_only: false,
            gathering: false,
        }
    }
}

/// Part of a job's curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurveView {
    /// Names of the columns, units included.
    pub columns: Vec<String>,
    /// The attempt that computed these points; all attempts compute the same ones.
    pub attempt: u32,
    pub points: Vec<Vec<f64>>,
    /// Give this as `since` to go on.
    pub next: u64,
    /// No more points will come.
    pub complete: bool,
}

/// A line of a job's log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LogLine {
    pub at: Timestamp,
    pub attempt: u32,
    pub message: String,
}

/// A worker process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorkerView {
    pub id: Uuid,
    pub name: String,
    pub host: String,
    pub threads: u32,
    pub engine_version: String,
    /// Memory that a job may take there [MB], where the worker knows.
    #[serde(default)]
    pub memory_mb: Option<f64>,
    /// Room for the files of a job [MB], where the worker knows.
    #[serde(default)]
    pub disk_mb: Option<f64>,
    /// When it has to end, where it has to.
    #[serde(default)]
    pub ends_at: Option<Timestamp>,
    /// Whether it was heard of within its lease.
    pub alive: bool,
    pub job_id: Option<Uuid>,
    pub last_seen_at: Timestamp,
    /// Why it is given no jobs for a while; `null` when it is.
    #[serde(default)]
    pub set_aside: Option<SetAside>,
}

/// Why a worker is given no jobs for a while.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SetAside {
    /// When it is tried again; sooner when its process is started again.
    pub until: Timestamp,
    /// Faults since it last carried out a job.
    pub faults: u32,
    pub code: FaultCode,
    pub reason: String,
}
