//! The nonwoven tensile test as a kind of job.
use super::{Accuracy, CURVE_COLUMNS, NonwovenTensile, checks, estimate, study};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violation, study::Knob};

impl Spec for NonwovenTensile {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.accuracy.knobs());
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn curve_columns(&self) -> Vec<String> {
        CURVE_COLUMNS.map(str::to_owned).to_vec()
    }

    fn largest_strain(&self) -> Option<f64> {
        Some(self.test.max_strain)
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
        study::single(self, seed);
    }

    fn realise(&mut self, seed: u64) {
        study::realise(self, seed);
    }

    fn compares(result: &str) -> bool {
        study::compares(result)
    }
}
