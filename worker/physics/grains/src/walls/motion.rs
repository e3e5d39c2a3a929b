//! Motion of walls: at a velocity, or under a force.
use loadframe_api::surface::{Point, length};
use serde::{Deserialize, Serialize};

use crate::motion::Drive;

/// How a wall moves, and how far it has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct WallMotion {
    /// From where it was at the start [m]; turning left out.
    pub(crate) displacement: Point,
    /// [m/s].
    pub(crate) velocity: Point,
    /// What drives it, if not its velocity.
    pub(crate) load: Option<Load>,
}

/// A force on a wall that is free to follow it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Load {
    /// [N].
    pub(crate) force: Point,
    /// [kg].
    pub(crate) mass: f64,
    /// Axes along which it moves.
    pub(crate) free: [bool; 3],
}

impl WallMotion {
    /// The load and the bodies' `force` [N] change the velocity (G.8), (G.9).
    pub(crate) fn accelerate(&mut self, drive: &Drive, force: &Point) {
        let Some(load) = self.load else { return };
        for (axis, velocity) in self.velocity.iter_mut().enumerate() {
            if load.free[axis] {
                let acceleration = (load.force[axis] + force[axis]) / load.mass;
                *velocity += drive.time_step * drive.damped(acceleration, *velocity);
            }
        }
    }

    /// Moves on by a step [s].
    pub(crate) fn advance(&mut self, time_step: f64) {
        for axis in 0..3 {
            self.displacement[axis] += time_step * self.velocity[axis];
        }
    }

    /// [m/s].
    pub(crate) fn speed(&self) -> f64 {
        length(&self.velocity)
    }

    /// Whether it moves or may move.
    pub(crate) fn is_moving(&self) -> bool {
        self.load.is_some() || self.velocity.iter().any(|part| part.abs() > 0.0)
    }
}
