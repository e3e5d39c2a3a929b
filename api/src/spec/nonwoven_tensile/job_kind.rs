//! The nonwoven tensile test as a kind of job.
use super::{CURVE_COLUMNS, HISTORY_COLUMNS, NonwovenTensile, checks, estimate, results::RESULTS};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Extent, Violations};

impl Spec for NonwovenTensile {
    const RESULTS: &'static [&'static [Named]] = &[RESULTS];
    const IS_RESUMABLE: bool = true;

    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy.write_out();
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn extent(&self) -> Extent {
        let (bonds, nodes) = (self.fabric.bonds(), self.fabric.nodes());
        // a network may have nodes that no bond ends in
        let (parts, what) = match bonds >= nodes {
            true => (bonds, "bonds"),
            false => (nodes, "nodes"),
        };
        Extent {
            parts: parts as f64,
            what,
        }
    }

    fn curve_columns(&self) -> Vec<String> {
        let mut columns = CURVE_COLUMNS.to_vec();
        if !self.test.history.is_empty() {
            columns.splice(2..2, HISTORY_COLUMNS);
        }
        columns.into_iter().map(str::to_owned).collect()
    }

    fn largest_strain(&self) -> Option<f64> {
        // a curve that comes back has no value for a strain
        self.test.history.is_empty().then_some(self.test.max_strain)
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}
