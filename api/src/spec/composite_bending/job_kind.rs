//! The test of a composite's section as a kind of job.
use super::{Accuracy, CompositeBending, checks, estimate, study};
use crate::spec_trait::Spec;
use crate::{Calibration, Earlier, Estimate, Violation, study::Knob};

impl Spec for CompositeBending {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn learn(&mut self, earlier: &Earlier, violations: &mut Vec<Violation>) {
        for (name, material) in &mut self.materials {
            material.learn(name, earlier, violations);
        }
    }

    fn normalise(&mut self) {
        self.grid = Some(self.grid());
        self.accuracy = Accuracy::Knobs(self.accuracy.knobs());
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn curve_columns(&self) -> Vec<String> {
        self.columns()
            .iter()
            .map(|name| (*name).to_owned())
            .collect()
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
        self.output.picture = false;
    }

    fn compares(result: &str) -> bool {
        study::compares(result)
    }
}
