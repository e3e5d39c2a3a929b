//! What stops tests side by side.
use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

use crate::{Interrupt, InterruptSource};

/// What may stop tests side by side: an interrupt that one of them saw stops all, a failure stops
/// those behind it.
pub(super) struct Gate<'a> {
    source: &'a dyn InterruptSource,
    /// The highest interrupt seen: 0 for none, 1 for suspend, 2 for cancel.
    seen: AtomicU8,
    /// The first test in the plan's order that failed so far.
    failed: AtomicUsize,
}

impl<'a> Gate<'a> {
    pub(super) fn new(source: &'a dyn InterruptSource) -> Self {
        Self {
            source,
            seen: AtomicU8::new(0),
            failed: AtomicUsize::new(usize::MAX),
        }
    }

    /// Where interrupts come from.
    pub(super) fn source(&self) -> &dyn InterruptSource {
        self.source
    }

    /// Stops every test.
    pub(super) fn stop(&self, interrupt: Interrupt) {
        let rank = match interrupt {
            Interrupt::Suspend => 1,
            Interrupt::Cancel => 2,
        };
        self.seen.fetch_max(rank, Ordering::Relaxed);
    }

    /// Stops the tests behind `run`. Those before it go on: one of them may fail as well, and the
    /// error told is that of the first in the plan on any number of threads.
    pub(super) fn fail(&self, run: usize) {
        self.failed.fetch_min(run, Ordering::Relaxed);
    }

    /// What was seen so far.
    pub(super) fn seen(&self) -> Option<Interrupt> {
        match self.seen.load(Ordering::Relaxed) {
            0 => None,
            1 => Some(Interrupt::Suspend),
            _ => Some(Interrupt::Cancel),
        }
    }

    /// Whether test `run` need not begin.
    pub(super) fn is_closed(&self, run: usize) -> bool {
        self.seen().is_some() || self.failed.load(Ordering::Relaxed) < run
    }
}

/// The gate as test `run` sees it.
pub(super) struct Passage<'a> {
    pub(super) gate: &'a Gate<'a>,
    pub(super) run: usize,
}

impl InterruptSource for Passage<'_> {
    fn interrupt(&self) -> Option<Interrupt> {
        if let Some(interrupt) = self.gate.source.interrupt() {
            self.gate.stop(interrupt);
        }
        if self.gate.failed.load(Ordering::Relaxed) < self.run {
            return Some(Interrupt::Cancel);
        }
        self.gate.seen()
    }
}
