//! The routes of one lease, each repeated while the lease may still live.
use std::io::SeekFrom;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use backon::{ExponentialBuilder, Retryable};
use bytes::Bytes;
use loadframe_api::worker::{
    CheckpointQuery, Command, CompleteRequest, FailRequest, FaultRequest, HeartbeatAnswer,
    LEASE_TOKEN_HEADER, Lease, ProgressReport, ReleaseRequest, UploadQuery, UploadedPart,
};
use loadframe_api::{FileEntry, sha256_hex};
use loadframe_client::direct::Becomes;
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::{SavedRun, StopCause};
use reqwest::{Method, RequestBuilder, Response};
use serde::Serialize;
use tokio::fs::File;
use tokio::io::AsyncSeekExt;

use super::contact::Contact;
use super::content::{Content, Source};
use super::stop::AttemptSwitch;

/// A checkpoint that has not come by so many leases is not waited for.
const LEASES_FOR_A_CHECKPOINT: f64 = 2.0;
/// How long the server may take to say how much of a file it has.
const LONGEST_QUESTION: Duration = Duration::from_secs(10);
/// First and longest pause between two tries.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
const LONGEST_PAUSE: Duration = Duration::from_secs(10);
/// and the longest as a share of a lease: a server that is back gives that long to be spoken to.
const PAUSES_A_LEASE: u32 = 4;

/// Speaks for the holder of a lease.
#[derive(Clone, Debug)]
pub(super) struct LeaseClient {
    pub(super) server: ServerClient,
    path: String,
    token: String,
    /// How long a checkpoint is waited for.
    checkpoint_patience: Duration,
    /// From this size on, contents are sent to the bucket.
    pub(super) direct_from: Option<u64>,
    longest_pause: Duration,
    contact: Arc<Contact>,
    switch: Arc<AttemptSwitch>,
}

impl LeaseClient {
    pub(super) fn new(
        server: ServerClient,
        lease: &Lease,
        direct_from: Option<u64>,
        contact: Arc<Contact>,
        switch: Arc<AttemptSwitch>,
    ) -> Self {
        let lease_time = Duration::from_secs_f64(lease.lease_s);
        Self {
            server,
            path: format!("/v1/worker/leases/{}", lease.id),
            token: lease.token.to_string(),
            checkpoint_patience: lease_time.mul_f64(LEASES_FOR_A_CHECKPOINT),
            direct_from,
            longest_pause: LONGEST_PAUSE.min(lease_time / PAUSES_A_LEASE),
            contact,
            switch,
        }
    }

    /// The same lease over connections of its own.
    pub(super) fn over(&self, server: ServerClient) -> Self {
        Self {
            server,
            ..self.clone()
        }
    }

    /// Tells the server that this worker has begun, until it has heard so.
    pub(super) async fn begin(&self) -> Result<(), ServerError> {
        let answer = self
            .with_retries(|| self.send_once(self.request(Method::POST, "/heartbeat")))
            .await?;
        self.follow_command(answer).await
    }

    /// Tells the server that this worker lives; tried once, its caller comes again anyway.
    pub(super) async fn heartbeat(&self, timeout: Duration) -> Result<(), ServerError> {
        let request = self.request(Method::POST, "/heartbeat").timeout(timeout);
        let answer = self.send_once(request).await?;
        self.follow_command(answer).await
    }

    pub(super) async fn progress(&self, report: &ProgressReport) -> Result<(), ServerError> {
        let answer = self
            .with_retries(|| async {
                let request = self.request(Method::POST, "/progress");
                self.send_once(request.json(report)).await
            })
            .await?;
        self.follow_command(answer).await
    }

    /// Uploads the file at `path`; what had arrived when it broke off is not sent again.
    pub(super) async fn upload(&self, entry: &FileEntry, path: &Path) -> Result<(), ServerError> {
        let becomes = Becomes::File {
            name: entry.name.clone(),
        };
        let content = Content {
            sha256: &entry.sha256,
            bytes: entry.bytes,
            source: Source::File(path),
        };
        if self.send_directly(&content, &becomes).await? {
            return Ok(());
        }
        let is_first = AtomicBool::new(true);
        self.with_retries(|| async {
            let from = match is_first.swap(false, Ordering::Relaxed) {
                true => 0,
                false => self.arrived(entry).await,
            };
            let failed = |error: std::io::Error| ServerError::File {
                path: path.display().to_string(),
                reason: error.to_string(),
            };
            let mut file = File::open(path).await.map_err(failed)?;
            file.seek(SeekFrom::Start(from)).await.map_err(failed)?;
            let query = UploadQuery {
                sha256: entry.sha256.clone(),
                from,
            };
            let request = self.request(Method::PUT, &format!("/files/{}", entry.name));
            let request = request
                .query(&query)
                .header(reqwest::header::CONTENT_LENGTH, entry.bytes - from)
                .body(file);
            self.send_once(request).await
        })
        .await?;
        Ok(())
    }

    /// Bytes of a file that the server has kept of a broken upload; none where it cannot be asked.
    async fn arrived(&self, entry: &FileEntry) -> u64 {
        let request = self.request(Method::GET, &format!("/uploads/{}", entry.sha256));
        let request = request.timeout(LONGEST_QUESTION);
        match self.server.json::<UploadedPart>(request).await {
            Ok(part) if part.bytes < entry.bytes => part.bytes,
            _ => 0,
        }
    }

    /// Stores a checkpoint, to which all files uploaded so far belong.
    pub(super) async fn save_checkpoint(&self, saved: &SavedRun) -> Result<(), ServerError> {
        let bytes = Bytes::from(saved.to_bytes());
        let query = CheckpointQuery {
            sha256: sha256_hex(&bytes),
            wall_s: saved.spent().wall_s,
            cpu_s: saved.spent().cpu_s,
        };
        let becomes = Becomes::Checkpoint {
            wall_s: query.wall_s,
            cpu_s: query.cpu_s,
        };
        let content = Content {
            sha256: &query.sha256,
            bytes: bytes.len() as u64,
            source: Source::Memory(&bytes),
        };
        if self.send_directly(&content, &becomes).await? {
            return Ok(());
        }
        self.with_retries(|| async {
            let request = self.request(Method::PUT, "/checkpoint").query(&query);
            self.send_once(request.body(bytes.clone())).await
        })
        .await?;
        Ok(())
    }

    /// Bytes of the checkpoint the lease goes on from, or of the one before that of content `before`;
    /// `None` when the server has none.
    pub(super) async fn checkpoint(
        &self,
        before: Option<&str>,
    ) -> Result<Option<Vec<u8>>, ServerError> {
        let begin = Instant::now();
        let fetch = || async {
            let request = self.request(Method::GET, "/checkpoint");
            let request = request.query(&before.map(|sha256| [("before", sha256)]));
            let answer = self.server.send(request).await;
            let answer = match self.noted(answer) {
                Err(ServerError::Refused(problem)) if problem.status == 404 => return Ok(None),
                answer => self.held(answer)?,
            };
            let bytes = answer.bytes().await;
            let bytes = bytes.map_err(|error| self.server.unreachable(&error))?;
            Ok(Some(Vec::from(bytes)))
        };
        fetch
            .retry(self.pauses())
            .when(|error: &ServerError| {
                error.is_transient()
                    && !self.is_presumed_lost()
                    && begin.elapsed() < self.checkpoint_patience
            })
            .adjust(|error, pause| self.adjusted(error, pause))
            .await
    }

    pub(super) async fn complete(&self, request: &CompleteRequest) -> Result<(), ServerError> {
        self.end("/complete", request).await
    }

    pub(super) async fn fail(&self, request: &FailRequest) -> Result<(), ServerError> {
        self.end("/fail", request).await
    }

    pub(super) async fn fault(&self, request: &FaultRequest) -> Result<(), ServerError> {
        self.end("/fault", request).await
    }

    pub(super) async fn release(&self, request: &ReleaseRequest) -> Result<(), ServerError> {
        self.end("/release", request).await
    }

    /// Whether the server has been away for longer than it is waited for.
    pub(super) fn is_presumed_lost(&self) -> bool {
        self.contact.is_given_up()
    }

    /// What is known of the server's being there.
    pub(super) fn contact(&self) -> Arc<Contact> {
        Arc::clone(&self.contact)
    }

    async fn end(&self, route: &str, body: &impl Serialize) -> Result<(), ServerError> {
        self.with_retries(|| self.send_once(self.request(Method::POST, route).json(body)))
            .await?;
        Ok(())
    }

    pub(super) fn request(&self, method: Method, route: &str) -> RequestBuilder {
        let path = format!("{}{route}", self.path);
        let request = self.server.request(method, &path);
        request.header(LEASE_TOKEN_HEADER, &self.token)
    }

    pub(super) async fn send_once(&self, request: RequestBuilder) -> Result<Response, ServerError> {
        let answer = self.server.send(request).await;
        match self.noted(answer) {
            // the job and its lease are gone
            Err(ServerError::Refused(problem)) if problem.status == 404 => Err(self.lost()),
            answer => self.held(answer),
        }
    }

    /// Notes that the server was heard of.
    fn noted(&self, answer: Result<Response, ServerError>) -> Result<Response, ServerError> {
        self.contact
            .note(!answer.as_ref().is_err_and(ServerError::is_silence));
        answer
    }

    /// Stops the run when the answer is that the lease is not held.
    fn held(&self, answer: Result<Response, ServerError>) -> Result<Response, ServerError> {
        match answer {
            Err(ServerError::Refused(problem)) if problem.status == 409 => Err(self.lost()),
            answer => answer,
        }
    }

    fn lost(&self) -> ServerError {
        self.switch.stop(StopCause::LeaseLost);
        ServerError::LeaseLost
    }

    pub(super) async fn with_retries<T, F>(&self, call: impl FnMut() -> F) -> Result<T, ServerError>
    where
        F: Future<Output = Result<T, ServerError>>,
    {
        call.retry(self.pauses())
            .when(|error| error.is_transient() && !self.is_presumed_lost())
            .adjust(|error, pause| self.adjusted(error, pause))
            .notify(|error, pause| {
                tracing::warn!(%error, pause_ms = pause.as_millis() as u64, "trying again");
            })
            .await
    }

    /// Carries out the command in an answer.
    async fn follow_command(&self, answer: Response) -> Result<(), ServerError> {
        let answer: HeartbeatAnswer = answer
            .json()
            .await
            .map_err(|error| self.server.unreachable(&error))?;
        match answer.command {
            Command::Continue => {}
            Command::Cancel => self.switch.stop(StopCause::Cancel),
            Command::Pause => self.switch.stop(StopCause::Pause),
        }
        Ok(())
    }

    /// A pause as long as the server asks for, within what the lease allows.
    fn adjusted(&self, error: &ServerError, pause: Option<Duration>) -> Option<Duration> {
        pause.map(|own| own.max(error.pause(own).min(self.longest_pause)))
    }

    /// Growing pauses between tries, without an end.
    fn pauses(&self) -> ExponentialBuilder {
        ExponentialBuilder::default()
            .with_min_delay(FIRST_PAUSE)
            .with_max_delay(self.longest_pause)
            .with_jitter()
            .without_max_times()
    }
}
