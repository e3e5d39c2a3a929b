//! A worker process: claims one lease after the other until it is told to stop.
use std::path::PathBuf;
use std::pin::Pin;
use std::time::{Duration, Instant};

use loadframe_api::worker::{ClaimRequest, Lease};
use loadframe_client::direct::DIRECT_FROM_HEADER;
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::{Engine, calibrate, free_memory_mb, host_name};
use reqwest::{Method, StatusCode};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use crate::attempt::AttemptContext;
use crate::scratch::Scratch;

/// How long the server may keep a claim waiting. A claim is never broken off, since the server may
/// just have granted it; this is therefore also how long an idle worker may take to stop.
const CLAIM_WAIT_S: f64 = 2.0;
/// A claim unanswered for so much longer is one to a server that hangs.
const CLAIM_MARGIN: Duration = Duration::from_secs(10);
/// First and longest pause after a claim to a server that is away, and after a lease that was lost.
const FIRST_PAUSE: Duration = Duration::from_millis(500);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);

/// What a worker is told at its start.
#[derive(Clone, Debug)]
pub struct WorkerOptions {
    /// What computes.
    pub engine: Engine,
    pub server: ServerClient,
    /// Connections for heartbeats alone.
    pub heartbeat_server: ServerClient,
    /// Label for people.
    pub name: String,
    pub threads: usize,
    /// Folder for files on their way to the server.
    pub scratch: PathBuf,
    /// Time between checkpoints.
    pub checkpoint_every: Duration,
    /// Ends the worker when no job came for this long.
    pub exit_when_idle: Option<Duration>,
    /// Ends the worker after this time, its job saved and given back. It takes no more jobs when less
    /// than one checkpoint's time is left.
    pub max_runtime: Option<Duration>,
    /// A server that is away for longer has its job dropped.
    pub server_away: Duration,
    /// Memory that a job may take here [MB], where somebody has set a bound.
    pub memory_mb: Option<f64>,
}

/// Why a worker ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkerEnd {
    /// It was told to.
    Stopped,
    /// Its time was over, or too little of it left for another job.
    TimeOver,
    /// No job came for as long as it was to wait, or in all its time.
    Idle,
}

/// Why a worker cannot work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorkerError {
    #[error("no scratch folder in {}", folder.display())]
    Scratch {
        folder: PathBuf,
        #[source]
        source: std::io::Error,
    },
    #[error("the server does not take this worker: {0}")]
    Server(#[source] ServerError),
}

/// A worker.
#[derive(Debug)]
pub struct Worker {
    context: AttemptContext,
    claim: ClaimRequest,
    exit_when_idle: Option<Duration>,
    /// When its time is over; `None` when it never is.
    end: Option<Instant>,
}

impl Worker {
    /// Measures this machine and prepares a worker; takes a moment of computing.
    ///
    /// # Errors
    /// [`WorkerError::Scratch`].
    pub fn prepare(options: WorkerOptions) -> Result<Self, WorkerError> {
        // a time beyond what a clock can hold is none
        let end = options.max_runtime;
        let end = end.and_then(|longest| Instant::now().checked_add(longest));
        let scratch = Scratch::open(&options.scratch).map_err(|source| WorkerError::Scratch {
            folder: options.scratch.clone(),
            source,
        })?;
        let engine = options.engine.build();
        let claim = ClaimRequest {
            threads: u32::try_from(options.threads).unwrap_or(u32::MAX),
            calibration: calibrate(),
            memory_mb: options.memory_mb,
            wait_s: CLAIM_WAIT_S,
            ..ClaimRequest::new(Uuid::new_v4(), &options.name, &host_name(), &engine)
        };
        Ok(Self {
            context: AttemptContext {
                engine: options.engine,
                server: options.server,
                heartbeat_server: options.heartbeat_server,
                scratch,
                threads: options.threads,
                checkpoint_every: options.checkpoint_every,
                server_away: options.server_away,
                shutdown: CancellationToken::new(),
            },
            claim,
            exit_when_idle: options.exit_when_idle,
            end,
        })
    }

    /// Cancelling it stops the worker: a running job is saved and given back.
    pub fn shutdown(&self) -> CancellationToken {
        self.context.shutdown.clone()
    }

    /// Works until stopped.
    ///
    /// # Errors
    /// [`WorkerError::Server`] when the server refuses claims for good.
    pub fn work(self) -> Pin<Box<dyn Future<Output = Result<WorkerEnd, WorkerError>> + Send>> {
        // boxed, it is compiled once and not again in everything that works
        Box::pin(self.work_on())
    }

    async fn work_on(self) -> Result<WorkerEnd, WorkerError> {
        let shutdown = &self.context.shutdown;
        let is_over = CancellationToken::new();
        if let Some(end) = self.end {
            let (shutdown, is_over) = (shutdown.clone(), is_over.clone());
            tokio::spawn(async move {
                tokio::time::sleep_until(end.into()).await;
                is_over.cancel();
                shutdown.cancel();
            });
        }
        tracing::info!(name = %self.claim.name, id = %self.claim.worker_id, threads = self.claim.threads,
            server = self.context.server.address(), calibration = ?self.claim.calibration, "ready");
        let mut idle_since = Instant::now();
        let mut away_pause = None;
        let mut has_worked = false;
        while !shutdown.is_cancelled() {
            if self.is_too_late() {
                return Ok(self.time_over(has_worked));
            }
            match self.claim().await {
                Ok(Some((lease, direct_from))) => {
                    tracing::info!(job = %lease.job_id, attempt = lease.attempt, kind = %lease.kind, "claimed");
                    let job_id = lease.job_id;
                    has_worked = true;
                    match self.context.carry_out(lease, direct_from).await {
                        Ok(()) => tracing::info!(job = %job_id, "lease ended"),
                        Err(error) => {
                            tracing::warn!(job = %job_id, %error, "everything of this attempt is dropped");
                            self.pause(FIRST_PAUSE).await;
                        }
                    }
                    idle_since = Instant::now();
                }
                Ok(None) => {}
                Err(error) if error.is_transient() => {
                    if away_pause.is_none() {
                        tracing::warn!(%error, "waiting for the server");
                    }
                    let pause = away_pause.map_or(FIRST_PAUSE, |pause: Duration| 2 * pause);
                    let pause = pause.min(LONGEST_PAUSE);
                    away_pause = Some(pause);
                    let longest = self.exit_when_idle.unwrap_or(Duration::MAX);
                    self.pause(error.pause(pause).min(longest)).await;
                    if !self.is_idle_too_long(idle_since) {
                        continue;
                    }
                }
                Err(error) => return Err(WorkerError::Server(error)),
            }
            if away_pause.take().is_some() {
                tracing::info!("the server is back");
            }
            if self.is_idle_too_long(idle_since) {
                return Ok(WorkerEnd::Idle);
            }
        }
        Ok(match is_over.is_cancelled() {
            true => self.time_over(has_worked),
            false => WorkerEnd::Stopped,
        })
    }

    /// What the end of its time is called. One that was to end when idle and had nothing to do in all its time
    /// is: were it run again because its time was over, and its time is shorter than it may be idle, it would
    /// be run again for ever.
    fn time_over(&self, has_worked: bool) -> WorkerEnd {
        match has_worked || self.exit_when_idle.is_none() {
            true => WorkerEnd::TimeOver,
            false => WorkerEnd::Idle,
        }
    }

    /// Time until it ends, `None` when it goes on for ever.
    fn time_left(&self) -> Option<Duration> {
        self.end
            .map(|end| end.saturating_duration_since(Instant::now()))
    }

    /// Whether too little time is left to take another job: what it would come to is less than what is
    /// computed between two checkpoints.
    fn is_too_late(&self) -> bool {
        self.time_left()
            .is_some_and(|left| left < self.context.checkpoint_every)
    }

    async fn pause(&self, pause: Duration) {
        tokio::select! {
            () = tokio::time::sleep(pause) => {}
            () = self.context.shutdown.cancelled() => {}
        }
    }

    fn is_idle_too_long(&self, idle_since: Instant) -> bool {
        self.exit_when_idle
            .is_some_and(|longest| idle_since.elapsed() >= longest)
    }

    /// A lease, and from how many bytes on its files may go to the server's bucket.
    async fn claim(&self) -> Result<Option<(Lease, Option<u64>)>, ServerError> {
        let server = &self.context.server;
        let mut claim = self.claim.clone();
        let memory = [claim.memory_mb, free_memory_mb()];
        claim.memory_mb = memory.into_iter().flatten().reduce(f64::min);
        claim.disk_mb = self.context.scratch.free_mb();
        claim.time_left_s = self.time_left().map(|left| left.as_secs_f64());
        for longest in [self.exit_when_idle, self.time_left()]
            .into_iter()
            .flatten()
        {
            claim.wait_s = claim.wait_s.min(longest.as_secs_f64());
        }
        let request = server
            .request(Method::POST, "/v1/worker/claims")
            .timeout(Duration::from_secs_f64(claim.wait_s) + CLAIM_MARGIN)
            .json(&claim);
        let answer = server.send(request).await?;
        if answer.status() == StatusCode::NO_CONTENT {
            return Ok(None);
        }
        let direct_from = answer.headers().get(DIRECT_FROM_HEADER);
        let direct_from = direct_from.and_then(|bytes| bytes.to_str().ok()?.parse().ok());
        let lease = answer.json().await;
        let lease = lease.map_err(|error| server.unreachable(&error))?;
        Ok(Some((lease, direct_from)))
    }
}
