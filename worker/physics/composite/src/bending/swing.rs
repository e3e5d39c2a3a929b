//! What is read off a motion as it goes by.
use serde::{Deserialize, Serialize};

/// What is read off a motion as it goes by.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Swing {
    /// Largest mean deflection of the top face [mm], and when [s].
    pub(super) peak: f64,
    pub(super) peak_s: f64,
    /// Times at which it passed its middle on the way up [s], first and last, and how many.
    first_s: f64,
    last_s: f64,
    passes: u32,
    last: Option<(f64, f64)>,
}

impl Swing {
    pub(super) fn see(&mut self, time_s: f64, deflection: f64, middle: f64) {
        if deflection > self.peak || self.last.is_none() {
            self.peak = deflection;
            self.peak_s = time_s;
        }
        if let Some((before_s, before)) = self.last
            && before < middle
            && deflection >= middle
        {
            let way = (middle - before) / (deflection - before);
            self.last_s = before_s + way * (time_s - before_s);
            if self.passes == 0 {
                self.first_s = self.last_s;
            }
            self.passes += 1;
        }
        self.last = Some((time_s, deflection));
    }

    /// Swings over the time between the first and the last pass [Hz]; `None` before a whole one.
    pub(super) fn frequency_hz(&self) -> Option<f64> {
        (self.passes > 1).then(|| f64::from(self.passes - 1) / (self.last_s - self.first_s))
    }
}
