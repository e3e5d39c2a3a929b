//! The granular scene as a kind of job.
use super::{ContactLaw, GranularScene, checks, estimate, results::RESULTS};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Extent, Violations};

impl Spec for GranularScene {
    const RESULTS: &'static [&'static [Named]] = &[RESULTS];
    const IS_RESUMABLE: bool = true;

    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy.write_out();
        self.laws.local_damping = Some(self.local_damping());
        if self.laws.contact == ContactLaw::HertzMindlin {
            for material in self.materials.values_mut() {
                material.poisson_ratio = Some(material.poisson_ratio());
            }
        }
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn extent(&self) -> Extent {
        Extent {
            parts: self.particles() as f64,
            what: "particles",
        }
    }

    fn curve_columns(&self) -> Vec<String> {
        Self::curve_columns(self)
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}
