//! The unit cell as a kind of job.
use super::{Accuracy, CompositeCell, checks, estimate, results::RESULTS};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Extent, Violations};

impl Spec for CompositeCell {
    const RESULTS: &'static [&'static [Named]] = &[RESULTS];
    /// The field of a cell is solved in one go.
    const IS_RESUMABLE: bool = false;

    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.chosen_knobs());
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn extent(&self) -> Extent {
        let [columns, rows] = self.cells().map(f64::from);
        Extent {
            parts: columns * rows,
            what: "cells",
        }
    }

    /// It has no curve.
    fn curve_columns(&self) -> Vec<String> {
        Vec::new()
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}
