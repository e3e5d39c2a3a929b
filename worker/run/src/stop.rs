//! The switch by which everything around a run asks it to stop.
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use loadframe_physics::{Interrupt, InterruptSource};

/// Why a run shall stop early. A later one outranks an earlier one: who asked to pause may still
/// cancel, and a lost lease ends everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum StopCause {
    /// This process is to end: leave a checkpoint.
    Shutdown = 1,
    /// The job is to pause: leave a checkpoint.
    Pause,
    /// The job has taken far more than estimated: leave a checkpoint.
    BeyondEstimate,
    /// The job took longer than it may.
    TimeLimit,
    /// Nobody wants the result any more.
    Cancel,
    /// Another worker may have the job: nothing of this run counts any more.
    LeaseLost,
}

/// Stops a run; the first cause of the highest rank counts.
#[derive(Debug, Default)]
pub struct StopSwitch {
    cause: AtomicU8,
    shutdown: Arc<AtomicBool>,
}

impl StopSwitch {
    /// Asks the run to stop.
    pub fn stop(&self, cause: StopCause) {
        self.cause.fetch_max(cause as u8, Ordering::Relaxed);
    }

    /// What asks for [`StopCause::Shutdown`] once it is set, as the handler of a signal can.
    pub fn shutdown(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.shutdown)
    }

    /// Why the run shall stop, `None` while it shall go on.
    pub fn cause(&self) -> Option<StopCause> {
        use StopCause::{BeyondEstimate, Cancel, LeaseLost, Pause, Shutdown, TimeLimit};
        let told = self.cause.load(Ordering::Relaxed);
        let ending = self.shutdown.load(Ordering::Relaxed);
        let asked = told.max(if ending { Shutdown as u8 } else { 0 });
        [
            LeaseLost,
            Cancel,
            TimeLimit,
            BeyondEstimate,
            Pause,
            Shutdown,
        ]
        .into_iter()
        .find(|cause| *cause as u8 == asked)
    }
}

impl StopCause {
    /// Whether the run is to go on later; otherwise nothing of it is wanted any more.
    pub fn keeps_checkpoint(self) -> bool {
        self <= Self::BeyondEstimate
    }
}

impl InterruptSource for StopSwitch {
    fn interrupt(&self) -> Option<Interrupt> {
        self.cause().map(|cause| match cause.keeps_checkpoint() {
            true => Interrupt::Suspend,
            false => Interrupt::Cancel,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_cause_counts_whatever_the_order() {
        let switch = StopSwitch::default();
        assert_eq!(switch.interrupt(), None);
        switch.shutdown().store(true, Ordering::Relaxed);
        assert_eq!(switch.cause(), Some(StopCause::Shutdown));
        switch.stop(StopCause::Pause);
        switch.stop(StopCause::Shutdown);
        assert_eq!(switch.cause(), Some(StopCause::Pause));
        assert_eq!(switch.interrupt(), Some(Interrupt::Suspend));
        switch.stop(StopCause::Cancel);
        switch.stop(StopCause::Shutdown);
        assert_eq!(switch.cause(), Some(StopCause::Cancel));
        assert_eq!(switch.interrupt(), Some(Interrupt::Cancel));
    }
}
