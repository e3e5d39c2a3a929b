//! How small an automatic time step is.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// How small an automatic time step is: a preset's name or its knobs.
pub type Accuracy = accuracy::Accuracy<Knobs>;

/// The knobs of accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// An automatic time step over the critical one.
    #[schemars(range(min = 1e-6, max = 0.9), extend("x-unit" = "1"))]
    pub critical_step_fraction: f64,
}

impl Default for Knobs {
    fn default() -> Self {
        accuracy::Knobs::of(Preset::default())
    }
}

impl accuracy::Knobs for Knobs {
    const ABOUT: &'static str =
        "How small an automatic time step is: a preset's name or its knobs.";
    const EACH: Option<[&'static str; 3]> = Some([
        "0.4 of the critical step: for scenes with damping.",
        "0.2 of the critical step.",
        "0.05 of the critical step.",
    ]);

    fn of(preset: Preset) -> Self {
        let critical_step_fraction = match preset {
            Preset::Draft => 0.4,
            Preset::Standard => 0.2,
            Preset::Reference => 0.05,
        };
        Self {
            critical_step_fraction,
        }
    }
}
