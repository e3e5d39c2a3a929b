//! What can be chosen of a motion.
use crate::lattice::Geometry;

/// How bonds act within a time step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// As forces of springs.
    Verlet,
    /// The paper's: as shifts of both particles, `iterations` times.
    Pbd { iterations: u32 },
    /// As shifts with a memory of the force they stand for.
    Xpbd { iterations: u32 },
}

/// What takes energy out of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// Nothing: true dynamics.
    None,
    /// A force -c m v on every particle [1/s].
    Viscous { per_s: f64 },
    /// All particles stop whenever the kinetic energy has passed a peak: the way to rest of shifts, whose own
    /// damping nothing foresees.
    Kinetic,
    /// As much of a viscous force as lets the slowest motion that the load excites just not swing: the way to
    /// rest of springs. Kinetic where no such motion is found.
    Critical,
}

/// How a lattice is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionOptions {
    pub scheme: Scheme,
    pub geometry: Geometry,
    /// τ [s]; `None` takes 0.9 of the stable step of springs (three times that for XPBD, which is
    /// stable at any).
    pub time_step_s: Option<f64>,
    pub damping: Damping,
}
