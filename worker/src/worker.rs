//! A worker process: claims one lease after the other until it is told to stop.
use std::path::PathBuf;
use std::time::{Duration, Instant};

use loadframe_api::JobKind;
use loadframe_api::worker::{ClaimRequest, Lease};
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
/// Pause after a claim to a server that is away, and after a lease that was lost.
const AWAY_PAUSE: Duration = Duration::from_millis(500);

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
    /// Ends the worker after this time, its job saved and given back.
    pub max_runtime: Option<Duration>,
}

/// Why a worker ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkerEnd {
    /// It was told to, or its time was over.
    Stopped,
    /// No job came.
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
    max_runtime: Option<Duration>,
    /// When it was made ready.
    started: Instant,
}

impl Worker {
    /// Measures this machine and prepares a worker; takes a moment of computing.
    ///
    /// # Errors
    /// [`WorkerError::Scratch`].
    pub fn prepare(options: WorkerOptions) -> Result<Self, WorkerError> {
        let scratch = Scratch::open(&options.scratch).map_err(|source| WorkerError::Scratch {
            folder: options.scratch.clone(),
            source,
        })?;
        let claim = ClaimRequest {
            worker_id: Uuid::new_v4(),
            name: options.name,
            host: host_name(),
            threads: u32::try_from(options.threads).unwrap_or(u32::MAX),
            engine_version: options.engine.build(),
            kinds: JobKind::ALL.to_vec(),
            calibration: calibrate(),
            memory_mb: None,
            disk_mb: None,
            time_left_s: None,
            wait_s: CLAIM_WAIT_S,
        };
        Ok(Self {
            context: AttemptContext {
                engine: options.engine,
                server: options.server,
                heartbeat_server: options.heartbeat_server,
                scratch,
                threads: options.threads,
                checkpoint_every: options.checkpoint_every,
                shutdown: CancellationToken::new(),
            },
            claim,
            exit_when_idle: options.exit_when_idle,
            max_runtime: options.max_runtime,
            started: Instant::now(),
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
    pub async fn work(self) -> Result<WorkerEnd, WorkerError> {
        let shutdown = &self.context.shutdown;
        if let Some(max_runtime) = self.max_runtime {
            let shutdown = shutdown.clone();
            tokio::spawn(async move {
                tokio::time::sleep(max_runtime).await;
                shutdown.cancel();
            });
        }
        tracing::info!(name = %self.claim.name, id = %self.claim.worker_id, threads = self.claim.threads,
            server = self.context.server.address(), calibration = ?self.claim.calibration, "ready");
        let mut idle_since = Instant::now();
        let mut is_away = false;
        while !shutdown.is_cancelled() {
            match self.claim().await {
                Ok(Some(lease)) => {
                    tracing::info!(job = %lease.job_id, attempt = lease.attempt, kind = %lease.kind, "claimed");
                    let job_id = lease.job_id;
                    match self.context.carry_out(lease).await {
                        Ok(()) => tracing::info!(job = %job_id, "lease ended"),
                        Err(error) => {
                            tracing::warn!(job = %job_id, %error, "everything of this attempt is dropped");
                            self.pause().await;
                        }
                    }
                    idle_since = Instant::now();
                }
                Ok(None) => {}
                Err(error) if error.is_transient() => {
                    if !is_away {
                        tracing::warn!(%error, "waiting for the server");
                    }
                    is_away = true;
                    self.pause().await;
                    if !self.is_idle_too_long(idle_since) {
                        continue;
                    }
                }
                Err(error) => return Err(WorkerError::Server(error)),
            }
            if is_away {
                tracing::info!("the server is back");
                is_away = false;
            }
            if self.is_idle_too_long(idle_since) {
                return Ok(WorkerEnd::Idle);
            }
        }
        Ok(WorkerEnd::Stopped)
    }

    async fn pause(&self) {
        tokio::select! {
            () = tokio::time::sleep(AWAY_PAUSE) => {}
            () = self.context.shutdown.cancelled() => {}
        }
    }

    fn is_idle_too_long(&self, idle_since: Instant) -> bool {
        self.exit_when_idle
            .is_some_and(|longest| idle_since.elapsed() >= longest)
    }

    async fn claim(&self) -> Result<Option<Lease>, ServerError> {
        let server = &self.context.server;
        let mut claim = self.claim.clone();
        claim.memory_mb = free_memory_mb();
        claim.disk_mb = self.context.scratch.free_mb();
        claim.time_left_s = self.max_runtime.map(|longest| {
            let left = longest.saturating_sub(self.started.elapsed());
            left.as_secs_f64()
        });
        if let Some(longest) = self.exit_when_idle {
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
        let lease = answer.json().await;
        lease.map(Some).map_err(|error| server.unreachable(&error))
    }
}
