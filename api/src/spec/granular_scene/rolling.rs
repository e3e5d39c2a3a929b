//! What contacts set against rolling and twisting: stand-ins for the shape that spheres have not.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::GranularScene;

/// Resistance of a contact to rolling and twisting, by springs that yield. With the spins ω of both
/// bodies, the normal n and the effective radius 1/R = 1/r_a + 1/r_b (R = r at a wall), moments grow
/// with the difference of the spins, M_r across n by k_r and M_t along n by k_t, up to their limits;
/// a dashpot beside them keeps within the limits. Between two materials the smaller frictions and
/// stiffness count and the larger damping; a material without resistance has none with any other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RollingResistance {
    /// μ_r: |M_r| ≤ μ_r R F_N. On a plane that is inclined by α a sphere begins to roll at
    /// tan α = μ_r.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub rolling_friction: f64,
    /// μ_t: |M_t| ≤ μ_t R F_N. A disc that is pressed evenly has 2/3 tan φ times its radius over R.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub twisting_friction: f64,
    /// k_r = k_t over k_T R², with the shear stiffness k_T of the contact: 1 of surfaces that do not
    /// slip ([IwashitaOda1998]). [Ai2011] take 2.25 μ_r² k_N/k_T.
    #[serde(default = "one")]
    #[schemars(range(min = 1e-6, max = 100.0), extend("x-unit" = "1"))]
    pub stiffness_ratio: f64,
    /// η: the dashpots' constant is 2 η √(I k) with 1/I the sum over the bodies of 1/(7/5 m r²) for
    /// rolling and 1/(2/5 m r²) for twisting. 0.3 brings a sphere to rest that has no other damping;
    /// it costs steps, and beside local damping none is needed.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub damping_ratio: f64,
}

impl Default for RollingResistance {
    /// None.
    fn default() -> Self {
        Self {
            rolling_friction: 0.0,
            twisting_friction: 0.0,
            stiffness_ratio: one(),
            damping_ratio: 0.0,
        }
    }
}

impl RollingResistance {
    /// Whether it resists anything.
    pub fn is_felt(&self) -> bool {
        self.rolling_friction > 0.0 || self.twisting_friction > 0.0
    }

    /// That of a contact between two materials.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            rolling_friction: self.rolling_friction.min(other.rolling_friction),
            twisting_friction: self.twisting_friction.min(other.twisting_friction),
            stiffness_ratio: self.stiffness_ratio.min(other.stiffness_ratio),
            damping_ratio: self.damping_ratio.max(other.damping_ratio),
        }
    }
}

impl GranularScene {
    /// Whether contacts may resist rolling or twisting.
    pub fn resists_rolling(&self) -> bool {
        let mut materials = self.materials.values();
        materials.any(|material| material.rolling().is_felt())
    }
}

fn one() -> f64 {
    1.0
}
