//! Stages that put bodies in and take them out.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Axis, Generate};

/// Puts bodies in while the others move: in batches, each of as many as find room in the region of
/// `bodies` at that time, until all are in. The stage ends one `every_s` after the last batch, or
/// after `steps` or `time_s` at the latest, exactly one of the two.
///
/// What is put in has its numbers from the start, after those of all other bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Insert {
    pub bodies: Generate,
    /// Time between batches.
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub every_s: f64,
    /// Grains in a batch, at most; left out, as many as find room.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10_000_000))]
    pub batch: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

/// Takes out bodies whose centre of mass is beyond a height, at once. Bonded spheres go or stay
/// together; what is fixed along the axis, or is driven or set down by a stage, stays. Others keep their
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cut {
    pub axis: Axis,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "m"))]
    pub above_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "m"))]
    pub below_m: Option<f64>,
}

impl Cut {
    /// Whether a body with its centre of mass here [m] is taken out.
    pub fn takes(&self, centre: &[f64; 3]) -> bool {
        let height = centre[self.axis.index()];
        self.above_m.is_some_and(|above| height > above)
            || self.below_m.is_some_and(|below| height < below)
    }
}
