//! The granular scene as a kind of job.
use super::{Accuracy, ContactLaw, GranularScene, checks, curve, estimate, study};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violation, study::Knob};

impl Spec for GranularScene {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.accuracy.knobs());
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

    fn curve_columns(&self) -> Vec<String> {
        curve::columns(self)
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

    fn compares(result: &str) -> bool {
        study::compares(result)
    }
}
