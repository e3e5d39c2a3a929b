//! Messages between a worker and the server, all under `/v1/worker`.
//!
//! A claim gives a [`Lease`]; every later write carries its id and token in the path and the
//! `Loadframe-Lease-Token` header, and answers 409 once the lease is no longer held.
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use uuid::Uuid;

use crate::{Calibration, FileEntry, JobKind, JobLimits, Outcome, Quantity};

/// Header that carries [`Lease::token`].
pub const LEASE_TOKEN_HEADER: &str = "loadframe-lease-token";

/// `POST /v1/worker/claims`: asks for a job and waits up to `wait_s` for one (204 when none came).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClaimRequest {
    /// Fresh for every process start.
    pub worker_id: Uuid,
    #[schemars(length(min = 1, max = 200))]
    pub name: String,
    #[schemars(length(min = 1, max = 200))]
    pub host: String,
    #[schemars(range(min = 1, max = 4096))]
    pub threads: u32,
    #[schemars(length(max = 100))]
    pub engine_version: String,
    /// Kinds this worker can run.
    pub kinds: Vec<JobKind>,
    pub calibration: Option<Calibration>,
    /// Memory that a job may take here [MB]; `None` where the worker does not know, and is given any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub memory_mb: Option<f64>,
    /// Room for the files of a job in the scratch folder [MB]; `None` as above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub disk_mb: Option<f64>,
    /// Time until the worker has to end [s], as in an allocation of a batch system; `None` has no end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub time_left_s: Option<f64>,
    /// Longest wait [s].
    #[schemars(range(min = 0.0, max = 30.0))]
    pub wait_s: f64,
}

impl ClaimRequest {
    /// Of a worker of one thread that computes every kind, says nothing more of its machine, and does not wait.
    pub fn new(worker_id: Uuid, name: &str, host: &str, engine_version: &str) -> Self {
        Self {
            worker_id,
            name: name.to_owned(),
            host: host.to_owned(),
            threads: 1,
            engine_version: engine_version.to_owned(),
            kinds: JobKind::ALL.to_vec(),
            calibration: None,
            memory_mb: None,
            disk_mb: None,
            time_left_s: None,
            wait_s: 0.0,
        }
    }
}

/// A job handed to a worker.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Lease {
    /// Id of the attempt.
    pub id: Uuid,
    /// Secret that fences every write of this attempt.
    pub token: Uuid,
    pub job_id: Uuid,
    pub attempt: u32,
    pub kind: JobKind,
    /// The normalised spec.
    #[schemars(with = "serde_json::Value")]
    pub spec: Box<RawValue>,
    pub spec_sha256: String,
    /// The lease ends this long after the last heartbeat [s].
    pub lease_s: f64,
    /// Heartbeats are due this often [s].
    pub heartbeat_s: f64,
    /// The job may take this much wall time [s] over all attempts.
    pub time_limit_s: Option<f64>,
    /// Beyond this the job is to be paused.
    #[serde(default)]
    pub limits: Option<JobLimits>,
    /// What an earlier attempt left to go on from.
    pub checkpoint: Option<CheckpointInfo>,
    /// So many first points of the curve the server has already, from before the checkpoint.
    #[serde(default)]
    pub curve_points: u64,
}

/// A stored checkpoint: its bytes are at `GET /v1/worker/leases/{id}/checkpoint`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckpointInfo {
    pub bytes: u64,
    pub sha256: String,
    /// Result files that belong to it; the server has carried them over to this attempt.
    pub files: Vec<FileEntry>,
    /// Wall and processor time [s] of the work up to it.
    pub wall_s: f64,
    pub cpu_s: f64,
}

/// Query of `PUT /v1/worker/leases/{id}/checkpoint`, whose body is the checkpoint's bytes. All
/// files uploaded so far by this attempt belong to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckpointQuery {
    #[schemars(length(equal = 64))]
    pub sha256: String,
    #[schemars(range(min = 0.0))]
    pub wall_s: f64,
    #[schemars(range(min = 0.0))]
    pub cpu_s: f64,
}

/// Query of `PUT /v1/worker/leases/{id}/files/{name}`, whose body is the file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UploadQuery {
    #[schemars(length(equal = 64))]
    pub sha256: String,
    /// The body is what follows so many bytes [B], which an upload that broke off has brought.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub from: u64,
}

fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// Answer to `GET /v1/worker/leases/{id}/uploads/{sha256}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct UploadedPart {
    /// Bytes [B] of the content that have arrived and are kept; 0 where the upload has to begin anew.
    pub bytes: u64,
}

/// Answer to `POST /v1/worker/leases/{id}/heartbeat` and `progress`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct HeartbeatAnswer {
    pub command: Command,
}

/// What the server wants of a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Command {
    Continue,
    /// Give up and release with [`ReleaseReason::Cancelled`].
    Cancel,
    /// Leave a checkpoint and release with [`ReleaseReason::Paused`].
    Pause,
}

/// `POST /v1/worker/leases/{id}/progress`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProgressReport {
    #[schemars(range(min = 0.0, max = 1.0))]
    pub progress: f64,
    #[schemars(length(max = 500))]
    pub phase: String,
    #[schemars(range(min = 0.0))]
    pub eta_s: Option<f64>,
    /// New curve points, if any.
    #[serde(default)]
    pub points: Option<CurveBlock>,
    /// New log lines.
    #[serde(default)]
    #[schemars(length(max = 1000))]
    pub log: Vec<String>,
    /// Log lines of this attempt before these. Lines that the server has already are passed over, so a
    /// report may be repeated; without this number they are taken as new.
    #[serde(default)]
    pub log_from: Option<u64>,
}

/// Columns that a curve may have.
pub const MOST_CURVE_COLUMNS: usize = 200;
/// Points that a report may bring.
pub const MOST_CURVE_POINTS: usize = 10_000;

/// Consecutive points of a curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurveBlock {
    #[schemars(length(min = 1, max = MOST_CURVE_COLUMNS))]
    pub columns: Vec<String>,
    /// Index of the first point; a block may repeat points already sent, never leave a gap.
    pub first: u64,
    #[schemars(length(max = MOST_CURVE_POINTS))]
    pub rows: Vec<Vec<f64>>,
}

/// `POST /v1/worker/leases/{id}/complete`: publishes the files uploaded under this lease.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompleteRequest {
    /// `outcome.json` parsed; the file itself is among `files`.
    pub outcome: Outcome,
    /// Every file of the result, `outcome.json` included; all must have been uploaded.
    pub files: Vec<FileEntry>,
}

/// `POST /v1/worker/leases/{id}/fail`: the job has no result and trying again would not help.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FailRequest {
    pub code: FailCode,
    /// What happened and what to do.
    #[schemars(length(min = 1, max = 10_000))]
    pub reason: String,
}

/// `POST /v1/worker/leases/{id}/fault`: this machine cannot carry the job out, another one may. It costs
/// the job nothing; the machine is set aside for a while.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultRequest {
    pub code: FaultCode,
    /// What happened, for people.
    #[schemars(length(min = 1, max = 10_000))]
    pub reason: String,
}

/// What is wrong with a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FaultCode {
    /// Its scratch folder is full, missing, read-only or fails.
    Disk,
    /// It has not the memory that the job is estimated to need.
    Memory,
    /// It starts no more threads.
    Threads,
    /// It cannot fetch the checkpoint.
    Checkpoint,
    /// Its build does not know the job's spec.
    Version,
    /// Anything else, and what workers of earlier versions report as `worker_error`.
    Other,
}

/// Whose fault a failure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FailCode {
    /// The simulation has no result for this spec.
    SimulationError,
    /// The worker could not carry it out. Workers of earlier versions say this; it is taken as a
    /// [`FaultRequest`].
    WorkerError,
    /// The job took longer than it may.
    TimeLimit,
}

/// `POST /v1/worker/leases/{id}/release`: gives the lease back before the end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReleaseRequest {
    pub reason: ReleaseReason,
    /// What was exceeded, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(max = 1000))]
    pub detail: Option<String>,
}

/// Why a lease is given back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReleaseReason {
    /// The worker stops by plan; the job is queued again and no attempt is charged.
    Shutdown,
    Paused,
    Cancelled,
    /// It has taken more than [`Lease::limits`]; the job is paused.
    BeyondEstimate,
}

/// Results named in lists of jobs.
pub type Summary = IndexMap<String, Quantity>;
