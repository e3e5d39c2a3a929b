//! The calibration as a kind of job.
use super::{Calibrate, Template, checks};
use crate::results::Named;
use crate::spec_trait::{Spec, Studied};
use crate::{Calibration, Estimate, Extent, Sharing, Violations, study::Knob};

/// Megabytes a trial leaves in memory and files, besides its results.
const TRIAL_MB: f64 = 1e-3;
/// Megabytes of a number that is kept.
const NUMBER_MB: f64 = 8e-6;
/// Realisations tried in a study.
const REALISATIONS: [&str; 4] = ["1", "2", "4", "8"];
const MOST_REALISATIONS: &str = "16";

impl Spec for Calibrate {
    // they have the names of its parameters
    const RESULTS: &'static [&'static [Named]] = &[];
    const IS_RESUMABLE: bool = true;

    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        if let Ok(job) = self.job.read() {
            self.measured.normalise(&job);
        }
        if let Ok(template) = Template::new(&self.job) {
            self.job.spec = template.text();
            for free in &mut self.free {
                free.start = free.start.or_else(|| template.number(&free.parameter));
            }
        }
    }

    /// An upper bound: all trials, of which most searches need a part.
    fn estimate(&self, calibration: &Calibration) -> Estimate {
        let inner = self.job.read().ok();
        let inner = inner.map(|job| job.realisation(self.seed).estimate(calibration));
        let trials = f64::from(self.max_trials);
        let tests = trials * f64::from(self.realisations);
        let kept = tests * self.measured.count() as f64 * NUMBER_MB + trials * TRIAL_MB;
        Estimate {
            wall_s: tests * inner.map_or(0.0, |inner| inner.wall_s),
            memory_mb: inner.map_or(0.0, |inner| inner.memory_mb) + kept,
            disk_mb: 1.0 + kept,
            calibrated: false,
            threads_wall_s: None,
            sharing: Sharing {
                tests: f64::from(self.realisations) * (1.0 + self.free.len() as f64),
                within: 0.0,
            },
        }
    }

    /// That of the job whose parameters are sought.
    fn extent(&self) -> Extent {
        let inner = self.job.read().ok();
        inner.map_or(
            Extent {
                parts: 0.0,
                what: "parts",
            },
            |inner| inner.extent(),
        )
    }

    /// Those of the job it calibrates.
    fn curve_columns(&self) -> Vec<String> {
        Vec::new()
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}

impl Studied for Calibrate {
    fn knobs(&self) -> Vec<Knob> {
        vec![Knob::new(
            "realisations",
            "specimens tested at every trial, a whole number from 1 to 1000",
            self.realisations,
            &REALISATIONS,
            MOST_REALISATIONS,
        )]
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        if knob != "realisations" {
            return None;
        }
        self.realisations = value.parse().ok()?;
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
    }

    fn compares(result: &str) -> bool {
        // counts of work say nothing of what was found
        !["trials", "tests"].contains(&result)
    }
}
