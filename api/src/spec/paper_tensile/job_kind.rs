//! The tensile test of paper as a kind of job.
use super::{PaperTensile, SHEET_CURVE, Specimen, checks, estimate, results::RESULTS};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Extent, Violations};

impl Spec for PaperTensile {
    const RESULTS: &'static [&'static [Named]] = &[RESULTS];
    const IS_RESUMABLE: bool = true;

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

    fn extent(&self) -> Extent {
        estimate::extent(self)
    }

    fn curve_columns(&self) -> Vec<String> {
        let names: &[&str] = match &self.specimen {
            Specimen::SingleFibre(fibre) => fibre.load.curve_columns(),
            _ => &SHEET_CURVE,
        };
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    fn largest_strain(&self) -> Option<f64> {
        Some(self.test.max_strain)
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}
