//! Motion of walls: at a velocity, or under a force.
use loadframe_api::surface::{Point, length};
use serde::{Deserialize, Serialize};

use super::Drive;

/// How a wall moves, and how far it has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct WallMotion {
    /// From where it was at the start [m]; turning left out.
    pub(in crate::granular) displacement: Point,
    /// [m/s].
    pub(in crate::granular) velocity: Point,
    /// What drives it, if not its velocity.
    pub(in crate::granular) load: Option<Load>,
}

/// A force on a wall that is free to follow it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct Load {
    /// [N].
    pub(in crate::granular) force: Point,
    /// [kg].
    pub(in crate::granular) mass: f64,
    /// Axes along which it moves.
    pub(in crate::granular) free: [bool; 3],
}

impl WallMotion {
    /// The load and the bodies' `force` [N] change the velocity (G.8), (G.9).
    pub(in crate::granular) fn accelerate(&mut self, drive: &Drive, force: &Point) {
        let Some(load) = self.load else { return };
        for (axis, velocity) in self.velocity.iter_mut().enumerate() {
            if load.free[axis] {
                let acceleration = (load.force[axis] + force[axis]) / load.mass;
                *velocity += drive.time_step * drive.damped(acceleration, *velocity);
            }
        }
    }

    /// Moves on by a step [s].
    pub(in crate::granular) fn advance(&mut self, time_step: f64) {
        for axis in 0..3 {
            self.displacement[axis] += time_step * self.velocity[axis];
        }
    }

    /// [m/s].
    pub(in crate::granular) fn speed(&self) -> f64 {
        length(&self.velocity)
    }

    /// Whether it moves or may move.
    pub(in crate::granular) fn is_moving(&self) -> bool {
        self.load.is_some() || self.velocity.iter().any(|part| part.abs() > 0.0)
    }
}
