//! The tensile test of paper as a kind of job.
use super::{PaperTensile, checks, estimate};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violations};

impl Spec for PaperTensile {
    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy.write_out();
        self.model.level = Some(self.level());
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}
