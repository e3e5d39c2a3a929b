//! The unit cell as a kind of job.
use super::{Accuracy, CompositeCell, checks, estimate, study};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violation, study::Knob};

impl Spec for CompositeCell {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.chosen_knobs());
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn knobs(&self) -> Vec<Knob> {
        study::knobs(self)
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        study::turn(self, knob, value)
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.repeats = 1;
        self.output.picture = false;
    }

    fn compares(_result: &str) -> bool {
        true
    }
}
