//! One lease, from its claim to its end.
//!
//! Three things go on side by side: the simulation on a thread of its own, the heartbeat, and the
//! `courier` that brings points, files and checkpoints to the server. Whoever learns first that
//! the run shall stop (a command in an answer, a lost lease, the time limit, this process told to
//! end) throws the [`StopSwitch`]; the simulation looks at it many times a second. When all
//! results have arrived the lease is ended: complete, fail or release. Once the lease is lost,
//! everything is dropped; the server refuses what may still be under way.
mod batch;
mod courier;
mod ending;
mod heartbeat;
mod lease_client;

use std::sync::Arc;
use std::time::Duration;

use loadframe_api::JobSpec;
use loadframe_api::worker::{FailCode, FailRequest, Lease};
use tokio::task::JoinError;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;

use crate::client::{ServerClient, ServerError};
use crate::run::{Destination, Ended, Plan, RunError, SavedRun, execute};
use crate::scratch::Scratch;
use crate::stop::{StopCause, StopSwitch};
use lease_client::LeaseClient;

/// What attempts of one worker process have in common.
#[derive(Debug)]
pub(crate) struct Workplace {
    pub(crate) server: ServerClient,
    /// Heartbeats have connections of their own, so that an upload cannot hold them up.
    pub(crate) heartbeat_server: ServerClient,
    pub(crate) scratch: Scratch,
    pub(crate) threads: usize,
    pub(crate) checkpoint_every: Duration,
    /// Cancelled when this process is to end.
    pub(crate) shutdown: CancellationToken,
}

/// What became of a run: what the simulation said, or why its thread did not come back.
type RunEnd = Result<Result<Ended, RunError>, JoinError>;

impl Workplace {
    /// Carries out the job of `lease` and ends the lease.
    ///
    /// # Errors
    /// When the lease was lost; everything of this attempt is dropped.
    pub(crate) async fn carry_out(&self, lease: Lease) -> Result<(), ServerError> {
        let switch = Arc::new(StopSwitch::default());
        let client = LeaseClient::new(self.server.clone(), &lease, Arc::clone(&switch));
        let _heartbeat = AbortOnDropHandle::new(tokio::spawn(heartbeat::keep_alive(
            client.through(self.heartbeat_server.clone()),
            heartbeat::Rhythm::of(&lease),
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
        switch: &Arc<StopSwitch>,
    ) -> Result<Result<(), ServerError>, AttemptError> {
        let spec = JobSpec::from_json(lease.kind, lease.spec.get())
            .map_err(|error| AttemptError::Spec(error.into_problem().to_string()))?;
        let saved = self.saved_run(lease, client).await?;
        let folder = self.scratch.attempt().map_err(AttemptError::Scratch)?;
        let [results, outgoing] = ["results", "outgoing"].map(|name| folder.path().join(name));
        for part in [&results, &outgoing] {
            std::fs::create_dir(part).map_err(AttemptError::Scratch)?;
        }
        let (mut sender, courier) = courier::channel(outgoing);
        let courier = AbortOnDropHandle::new(tokio::spawn({
            let (client, switch) = (client.clone(), Arc::clone(switch));
            async move {
                tokio::select! {
                    delivered = courier.deliver(&client) => delivered,
                    () = switch.given_up() => Err(ServerError::LeaseLost),
                }
            }
        }));
        let run = tokio::task::spawn_blocking({
            let switch = Arc::clone(switch);
            let (threads, checkpoint_every) = (self.threads, self.checkpoint_every);
            move || {
                let saved = match saved {
                    Some(Err(reason)) => {
                        sender.log(&format!("{reason}; starting from the beginning"));
                        None
                    }
                    Some(Ok(saved)) => {
                        sender.log("going on from the checkpoint of an earlier attempt");
                        Some(saved)
                    }
                    None => None,
                };
                let plan = Plan {
                    folder: &results,
                    threads,
                    checkpoint_every,
                    switch: &switch,
                };
                // the sender goes with this closure, which lets the courier finish
                execute(&spec, saved, plan, &mut sender)
            }
        });
        let run: RunEnd = run.await;
        let delivered = courier.await.unwrap_or(Err(ServerError::LeaseLost));
        Ok(ending::end(client, switch.cause(), run, delivered).await)
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
        let bytes = client.checkpoint().await.map_err(AttemptError::Server)?;
        let saved = SavedRun::from_bytes(&bytes, &lease.spec_sha256);
        Ok(Some(saved.map_err(|error| error.to_string())))
    }
}

/// Why an attempt could not begin.
#[derive(Debug, thiserror::Error)]
enum AttemptError {
    #[error("this worker (version {version}) cannot read the job's spec: {0}", version = crate::ENGINE_VERSION)]
    Spec(String),
    #[error("this worker has no scratch folder: {0}")]
    Scratch(#[source] std::io::Error),
    #[error("the checkpoint could not be fetched: {0}")]
    Server(#[source] ServerError),
}
