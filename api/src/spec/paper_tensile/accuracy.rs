//! How finely the test is divided.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// How exactly: a preset's name or its knobs.
pub type Accuracy = accuracy::Accuracy<Knobs>;
/// The knobs of accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// Of a single fibre: equal steps to the largest strain, each a point of the curve. Every step is brought to rest, so
    /// that they do not add up to an error of their own.
    #[schemars(range(min = 1, max = 10_000), extend("x-unit" = "1"))]
    pub load_steps: u32,
    /// Of a sheet that is made: length of the straight parts of fibres over the width of the narrowest,
    /// where `model.segment_um` is left out.
    #[schemars(range(min = 0.1, max = 100.0), extend("x-unit" = "1"))]
    pub segment_widths: f64,
    /// Of sheets: where bonds hold their fibres.
    pub bonds_at: BondsAt,
    /// Of sheets: once the failure index of a part is over 1 by this, parts break together that are over 1, or
    /// short of it by at most a quarter of this, but for those that have a part on one of their fibres whose
    /// index is larger by more than this share; 0: one by one, at 1. The failure index is the load over what
    /// breaks the part.
    #[schemars(range(min = 0.0, max = 0.5), extend("x-unit" = "1"))]
    pub break_precision: f64,
}

/// Where bonds hold their fibres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BondsAt {
    /// At nodes of their own: what they do to fibres is exact.
    #[default]
    Nodes,
    /// Where they are inside the straight parts of fibres, whose ends alone are nodes: for large sheets.
    Inside,
}

impl BondsAt {
    /// Name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nodes => "nodes",
            Self::Inside => "inside",
        }
    }
}

impl Default for Knobs {
    fn default() -> Self {
        accuracy::Knobs::of(Preset::default())
    }
}

impl accuracy::Knobs for Knobs {
    const PRESETS: &'static str = "Named choices: 20, 50 and 200 steps of a single fibre; straight parts of 4, 1 and half a width in a\nsheet that is made.";

    fn of(preset: Preset) -> Self {
        let (load_steps, segment_widths) = match preset {
            Preset::Draft => (20, 4.0),
            Preset::Standard => (50, 1.0),
            Preset::Reference => (200, 0.5),
        };
        Self {
            load_steps,
            segment_widths,
            bonds_at: BondsAt::Nodes,
            break_precision: 0.0,
        }
    }
}
