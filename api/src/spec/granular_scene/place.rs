//! Setting a wall down on a bed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Axis;

/// Moves a wall or a body along an axis, at once, to where it just touches the bodies it meets first:
/// a plate that is set down on a bed. It takes no time and comes to rest there.
///
/// A mesh of triangles is set down as the upright box around it, which is exact for a box. A body
/// hangs where it is because its spec fixes it along the axis; from then on it is free along it. What
/// meets nothing stays where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Name of a plane, which moves along its own axis, or of facets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall: Option<String>,
    /// Number of a body. Exactly one of `wall` and `body` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<u32>,
    #[serde(default = "upright")]
    pub axis: Axis,
    /// Side that meets the bodies: −1 for its lower one along the axis, as of a plate on
    /// a bed, 1 for its upper one.
    #[serde(default = "lower")]
    #[schemars(extend("enum" = [1, -1]))]
    pub side: i8,
    /// Given, a wall rests there with its weight from then on: it has this mass, and follows
    /// gravity and what touches it along the axis in every stage that does not drive it. Stages change
    /// nothing of its speed; after one that drives it, or a `relax`, it starts at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "kg"))]
    pub mass_kg: Option<f64>,
}

fn upright() -> Axis {
    Axis::Z
}

fn lower() -> i8 {
    -1
}
