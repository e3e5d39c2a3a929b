//! Motion: velocities by half steps, positions by whole ones.
//!
//!   a = F/m + g, a_w ← a_w (1 − λ sgn(a_w (v_w + ½ Δt a_w))) (G.8)
//!   v ← v + Δt a, x ← x + Δt v (G.9)
//!
//! for every component w, and for spins with torque and inertia in the place of force and mass.
//! The bracket of (G.8) is Cundall's local damping with the velocity in the middle of the step.
//! [`spheres`] moves particles that are bodies of their own, [`clump`] rigid clumps, which
//! [`splitting`] turns, [`wall`] walls.
//!
//! Source: T 3.27-3.31 and 3.35; Yade's `NewtonIntegrator`.
pub(crate) mod clump;
pub(crate) mod spheres;
pub(crate) mod splitting;

use crate::numbers::{Vector, rows::Row};

/// Forces [N] and torques [N m] on the particles of a patch, or on those of others in its halo. There
/// are no torques without friction; the fourth numbers mean nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wrenches {
    pub(crate) forces: Vec<Row>,
    pub(crate) torques: Vec<Row>,
}

impl Wrenches {
    /// Nothing acts on `particles`.
    pub(crate) fn clear(&mut self, particles: usize, with_torques: bool) {
        self.forces.clear();
        self.forces.resize(particles, Row::default());
        self.torques.clear();
        // without friction no torque ever acts
        if with_torques {
            self.torques.resize(particles, Row::default());
        }
    }
}

/// The largest stable step [s] of a body whose ω² [1/s²] and damping over mass D [1/s] are these: the
/// root of ω² Δt² + 4 D Δt = 4 (G.19).
pub(crate) fn critical_step(square: f64, damped: f64) -> f64 {
    if damped > 0.0 {
        2.0 / (damped + (damped * damped + square).sqrt())
    } else {
        2.0 / square.sqrt()
    }
}

/// What every body feels in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive {
    /// Δt [s].
    pub(crate) time_step: f64,
    /// g [m/s²].
    pub(crate) gravity: Vector,
    /// λ.
    pub(crate) damping: f64,
}

impl Drive {
    /// An acceleration after damping (G.8).
    #[inline(always)]
    pub(crate) fn damped(&self, acceleration: f64, velocity: f64) -> f64 {
        let middle = velocity + 0.5 * self.time_step * acceleration;
        self.against(acceleration, acceleration * middle)
    }

    /// `value` (1 − λ sgn(power)).
    #[inline(always)]
    fn against(&self, value: f64, power: f64) -> f64 {
        let kept = if power > 0.0 {
            1.0 - self.damping
        } else if power < 0.0 {
            1.0 + self.damping
        } else {
            1.0
        };
        value * kept
    }
}
