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
pub(super) mod clump;
pub(super) mod spheres;
pub(super) mod splitting;
pub(super) mod wall;

use super::Vector;

/// What every body feels in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive {
    /// Δt [s].
    pub(super) time_step: f64,
    /// g [m/s²].
    pub(super) gravity: Vector,
    /// λ.
    pub(super) damping: f64,
}

impl Drive {
    /// An acceleration after damping (G.8).
    #[inline(always)]
    pub(super) fn damped(&self, acceleration: f64, velocity: f64) -> f64 {
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
