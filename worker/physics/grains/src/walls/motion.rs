//! Motion of walls: at a velocity, under a force, or after one.
//!
//! A [`Servo`] is a wall without mass that moves at a velocity in proportion to the force that is missing
//! (G.31). Work it out for one contact of stiffness K: F ← F + gain (F₁ − F) in each step, which ends
//! at F₁ without going beyond. To bodies it is a dashpot of K Δt/gain that ends at a force, so that it takes
//! energy from their swings. Source: servo control of walls as in [CundallStrack1979], with the gain
//! related to the stiffness at the wall so that no step goes beyond.
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
    /// What sets its velocity, if the force on it does.
    pub(crate) servo: Option<Servo>,
}

/// A plane that follows the force on it without a mass of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Servo {
    /// Axis of the plane, and 1 when bodies are above along it, −1 when below.
    pub(crate) axis: usize,
    pub(crate) facing: f64,
    /// F₁ [N], positive when it presses on the bodies.
    pub(crate) force: f64,
    pub(crate) gain: f64,
    /// [m/s].
    pub(crate) largest_velocity: f64,
    /// K of all contacts that it has or may soon have [N/m].
    pub(crate) stiffness: f64,
}

impl Servo {
    /// Force of the bodies on it [N], positive when they press.
    pub(crate) fn pressing(&self, force: &Point) -> f64 {
        -self.facing * force[self.axis]
    }

    /// Velocity along its axis [m/s] in the next step of Δt [s] after this force of the bodies on it [N]:
    /// gain (F₁ − F)/(K Δt) towards them (G.31).
    fn velocity(&self, force: &Point, time_step: f64) -> f64 {
        let missing = self.force - self.pressing(force);
        let largest = self.largest_velocity;
        let per_newton = if self.stiffness > 0.0 {
            self.gain / (self.stiffness * time_step)
        } else {
            // nothing is near: what is missing has a sign alone
            f64::MAX
        };
        self.facing * (per_newton * missing).clamp(-largest, largest)
    }
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
    /// Load or servo and the bodies' `force` [N] change the velocity (G.8), (G.9), (G.31).
    pub(crate) fn accelerate(&mut self, drive: &Drive, force: &Point) {
        if let Some(servo) = &self.servo {
            self.velocity[servo.axis] = servo.velocity(force, drive.time_step);
        }
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
        self.load.is_some()
            || self.servo.is_some()
            || self.velocity.iter().any(|part| part.abs() > 0.0)
    }
}
