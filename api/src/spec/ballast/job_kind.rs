//! A ballast test as a kind of job.
use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};

use super::super::granular_scene::{Grain, results as scene};
use super::{Apparatus, Ballast, checks, curve_columns, estimate, results::RESULTS};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Extent, Violations};

impl<A> Spec for Ballast<A>
where
    A: Apparatus + Serialize + DeserializeOwned + JsonSchema,
{
    const RESULTS: &'static [&'static [Named]] = &[RESULTS, scene::RESULTS];
    const IS_RESUMABLE: bool = true;

    fn check(&self, violations: &mut Violations) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy.write_out();
        self.materials = self.resolved_materials();
        self.grains.sizes = self.grains.sizes();
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn extent(&self) -> Extent {
        self.script().scene.extent()
    }

    fn curve_columns(&self) -> Vec<String> {
        let is_breakable = matches!(self.grains.shape, Grain::Breakable(_));
        let names = curve_columns(self.apparatus.tilting().is_some(), is_breakable).into_iter();
        names.map(str::to_owned).collect()
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}
