//! How finely a cell is divided.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// How exactly: a preset's name or its knobs.
pub type Accuracy = accuracy::Accuracy<Knobs>;
/// The knobs of accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// Cells of the grid through the thinnest fibre.
    #[schemars(range(min = 2, max = 512), extend("x-unit" = "1"))]
    pub cells_per_fibre: u32,
}

impl Default for Knobs {
    fn default() -> Self {
        accuracy::Knobs::of(Preset::default())
    }
}

impl accuracy::Knobs for Knobs {
    fn of(preset: Preset) -> Self {
        let cells_per_fibre = match preset {
            Preset::Draft => 16,
            Preset::Standard => 48,
            Preset::Reference => 128,
        };
        Self { cells_per_fibre }
    }
}
