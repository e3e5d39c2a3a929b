//! A ballast test as a kind of job.
use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};

use super::super::granular_scene::Grain;
use super::{Accuracy, Apparatus, Ballast, checks, curve_columns, estimate, study};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violation, study::Knob};

impl<A> Spec for Ballast<A>
where
    A: Apparatus + Serialize + DeserializeOwned + JsonSchema,
{
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.accuracy.knobs());
        self.materials = self.resolved_materials();
        self.grains.sizes = self.grains.sizes();
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn curve_columns(&self) -> Vec<String> {
        let is_breakable = matches!(self.grains.shape, Grain::Breakable(_));
        let names = curve_columns(is_breakable).into_iter();
        names.map(str::to_owned).collect()
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
        self.output.snapshots = 0;
    }

    fn compares(result: &str) -> bool {
        study::compares(result)
    }
}
