//! What a run takes, over all its attempts.
use std::time::{Duration, Instant};

use super::machine::{forget_peak_memory, processor_time_s};

/// Wall and processor time [s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spent {
    pub wall_s: f64,
    pub cpu_s: f64,
}

/// Measures what a run takes, on top of what earlier attempts took up to their checkpoint.
#[derive(Debug)]
pub(crate) struct CostClock {
    before: Spent,
    started: Instant,
    processor_time_at_start_s: f64,
}

impl CostClock {
    pub(crate) fn start(before: Spent) -> Self {
        forget_peak_memory();
        Self {
            before,
            started: Instant::now(),
            processor_time_at_start_s: processor_time_s(),
        }
    }

    pub(crate) fn spent(&self) -> Spent {
        Spent {
            wall_s: self.before.wall_s + self.elapsed().as_secs_f64(),
            cpu_s: self.before.cpu_s + (processor_time_s() - self.processor_time_at_start_s),
        }
    }

    /// Time since this attempt began.
    pub(crate) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }
}
