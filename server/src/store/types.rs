//! What goes into the store and comes out of it, beyond the shared vocabulary.
use std::path::PathBuf;
use std::time::Duration;

use loadframe_api::{
    Calibration, Estimate, JobKind, JobOutcome, JobStatus, JobView, Submission, Timestamp,
    sha256_hex,
};
use uuid::Uuid;

use crate::VERSION;
use crate::access::Sight;
use crate::queue::needs::Needs;

use super::bucket::BucketSettings;
use super::clock::Clock;
use super::database::DatabasePlace;

/// Where the files of a store are.
#[derive(Clone, Debug, Default)]
pub enum FilesPlace {
    /// In its data folder.
    #[default]
    Folder,
    Bucket(BucketSettings),
}

/// Where the store lives and what it promises.
#[derive(Clone, Debug)]
pub struct StoreOptions {
    /// Folder of the database, and of the files, unless they are elsewhere. Servers on one database may
    /// share it.
    pub data: PathBuf,
    pub database: DatabasePlace,
    pub files: FilesPlace,
    /// How long a silent worker keeps its job.
    pub lease: Duration,
    /// Longest wall time of a job over all attempts.
    pub job_time_limit: Option<Duration>,
    /// How long a stored file that no job names waits before it is removed.
    pub unnamed_wait: Duration,
    /// How long a machine is given no jobs after its first fault; twice as long after every further one.
    pub fault_pause: Duration,
    /// What it takes for the time.
    pub clock: Clock,
    /// How long what was deleted, or removed by a rule of a project, can be brought back.
    pub trash: Duration,
    /// How many jobs a list by values looks at.
    pub looks: Looks,
}

/// How many jobs a list by values of specs and results looks at: what one request may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Looks {
    /// Jobs whose specs and results are read, before their values are kept.
    pub read: u32,
    /// So many are looked at all at once.
    pub few: u32,
    /// A text that no more jobs hold is looked up in its index at once.
    pub rare: u32,
    /// Entries of an index that are walked.
    pub walked: u32,
}

impl Default for Looks {
    /// Some tens of milliseconds each.
    fn default() -> Self {
        Self {
            read: 5_000,
            few: 10_000,
            rare: 50_000,
            walked: 20_000,
        }
    }
}

impl StoreOptions {
    /// The usual promises, in `data`.
    pub fn new(data: impl Into<PathBuf>) -> Self {
        Self {
            data: data.into(),
            database: DatabasePlace::Folder,
            files: FilesPlace::Folder,
            lease: Duration::from_secs(30),
            job_time_limit: None,
            unnamed_wait: Duration::from_secs(7 * 24 * 3600),
            fault_pause: Duration::from_secs(10),
            clock: Clock::System,
            trash: Duration::from_secs(14 * 24 * 3600),
            looks: Looks::default(),
        }
    }
}

/// A client's name for one submission, and what it submitted under it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IdempotencyKey {
    pub key: String,
    /// SHA-256 of what was asked for, in hexadecimal digits: of the body as sent, and of the project where
    /// one was named.
    pub body_sha256: String,
}

impl IdempotencyKey {
    /// The key of a request that `person` names so, where there are people.
    pub fn new(person: Option<Uuid>, name: &str, project: Option<Uuid>, body: &[u8]) -> Self {
        let body_sha256 = sha256_hex(body);
        Self {
            key: person.map_or(String::new(), Self::of_person) + name,
            body_sha256: match project {
                Some(project) => sha256_hex(format!("{body_sha256} {project}").as_bytes()),
                None => body_sha256,
            },
        }
    }

    /// What a person's keys begin with: two people may choose the same name.
    pub(super) fn of_person(person: Uuid) -> String {
        format!("{}:", person.simple())
    }
}

/// A submission that has passed every check, with what is written down of it: making that takes time
/// where the spec is large.
#[derive(Clone, Debug)]
pub struct CheckedSubmission {
    pub submission: Submission,
    pub estimate: Estimate,
    /// The normalised spec as JSON, and its SHA-256.
    pub spec: String,
    pub spec_sha256: String,
    /// What a worker must have for it.
    pub needs: Needs,
    /// The project it goes to, where there are people.
    pub project: Option<Uuid>,
}

impl CheckedSubmission {
    /// Estimates and writes down what was submitted, at the speed that was `measured`.
    pub fn new(submission: Submission, measured: Option<Calibration>) -> Self {
        let spec = submission.spec.to_json();
        let speed = measured.unwrap_or_default();
        let estimate = submission.estimate(measured);
        let (kind, threads) = (submission.spec.kind(), submission.threads);
        Self {
            needs: Needs::of(kind, &estimate, speed, threads, VERSION),
            estimate,
            spec_sha256: sha256_hex(spec.as_bytes()),
            spec,
            submission,
            project: None,
        }
    }
}

/// Answer to a submission.
#[derive(Clone, Debug)]
pub struct Enqueued {
    pub job: JobView,
    /// The job was there already, under the same idempotency key.
    pub replayed: bool,
}

/// Which jobs to list; what is `None` does not narrow.
#[derive(Clone, Debug, Default)]
pub struct JobFilter {
    pub status: Option<JobStatus>,
    pub outcome: Option<JobOutcome>,
    pub kind: Option<JobKind>,
    pub tag: Option<String>,
    /// Text in name, notes, tags or the beginning of the id; case does not matter.
    pub q: Option<String>,
    pub created_after: Option<Timestamp>,
    pub created_before: Option<Timestamp>,
    /// Only what the caller sees; `None` sees everything.
    pub sight: Option<Sight>,
    pub project: Option<Uuid>,
    /// How often access had changed when the request began, where that is known ([`super::Store::access_version`]).
    pub access: Option<u64>,
}

impl JobFilter {
    /// Whether only the caller's sight narrows.
    pub(crate) fn narrows_nothing_else(&self) -> bool {
        let Self {
            status,
            outcome,
            kind,
            tag,
            q,
            created_after,
            created_before,
            sight: _,
            project,
            access: _,
        } = self;
        status.is_none()
            && outcome.is_none()
            && kind.is_none()
            && tag.is_none()
            && q.is_none()
            && created_after.is_none()
            && created_before.is_none()
            && project.is_none()
    }
}

/// What may be changed of a job at any time; what is `None` stays.
#[derive(Clone, Debug, Default)]
pub struct JobEdit {
    pub name: Option<String>,
    pub notes: Option<String>,
    pub tags: Option<Vec<String>>,
    pub priority: Option<i32>,
    pub overrun_factor: Option<f64>,
    /// Moves the job to this project.
    pub project: Option<Uuid>,
    /// The version of the job that is changed; an edit since then is not overwritten.
    pub known_version: Option<u64>,
}

impl JobEdit {
    /// What it changes, for the audit log.
    pub(super) fn detail(&self) -> String {
        let moved = self.project.map(|project| format!("to project {project}"));
        let fields = [
            ("name", self.name.is_some()),
            ("notes", self.notes.is_some()),
            ("tags", self.tags.is_some()),
            ("priority", self.priority.is_some()),
            ("overrun_factor", self.overrun_factor.is_some()),
        ];
        let changed = fields.into_iter().filter(|(_, is_changed)| *is_changed);
        let changed = changed.map(|(field, _)| field.to_owned());
        moved
            .into_iter()
            .chain(changed)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// What a user may ask of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UserAction {
    Cancel,
    Pause,
    Resume,
    Retry,
}

/// What a worker's write carries: who it is, and the proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeaseKey {
    pub id: Uuid,
    pub token: Uuid,
}

/// The queue in numbers, for `/metrics`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counts {
    pub queued: u64,
    pub running: u64,
    pub paused: u64,
    pub succeeded: u64,
    pub failed: u64,
    pub cancelled: u64,
    pub timed_out: u64,
    pub quarantined: u64,
    /// How long the oldest queued job has been waiting [s].
    pub oldest_queued_s: f64,
    pub workers_alive: u64,
    /// Of these, workers that are given no jobs after a fault of their machine.
    pub workers_set_aside: u64,
    /// Attempts that ended because their worker fell silent, ever.
    pub attempts_lost: u64,
    /// Bytes of result files and checkpoints that jobs name.
    pub file_bytes: u64,
    /// Stored files that no job names, which wait before they are removed.
    pub files_unnamed: u64,
    /// Whether the disk is full.
    pub is_full: bool,
    /// How often the writer and the collector were taken up again after they failed.
    pub writer_restarts: u64,
    pub collector_restarts: u64,
    /// Files that jobs name and that were missing or had changed when last looked at.
    pub files_lost: u64,
}
