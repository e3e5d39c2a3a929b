//! What is given up for speed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// A preset's name or its knobs. `loadframe study accuracy` measures what each knob costs and how far
/// off it is on your own spec.
pub type Accuracy = accuracy::Accuracy<Knobs>;
/// The knobs of accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// Time step over the critical one.
    #[schemars(range(min = 1e-6, max = 0.9), extend("x-unit" = "1"))]
    pub critical_step_fraction: f64,
    /// Moduli of all materials during the test, over those that are given.
    #[schemars(range(min = 1e-9, max = 1.0), extend("x-unit" = "1"))]
    pub stiffness: f64,
    /// The aggregate's modulus while the bed is prepared, if that of the test is higher; walls and
    /// cement are softened with it. All grow to those of the test before it is loaded.
    #[schemars(range(min = 1e3, max = 1e15), extend("x-unit" = "Pa"))]
    pub preparation_modulus_pa: f64,
    /// I that sets the period of a cycle where none is given.
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub inertial_number: f64,
}

impl Default for Knobs {
    fn default() -> Self {
        accuracy::Knobs::of(Preset::default())
    }
}

impl accuracy::Knobs for Knobs {
    const ABOUT: &'static str = "A preset's name or its knobs. `loadframe study accuracy` measures what each knob costs and how far\noff it is on your own spec.";

    fn of(preset: Preset) -> Self {
        let (critical_step_fraction, preparation_modulus_pa, inertial_number) = match preset {
            Preset::Draft => (0.4, 1e8, 2e-3),
            Preset::Standard => (0.4, 1e9, 5e-4),
            Preset::Reference => (0.2, 1e15, 1e-4),
        };
        Self {
            critical_step_fraction,
            stiffness: 1.0,
            preparation_modulus_pa,
            inertial_number,
        }
    }
}
