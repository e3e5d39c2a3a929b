//! Changing the stiffness of everything in a scene while it runs.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Multiplies the Young's modulus of every material by `factor`, little by little, while the bodies
/// move: for a bed that was made of softened grains, in few steps, and is tested with stiff ones.
///
/// The modulus grows (or falls) by the same ratio with every part of the stage, so that overlaps
/// follow and forces stay those that carry the weight. An automatic time step follows the modulus.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stiffen {
    #[schemars(range(min = 1e-9, max = 1e9), extend("x-unit" = "1"))]
    pub factor: f64,
    /// Length of the stage. Contacts of a bed carry a change on to their neighbours in some ten
    /// steps each; two hundred steps for every doubling leave most beds at rest.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: u64,
}

impl Stiffen {
    /// What the modulus is multiplied with, when so many steps of the stage are done.
    pub fn factor_after(&self, steps: u64) -> f64 {
        if steps >= self.steps {
            return self.factor;
        }
        self.factor.powf(steps as f64 / self.steps as f64)
    }
}
