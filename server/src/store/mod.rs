//! The store: jobs, attempts, curves, files, events, workers and tokens, in SQLite and a folder.
mod error;
mod types;

use std::path::PathBuf;

use loadframe_api::worker::{
    CheckpointInfo, CheckpointQuery, ClaimRequest, Command, CompleteRequest, FailRequest, Lease,
    ProgressReport, ReleaseReason,
};
use loadframe_api::{
    Calibration, CurveView, Event, FileEntry, JobView, LogLine, Page, Submission, WorkerView,
};
use tokio::io::AsyncRead;
use tokio::sync::watch;
use uuid::Uuid;

pub use error::StoreError;
pub use types::*;

/// The store; a clone is another handle on the same one.
#[derive(Clone, Debug)]
pub struct Store;

type Result<T, E = StoreError> = std::result::Result<T, E>;

#[allow(unused_variables, clippy::todo, clippy::unused_async)]
impl Store {
    /// Opens the store for a server, alone: migrates, extends all leases (the server's absence is
    /// not the workers' fault), removes what a crash left half-written.
    pub async fn open(options: StoreOptions) -> Result<Self> {
        todo!()
    }
    /// Opens the store beside a running server, for commands on tokens: takes no lock, recovers nothing.
    pub async fn open_beside(options: StoreOptions) -> Result<Self> {
        todo!()
    }
    /// Sweeps every second until dropped; a pause of this process never counts against workers.
    pub async fn keep_sweeping(self) {
        todo!()
    }

    pub async fn enqueue(
        &self,
        submission: &Submission,
        key: Option<IdempotencyKey>,
    ) -> Result<Enqueued> {
        todo!()
    }
    /// The job with its spec.
    pub async fn job(&self, id: Uuid) -> Result<JobView> {
        todo!()
    }
    /// Changes whenever [`Self::job`] does.
    pub async fn job_version(&self, id: Uuid) -> Result<u64> {
        todo!()
    }
    /// Changes whenever [`Self::jobs`] does.
    pub async fn jobs_version(&self) -> Result<u64> {
        todo!()
    }
    /// Newest first.
    pub async fn jobs(
        &self,
        filter: &JobFilter,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        todo!()
    }
    pub async fn edit(&self, id: Uuid, edit: JobEdit) -> Result<JobView> {
        todo!()
    }
    pub async fn delete(&self, id: Uuid) -> Result<()> {
        todo!()
    }
    pub async fn request(&self, id: Uuid, action: UserAction) -> Result<JobView> {
        todo!()
    }

    pub async fn curve(&self, id: Uuid, since: u64, limit: Option<u64>) -> Result<CurveView> {
        todo!()
    }
    pub async fn files(&self, id: Uuid) -> Result<Vec<FileEntry>> {
        todo!()
    }
    /// The file and where its bytes are.
    pub async fn file(&self, id: Uuid, name: &str) -> Result<(FileEntry, PathBuf)> {
        todo!()
    }
    /// `outcome.json`.
    pub async fn outcome(&self, id: Uuid) -> Result<String> {
        todo!()
    }
    /// Log lines from the `since`-th on, counted from the first line of the job.
    pub async fn log(&self, id: Uuid, since: u64) -> Result<Vec<LogLine>> {
        todo!()
    }

    /// Wakes after every commit that made events; holds the last event's number.
    pub fn changes(&self) -> watch::Receiver<u64> {
        todo!()
    }
    pub async fn events_after(
        &self,
        seq: u64,
        jobs: Option<&[Uuid]>,
        limit: u32,
    ) -> Result<Vec<(u64, Event)>> {
        todo!()
    }
    pub async fn last_event(&self) -> u64 {
        todo!()
    }

    /// The next job for this worker, if one is waiting now.
    pub async fn claim(&self, request: &ClaimRequest) -> Result<Option<Lease>> {
        todo!()
    }
    /// Wakes after every commit that queued a job.
    pub fn queued(&self) -> watch::Receiver<u64> {
        todo!()
    }
    pub async fn heartbeat(&self, key: LeaseKey) -> Result<Command> {
        todo!()
    }
    pub async fn report(&self, key: LeaseKey, report: &ProgressReport) -> Result<Command> {
        todo!()
    }
    pub async fn upload(
        &self,
        key: LeaseKey,
        name: &str,
        sha256: &str,
        body: impl AsyncRead + Send + Unpin,
    ) -> Result<FileEntry> {
        todo!()
    }
    pub async fn save_checkpoint(
        &self,
        key: LeaseKey,
        query: &CheckpointQuery,
        body: impl AsyncRead + Send + Unpin,
    ) -> Result<CheckpointInfo> {
        todo!()
    }
    pub async fn checkpoint(&self, key: LeaseKey) -> Result<(CheckpointInfo, PathBuf)> {
        todo!()
    }
    pub async fn complete(&self, key: LeaseKey, request: &CompleteRequest) -> Result<()> {
        todo!()
    }
    pub async fn fail(&self, key: LeaseKey, request: &FailRequest) -> Result<()> {
        todo!()
    }
    pub async fn release(&self, key: LeaseKey, reason: ReleaseReason) -> Result<()> {
        todo!()
    }
    /// Ends the attempts whose lease ran out or whose time is over; how many.
    pub async fn sweep(&self) -> Result<usize> {
        todo!()
    }
    pub async fn workers(&self) -> Result<Vec<WorkerView>> {
        todo!()
    }
    /// Speed of the slowest live worker, else of the one seen last.
    pub async fn calibration(&self) -> Result<Option<Calibration>> {
        todo!()
    }

    pub async fn create_token(&self, name: &str) -> Result<NewToken> {
        todo!()
    }
    /// Makes `secret` a valid token, unless it is one.
    pub async fn ensure_token(&self, name: &str, secret: &str) -> Result<()> {
        todo!()
    }
    pub async fn tokens(&self) -> Result<Vec<TokenView>> {
        todo!()
    }
    pub async fn revoke_token(&self, id: Uuid) -> Result<()> {
        todo!()
    }
    /// Whether the secret belongs to a token in force.
    pub async fn check_token(&self, secret: &str) -> Result<bool> {
        todo!()
    }
    /// Whether any token is in force.
    pub async fn has_tokens(&self) -> Result<bool> {
        todo!()
    }
    pub async fn counts(&self) -> Result<Counts> {
        todo!()
    }
}
