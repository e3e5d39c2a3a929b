//! What is done to a bed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A force on the loading wall, downward, that swings between two values:
/// F = F₀ + (F₁ − F₀)(1 − cos 2πt/T)/2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Loading {
    /// F₀, beside the weight of a sleeper.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub smallest_force_n: f64,
    /// F₁.
    #[schemars(range(min = 1e-6, max = 1e12), extend("x-unit" = "N"))]
    pub peak_force_n: f64,
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 100_000))]
    pub cycles: u32,
    /// T; left out, it follows from the inertial number that `accuracy` asks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
}

/// Strain that a cycle is taken to have when its period is chosen, up and down.
const STRAIN: f64 = 0.05;

impl Loading {
    /// A period at which a bed follows the load without inertia [s]: at the mean pressure p of the
    /// cycle, a strain of 5 % within half of it has the inertial number I = γ̇ d √(ρ/p).
    pub(super) fn period(&self, number: f64, area: f64, diameter: f64, density: f64) -> f64 {
        let pressure = 0.5 * (self.smallest_force_n + self.peak_force_n) / area;
        let quasi_static = 2.0 * STRAIN * diameter * (density / pressure).sqrt() / number;
        self.period_s.unwrap_or(quasi_static)
    }
}

fn one() -> u32 {
    1
}
