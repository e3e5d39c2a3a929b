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
    /// T; left out with `frequency_hz`, it follows from the inertial number that `accuracy` asks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
    /// 1/T, instead of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "Hz"))]
    pub frequency_hz: Option<f64>,
}

/// Strain of grains that find their place, as it is taken for the choice of a period.
const STRAIN: f64 = 0.05;
/// Modulus of a bed over that of its contacts, for the same purpose: oedometers of spheres have 0.2 to
/// 0.3.
const BED_MODULUS: f64 = 0.2;
/// Strain that is not taken to be exceeded.
const LARGEST_STRAIN: f64 = 0.5;

/// What a period follows from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// I.
    pub(super) inertial_number: f64,
    /// Of the loading wall [m²].
    pub(super) area: f64,
    /// Of a mean grain [m].
    pub(super) diameter: f64,
    /// Of grains [kg/m³].
    pub(super) density: f64,
    /// Of contacts between grains during the test [Pa].
    pub(super) modulus: f64,
}

impl Loading {
    /// A period at which a bed follows the load without inertia [s]: with the mean pressure p of the
    /// cycle, the strain that grains need to find their place and to be pressed within half of it has
    /// the inertial number I = γ̇ d √(ρ/p).
    pub(super) fn period(&self, pace: &Pace) -> f64 {
        let pressure = |force: f64| force / pace.area;
        let mean = pressure(0.5 * (self.smallest_force_n + self.peak_force_n));
        let pressed = pressure(self.peak_force_n) / (BED_MODULUS * pace.modulus);
        let strain = (STRAIN + pressed).min(LARGEST_STRAIN);
        let time = 2.0 * strain * pace.diameter * (pace.density / mean).sqrt();
        let given = self.period_s.or(self.frequency_hz.map(f64::recip));
        given.unwrap_or(time / pace.inertial_number)
    }

    /// Whether the period is given.
    pub(super) fn has_period(&self) -> bool {
        self.period_s.is_some() || self.frequency_hz.is_some()
    }
}

fn one() -> u32 {
    1
}
