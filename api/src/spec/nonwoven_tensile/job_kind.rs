//! The nonwoven tensile test as a kind of job.
use super::{CURVE_COLUMNS, NonwovenTensile, checks, estimate};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violations};

impl Spec for NonwovenTensile {
    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy.write_out();
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
}
