//! How fast a machine is, and what a job will therefore take.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Measured speed of a machine, by a short run of the real solver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Calibration {
    /// Evaluations of one bond (energy, force or stiffness times vector) per second and core.
    pub bond_evaluations_per_s: f64,
}

impl Default for Calibration {
    /// Used until a worker has measured: a core of about 2020.
    fn default() -> Self {
        Self {
            bond_evaluations_per_s: 1.0e8,
        }
    }
}

/// What a job is expected to take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Wall time on one core [s]. Breaking makes this uncertain by about a factor of 2.
    pub wall_s: f64,
    /// Wall time on the threads that the submission asks for [s]; absent where it asks for one or for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threads_wall_s: Option<f64>,
    /// Peak memory [MB].
    pub memory_mb: f64,
    /// Size of all result files [MB].
    pub disk_mb: f64,
    /// Whether a worker's measurement stands behind the time, or only a typical machine.
    pub calibrated: bool,
    /// What threads share of it.
    #[serde(skip)]
    pub sharing: Sharing,
}

impl Estimate {
    /// Of so many such tests with other seeds, of which the first alone leaves its files. As many are in
    /// memory at once as there are threads, which a spec does not know: it is told for one core.
    #[must_use]
    pub(crate) fn of_repeats(self, repeats: u32) -> Self {
        let tests = f64::from(repeats);
        Self {
            wall_s: tests * self.wall_s,
            sharing: Sharing {
                tests,
                ..self.sharing
            },
            ..self
        }
    }

    /// With the time on so many threads.
    #[must_use]
    pub fn on_threads(self, threads: Option<u32>) -> Self {
        let several = threads.filter(|&threads| threads > 1);
        Self {
            threads_wall_s: several.map(|threads| self.wall_s * self.sharing.time_on(threads)),
            ..self
        }
    }
}

/// What several threads share of a job: whole tests, and passes within one. Measured on two threads
/// (the guide's table `threads`); on more of them Amdahl's law carries it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sharing {
    /// Tests that run side by side, a thread each.
    pub tests: f64,
    /// Share of the time of one test that all of its threads work through together (0 to 1).
    pub within: f64,
}

impl Default for Sharing {
    fn default() -> Self {
        Self::ALONE
    }
}

impl Sharing {
    /// One test on one thread.
    pub const ALONE: Self = Self {
        tests: 1.0,
        within: 0.0,
    };

    /// Time on so many threads over that on one. As the plan of side-by-side tests deals them out:
    /// a test gets as many threads as all of them have.
    fn time_on(self, threads: u32) -> f64 {
        let threads = f64::from(threads.max(1));
        let tests = self.tests.max(1.0);
        let at_once = threads.min(tests);
        let of_each = (threads / at_once).floor();
        let rounds = (tests / at_once).ceil();
        rounds / tests * (1.0 - self.within + self.within / of_each)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time on threads over that on one, in thousandths.
    fn times(tests: f64, within: f64, threads: u32) -> u32 {
        (1e3 * Sharing { tests, within }.time_on(threads)).round() as u32
    }

    #[test]
    fn tests_are_dealt_out_and_what_is_left_of_threads_shares_them() {
        assert_eq!(times(1.0, 0.0, 8), 1000);
        assert_eq!(times(10.0, 0.0, 2), 500);
        // three rounds of four places
        assert_eq!(times(10.0, 0.0, 4), 300);
        assert_eq!(times(1.0, 1.0, 4), 250);
        assert_eq!(times(1.0, 0.5, 2), 750);
        // two tests of two threads each
        assert_eq!(times(2.0, 0.5, 4), 375);
    }

    #[test]
    fn who_asks_for_no_threads_is_told_of_one_core() {
        let one = Estimate {
            wall_s: 10.0,
            threads_wall_s: None,
            memory_mb: 1.0,
            disk_mb: 1.0,
            calibrated: false,
            sharing: Sharing {
                tests: 4.0,
                within: 0.0,
            },
        };
        assert_eq!(one.on_threads(None).threads_wall_s, None);
        assert_eq!(one.on_threads(Some(1)).threads_wall_s, None);
        assert_eq!(one.on_threads(Some(2)).threads_wall_s, Some(5.0));
    }
}
