//! A ballast test as a kind of job.
use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};

use super::{Apparatus, Ballast, checks, estimate};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violations};

impl<A> Spec for Ballast<A>
where
    A: Apparatus + Serialize + DeserializeOwned + JsonSchema,
{
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

    fn seed(&self) -> u64 {
        self.seed
    }
}
