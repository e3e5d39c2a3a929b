//! What is given up for speed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// A preset's name or its knobs.
pub type Accuracy = accuracy::Accuracy<Knobs>;

/// The knobs of accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// Time step over the critical one.
    #[schemars(range(min = 1e-6, max = 0.9), extend("x-unit" = "1"))]
    pub critical_step_fraction: f64,
    /// I = γ̇ d √(ρ/σ) at which the specimen is sheared where the test gives no rate.
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
        let (critical_step_fraction, inertial_number) = match preset {
            Preset::Draft => (0.4, 1e-3),
            Preset::Standard => (0.3, 3e-4),
            Preset::Reference => (0.2, 1e-4),
        };
        Self {
            critical_step_fraction,
            inertial_number,
        }
    }
}
