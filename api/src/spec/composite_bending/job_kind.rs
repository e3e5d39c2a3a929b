//! The test of a composite's section as a kind of job.
use super::{CompositeBending, checks, estimate, results::RESULTS};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Earlier, Estimate, Extent, Violations};

impl Spec for CompositeBending {
    const RESULTS: &'static [&'static [Named]] = &[RESULTS];
    const IS_RESUMABLE: bool = true;

    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn learn(&mut self, earlier: &Earlier, violations: &mut Violations) {
        for (name, material) in &mut self.materials {
            material.learn(name, earlier, violations);
        }
    }

    fn normalise(&mut self) {
        self.grid = Some(self.grid());
        self.accuracy.write_out();
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn extent(&self) -> Extent {
        Extent {
            parts: self.particles() as f64,
            what: "cells",
        }
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
}
