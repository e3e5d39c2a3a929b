//! The stop switch of an attempt, which tasks of this process can wait for.
use std::sync::OnceLock;

use loadframe_run::{StopCause, StopSwitch};
use tokio_util::sync::CancellationToken;

/// Stops a run, and what goes on beside it.
#[derive(Debug, Default)]
pub(super) struct AttemptSwitch {
    run: StopSwitch,
    stopped: CancellationToken,
    given_up: CancellationToken,
    excess: OnceLock<String>,
}

impl AttemptSwitch {
    /// Asks the run to stop.
    pub(super) fn stop(&self, cause: StopCause) {
        self.run.stop(cause);
        self.stopped.cancel();
        if !cause.keeps_checkpoint() {
            self.given_up.cancel();
        }
    }

    /// Asks the run to stop because it has taken more than it may, as `excess` says.
    pub(super) fn stop_for(&self, excess: String) {
        let _ = self.excess.set(excess);
        self.stop(StopCause::BeyondEstimate);
    }

    /// What the run has taken too much of.
    pub(super) fn excess(&self) -> Option<String> {
        self.excess.get().cloned()
    }

    /// Why the run shall stop, `None` while it shall go on.
    pub(super) fn cause(&self) -> Option<StopCause> {
        self.run.cause()
    }

    /// The switch that the run itself looks at.
    pub(super) fn run(&self) -> &StopSwitch {
        &self.run
    }

    /// Waits until the run shall stop, whyever.
    pub(super) async fn stopped(&self) {
        self.stopped.cancelled().await;
    }

    /// Waits until nothing of the run is wanted any more.
    pub(super) async fn given_up(&self) {
        self.given_up.cancelled().await;
    }
}
