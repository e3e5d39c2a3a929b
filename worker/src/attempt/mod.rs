//! One lease, from its claim to its end.
//!
//! Three things go on side by side: the simulation on a thread of its own, the heartbeat, and the
//! `uploader` that sends points, files and checkpoints to the server. Whoever learns first that
//! the run shall stop (a command in an answer, a lost lease, the time limit, this process told to
//! end) turns the `AttemptSwitch`; the simulation looks at it many times a second. When all
//! results have arrived the lease is ended: complete, fail, release, or fault when this machine
//! cannot carry the job out and another may. Of a job that nobody wants any more the lease is ended at once,
//! and the next claimed when the simulation's thread has come to its next look at the switch. Once the lease
//! is lost, everything is dropped; the server refuses what may still be under way.
mod backlog;
mod batch;
mod contact;
mod content;
mod direct;
mod ending;
mod heartbeat;
mod lease_client;
mod stop;
mod uploader;

use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

use loadframe_api::worker::{FaultCode, FaultRequest, Lease};
use loadframe_api::{Calibration, JobSpec, sha256_hex};
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::{
    Destination, Ended, Engine, Plan, RunError, SavedRun, StopCause, execute, free_memory_mb,
};
use tokio::sync::oneshot;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;

use crate::scratch::Scratch;
use contact::Contact;
use ending::RunEnd;
use lease_client::LeaseClient;
use stop::AttemptSwitch;

/// How long a run may take to see that nothing of it is wanted, before its lease is ended without it: with a
/// heartbeat every second a person sees the job end within two.
const LAST_LOOK: Duration = Duration::from_millis(500);

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
    /// A server that is away for longer has its job dropped.
    pub(crate) server_away: Duration,
    /// Cancelled when this process is to end.
    pub(crate) shutdown: CancellationToken,
}

impl AttemptContext {
    /// Carries out the job of `lease` and ends the lease. Contents of `direct_from` bytes or more go to the
    /// server's bucket.
    ///
    /// # Errors
    /// When the lease was lost; everything of this attempt is dropped.
    pub(crate) async fn carry_out(
        &self,
        lease: Lease,
        direct_from: Option<u64>,
    ) -> Result<(), ServerError> {
        let switch = Arc::new(AttemptSwitch::default());
        let contact = Contact::lasting(self.server_away);
        let client = LeaseClient::new(
            self.server.clone(),
            &lease,
            direct_from,
            Arc::clone(&contact),
            Arc::clone(&switch),
        );
        let files = Arc::new(AtomicU64::new(0));
        let _heartbeat = AbortOnDropHandle::new(tokio::spawn(heartbeat::keep_alive(
            client.over(self.heartbeat_server.clone()),
            heartbeat::Schedule::of(&lease, Arc::clone(&files)),
            Arc::clone(&switch),
        )));
        let _shutdown = AbortOnDropHandle::new(tokio::spawn({
            let (shutdown, switch) = (self.shutdown.clone(), Arc::clone(&switch));
            async move {
                shutdown.cancelled().await;
                switch.stop(StopCause::Shutdown);
            }
        }));
        match self.run(&lease, &client, &switch, &files).await {
            Ok(ended) => ended,
            Err(AttemptError::Server(error @ ServerError::LeaseLost)) => Err(error),
            Err(AttemptError::Stopped) => {
                ending::end(&client, &switch, Ok(Ok(Ended::Suspended)), Ok(())).await
            }
            Err(error) => {
                let fault = FaultRequest {
                    code: error.code(),
                    reason: error.to_string(),
                };
                tracing::error!(job = %lease.job_id, error = %fault.reason, "this machine cannot carry it out");
                client.fault(&fault).await
            }
        }
    }

    /// Runs the job and ends the lease. The outer error is one of this machine, the inner
    /// one that of the lease's end.
    async fn run(
        &self,
        lease: &Lease,
        client: &LeaseClient,
        switch: &Arc<AttemptSwitch>,
        files: &Arc<AtomicU64>,
    ) -> Result<Result<(), ServerError>, AttemptError> {
        // before anything of the job is looked at: whatever it does to this process counts as its doing
        client.begin().await.map_err(AttemptError::Server)?;
        let spec = JobSpec::from_json(lease.kind, lease.spec.get()).map_err(|error| {
            AttemptError::Spec {
                version: self.engine.version,
                reason: error.into_problem().to_string(),
            }
        })?;
        check_memory(&spec)?;
        let saved = tokio::select! {
            saved = self.saved_run(lease, client) => saved?,
            () = switch.stopped() => return Err(AttemptError::Stopped),
        };
        let folder = self.scratch.attempt().map_err(AttemptError::Scratch)?;
        let [results, outgoing] = ["results", "outgoing"].map(|name| folder.path().join(name));
        for part in [&results, &outgoing] {
            std::fs::create_dir(part).map_err(AttemptError::Scratch)?;
        }
        let (mut queue, uploader) = uploader::queue(
            outgoing,
            Arc::clone(files),
            client.contact(),
            lease.curve_points,
        );
        let uploader = AbortOnDropHandle::new(tokio::spawn({
            let (client, switch) = (client.clone(), Arc::clone(switch));
            async move {
                tokio::select! {
                    uploaded = uploader.upload(&client) => uploaded,
                    () = switch.given_up() => Err(ServerError::LeaseLost),
                }
            }
        }));
        let (ended, mut end) = oneshot::channel();
        let run = {
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
                let end = execute(&spec, saved, plan, &mut queue);
                // the queue goes with this closure, which lets the uploader finish
                queue.finish();
                let _ = ended.send(end);
            }
        };
        // not one of the runtime's threads: those panic where the system has none to give
        std::thread::Builder::new()
            .name("simulation".to_owned())
            .spawn(run)
            .map_err(AttemptError::Thread)?;
        let Some(run) = run_end(&mut end, switch).await else {
            // whoever cancelled is not kept waiting for a large system of equations to be solved
            let ended = ending::end(client, switch, Ok(Ok(Ended::Cancelled)), Ok(())).await;
            // and the next job not crowded by it
            tokio::select! {
                _ = end => {}
                () = self.shutdown.cancelled() => {}
            }
            return Ok(ended);
        };
        let uploaded = uploader.await.unwrap_or(Err(ServerError::LeaseLost));
        Ok(ending::end(client, switch, run, uploaded).await)
    }

    /// What an earlier attempt left, or why it cannot be used.
    async fn saved_run(
        &self,
        lease: &Lease,
        client: &LeaseClient,
    ) -> Result<Option<Result<SavedRun, String>>, AttemptError> {
        let Some(newest) = &lease.checkpoint else {
            return Ok(None);
        };
        let mut unusable: Option<(String, String)> = None;
        // the newest, and the one before
        for _ in 0..2 {
            let before = unusable.as_ref().map(|(sha256, _)| sha256.as_str());
            let fetched = client.checkpoint(before).await;
            let Some(bytes) = fetched.map_err(AttemptError::Server)? else {
                break;
            };
            match SavedRun::from_bytes(&bytes, self.engine, &lease.spec_sha256) {
                Ok(saved) => return Ok(Some(Ok(saved))),
                Err(error) => unusable = Some((sha256_hex(&bytes), error.to_string())),
            }
        }
        let reason = match unusable {
            Some((_, reason)) => reason,
            None => format!("the checkpoint of {:.0} s of work is lost", newest.wall_s),
        };
        Ok(Some(Err(reason)))
    }
}

/// What the run came to; `None` when nothing of it has been wanted for longer than one takes that looks at the
/// switch as often as it should, and it does not come back.
async fn run_end(
    end: &mut oneshot::Receiver<Result<Ended, RunError>>,
    switch: &AttemptSwitch,
) -> Option<RunEnd> {
    let abandoned = async {
        switch.given_up().await;
        tokio::time::sleep(LAST_LOOK).await;
    };
    tokio::select! {
        run = end => Some(run),
        () = abandoned => None,
    }
}

/// Refuses a job that is estimated to need more memory than this machine has free; where the system does
/// not say how much that is, none.
fn check_memory(spec: &JobSpec) -> Result<(), AttemptError> {
    let needed = spec.estimate(&Calibration::default()).memory_mb;
    match free_memory_mb() {
        Some(free) if needed > free => Err(AttemptError::Memory { needed, free }),
        _ => Ok(()),
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
    #[error("this worker can start no thread: {0}")]
    Thread(#[source] std::io::Error),
    #[error("it needs about {needed:.0} MB of memory, and this machine has {free:.0} MB free")]
    Memory { needed: f64, free: f64 },
    #[error("the checkpoint could not be fetched: {0}")]
    Server(#[source] ServerError),
    /// It was told to stop before.
    #[error("stopped")]
    Stopped,
}

impl AttemptError {
    /// What is wrong with this machine.
    fn code(&self) -> FaultCode {
        match self {
            Self::Spec { .. } => FaultCode::Version,
            Self::Scratch(_) => FaultCode::Disk,
            Self::Thread(_) => FaultCode::Threads,
            Self::Memory { .. } => FaultCode::Memory,
            Self::Server(_) => FaultCode::Checkpoint,
            Self::Stopped => FaultCode::Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    /// A factorisation does not look at the switch: the lease must not wait for its end.
    #[tokio::test]
    async fn a_run_that_does_not_hear_a_cancel_is_waited_for_half_a_second() {
        let switch = AttemptSwitch::default();
        // it computes on, and says nothing
        let (_deaf, mut end) = oneshot::channel();
        switch.stop(StopCause::Cancel);
        let begin = Instant::now();
        assert!(run_end(&mut end, &switch).await.is_none());
        let waited = begin.elapsed();
        assert!(
            waited >= LAST_LOOK,
            "{waited:?}: one that hears is waited for"
        );
        assert!(waited < 3 * LAST_LOOK, "{waited:?}");
    }

    #[tokio::test]
    async fn a_run_whose_checkpoint_is_wanted_is_waited_for() {
        let switch = AttemptSwitch::default();
        let (ends, mut end) = oneshot::channel();
        switch.stop(StopCause::Pause);
        let run = async {
            tokio::time::sleep(2 * LAST_LOOK).await;
            assert!(ends.send(Ok(Ended::Suspended)).is_ok(), "it is waited for");
        };
        let (run_end, ()) = tokio::join!(run_end(&mut end, &switch), run);
        assert!(matches!(run_end, Some(Ok(Ok(Ended::Suspended)))));
    }
}
