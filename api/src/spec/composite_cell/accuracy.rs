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

/// Cells of the grid along the longer side, in all, that `standard` takes at most.
const STANDARD_SIDE: f64 = 768.0;
/// What `standard` keeps through the thinnest fibre even so.
const STANDARD_LEAST: u32 = 16;

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

/// The knobs for a cell whose longer side is so many times its thinnest fibre. `standard` chooses by
/// cost: a dilute cell would take minutes with as many grid cells through its fibre as a dense one.
pub(super) fn knobs_for(accuracy: &Accuracy, fibres_along: f64) -> Knobs {
    let knobs = accuracy.knobs();
    if !matches!(accuracy, Accuracy::Preset(Preset::Standard)) {
        return knobs;
    }
    let affordable = (STANDARD_SIDE / fibres_along).floor();
    let affordable = (affordable as u32).max(STANDARD_LEAST);
    Knobs {
        cells_per_fibre: knobs.cells_per_fibre.min(affordable),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_puts_fewer_cells_through_fibres_that_are_far_apart_and_others_never() {
        let chosen = |preset, along| knobs_for(&Accuracy::Preset(preset), along).cells_per_fibre;
        // 768 / 16 = 48
        assert_eq!(chosen(Preset::Standard, 16.0), 48);
        assert_eq!(chosen(Preset::Standard, 32.0), 24);
        assert_eq!(chosen(Preset::Standard, 1000.0), 16);
        assert_eq!(chosen(Preset::Draft, 1000.0), 16);
        assert_eq!(chosen(Preset::Reference, 1000.0), 128);
        let given = Accuracy::Knobs(Knobs {
            cells_per_fibre: 48,
        });
        assert_eq!(knobs_for(&given, 1000.0).cells_per_fibre, 48);
    }
}
