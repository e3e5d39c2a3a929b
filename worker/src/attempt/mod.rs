//! One lease, from its claim to its end.
//!
//! Three things go on side by side: the simulation on a thread of its own, the heartbeat, and the
//! `uploader` that sends points, files and checkpoints to the server. Whoever learns first that
//! the run shall stop (a command in an answer, a lost lease, the time limit, this process told to
//! end) turns the `AttemptSwitch`; the simulation looks at it many times a second. When all
//! results have arrived the lease is ended: complete, fail or release. Once the lease is lost,
//! everything is dropped; the server refuses what may still be under way.
mod batch;
mod ending;
mod heartbeat;
mod lease_client;
mod stop;
mod uploader;

use std::sync::Arc;
use std::time::Duration;

use loadframe_api::JobSpec;
use loadframe_api::worker::{FailCode, FailRequest, Lease};
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::{Destination, Engine, Plan, SavedRun, StopCause, execute};
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;

use crate::scratch::Scratch;
use ending::RunEnd;
use lease_client::LeaseClient;
use stop::AttemptSwitch;

/// What attempts of one worker process have in common.
#[derive(Debug)]
pub(crate) struct AttemptContext {
    /// What computes.
    pub(crate) engine: Engine,
    pub(crate) server: ServerClient,
    /// Heartbeats have connections of their own, so that an upload cannot hold them up.
    pub(crate) heartbeat_server: ServerClient,
    pub(crate) scratch: Scratch,
    pub(crate) threads: usize,
    pub(crate) checkpoint_every: Duration,
    /// Cancelled when this process is to end.
    pub(crate) shutdown: CancellationToken,
}

impl AttemptContext {
    /// Carries out the job of `lease` and ends the lease.
    ///
    /// # Errors
    /// When the lease was lost; everything of this attempt is dropped.
    pub(crate) async fn carry_out(&self, lease: Lease) -> Result<(), ServerError> {
        let switch = Arc::new(AttemptSwitch::default());
        let client = LeaseClient::new(self.server.clone(), &lease, Arc::clone(&switch));
        let _heartbeat = AbortOnDropHandle::new(tokio::spawn(heartbeat::keep_alive(
            client.over(self.heartbeat_server.clone()),
            heartbeat::Schedule::of(&lease),
            Arc::clone(&switch),
        )));
        let _shutdown = AbortOnDropHandle::new(tokio::spawn({
            let (shutdown, switch) = (self.shutdown.clone(), Arc::clone(&switch));
            async move {
                shutdown.cancelled().await;
                switch.stop(StopCause::Shutdown);
            }
        }));
        match self.run(&lease, &client, &switch).await {
            Ok(ended) => ended,
            Err(AttemptError::Server(error @ ServerError::LeaseLost)) => Err(error),
            Err(error) => {
                let reason = FailRequest {
                    code: FailCode::WorkerError,
                    reason: error.to_string(),
                };
                client.fail(&reason).await
            }
        }
    }

    /// Runs the job and ends the lease. The outer error is one that fails the job, the inner one
    /// is that of the lease's end.
    async fn run(
        &self,
        lease: &Lease,
        client: &LeaseClient,
        switch: &Arc<AttemptSwitch>,
    ) -> Result<Result<(), ServerError>, AttemptError> {
        let spec = JobSpec::from_json(lease.kind, lease.spec.get()).map_err(|error| {
            AttemptError::Spec {
                version: self.engine.version,
                reason: error.into_problem().to_string(),
            }
        })?;
        let saved = self.saved_run(lease, client).await?;
        let folder = self.scratch.attempt().map_err(AttemptError::Scratch)?;
        let [results, outgoing] = ["results", "outgoing"].map(|name| folder.path().join(name));
        for part in [&results, &outgoing] {
            std::fs::create_dir(part).map_err(AttemptError::Scratch)?;
        }
        let (mut queue, uploader) = uploader::queue(outgoing);
        let uploader = AbortOnDropHandle::new(tokio::spawn({
            let (client, switch) = (client.clone(), Arc::clone(switch));
            async move {
                tokio::select! {
                    uploaded = uploader.upload(&client) => uploaded,
                    () = switch.given_up() => Err(ServerError::LeaseLost),
                }
            }
        }));
        let run = tokio::task::spawn_blocking({
            let switch = Arc::clone(switch);
            let (engine, threads) = (self.engine, self.threads);
            let checkpoint_every = self.checkpoint_every;
            move || {
                let saved = match saved {
                    Some(Err(reason)) => {
                        queue.log(&format!("{reason}; starting from the beginning"));
                        None
                    }
                    Some(Ok(saved)) => {
                        queue.log("going on from the checkpoint of an earlier attempt");
                        Some(saved)
                    }
                    None => None,
                };
                let plan = Plan {
                    engine,
                    folder: &results,
                    threads,
                    checkpoint_every,
                    switch: switch.run(),
                };
                // the queue goes with this closure, which lets the uploader finish
                execute(&spec, saved, plan, &mut queue)
            }
        });
        let run: RunEnd = run.await;
        let uploaded = uploader.await.unwrap_or(Err(ServerError::LeaseLost));
        Ok(ending::end(client, switch.cause(), run, uploaded).await)
    }

    /// What an earlier attempt left, or why it cannot be used.
    async fn saved_run(
        &self,
        lease: &Lease,
        client: &LeaseClient,
    ) -> Result<Option<Result<SavedRun, String>>, AttemptError> {
        if lease.checkpoint.is_none() {
            return Ok(None);
        }
        let bytes = match client.checkpoint().await {
            Ok(bytes) => bytes,
            // the server has found it missing or changed, and forgotten it
            Err(ServerError::Refused(problem)) if problem.status == 404 => {
                return Ok(Some(Err(problem.detail)));
            }
            Err(error) => return Err(AttemptError::Server(error)),
        };
        let saved = SavedRun::from_bytes(&bytes, self.engine, &lease.spec_sha256);
        Ok(Some(saved.map_err(|error| error.to_string())))
    }
}

/// Why an attempt could not begin.
#[derive(Debug, thiserror::Error)]
enum AttemptError {
    #[error("this worker (version {version}) cannot read the job's spec: {reason}")]
    Spec {
        version: &'static str,
        reason: String,
    },
    #[error("this worker has no scratch folder: {0}")]
    Scratch(#[source] std::io::Error),
    #[error("the checkpoint could not be fetched: {0}")]
    Server(#[source] ServerError),
}
