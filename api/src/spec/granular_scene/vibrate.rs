//! Shaking a scene.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Axis;

/// Shakes the scene as if everything in it, walls too, stood on a vibrating table: gravity and the
/// sine acceleration A sin 2πft, along one axis at a time, for `steps` or for `time_s`, exactly one
/// of the two. Places are told as seen from the table: walls stay where they are, but for plates that were
/// set down with a mass, which are shaken along the axis that they are free to follow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Vibrate {
    /// A.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "m/s2"))]
    pub acceleration_m_per_s2: f64,
    /// f.
    #[schemars(range(min = 1e-6, max = 1e9), extend("x-unit" = "Hz"))]
    pub frequency_hz: f64,
    /// Axes that take turns.
    #[serde(default = "across")]
    #[schemars(length(min = 1, max = 100))]
    pub axes: Vec<Axis>,
    /// Periods along an axis before the next one takes its turn.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub periods_per_axis: u32,
    /// What tan φ of every contact is multiplied with during the stage.
    #[serde(default = "unchanged")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub friction_factor: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

impl Vibrate {
    /// Acceleration at `time` [s] of the stage, beside gravity [m/s²].
    pub fn acceleration_at(&self, time: f64) -> [f64; 3] {
        let periods = time * self.frequency_hz;
        let turn = (periods / f64::from(self.periods_per_axis)).floor() as usize;
        let mut acceleration = [0.0; 3];
        if let Some(axis) = self.axes.get(turn % self.axes.len().max(1)) {
            let phase = std::f64::consts::TAU * periods.fract();
            acceleration[axis.index()] = self.acceleration_m_per_s2 * phase.sin();
        }
        acceleration
    }
}

/// x and y: what a bed under gravity along z is compacted by.
fn across() -> Vec<Axis> {
    vec![Axis::X, Axis::Y]
}

fn one() -> u32 {
    1
}

fn unchanged() -> f64 {
    1.0
}
