//! Masses in motion: the right jaw moves at a constant speed, and what breaks shakes the rest.
//!
//! The explicit road of [LiuShen2025], step S5: nodes have masses, springs pull on them, and each step of time
//! moves every node by the forces as they are (leapfrog). Nothing is brought to rest. Slow enough, the
//! force is that of equilibrium; how slow that is, is measured by the kinetic energy over that of the springs.
//!
//! `masses` gives nodes their mass and finds the step; `pull` drives. Units: µg, µm, µs, and so mN and nJ.
mod masses;
mod pull;

pub(crate) use pull::MovingPull;

use super::error::{FrameError, check};

/// How a network is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionTest {
    /// Speed of the jaw over the distance of the jaws [1/µs].
    pub strain_rate_per_us: f64,
    /// Drag on motion other than that of a sheet stretched evenly, over the critical one of its slowest vibration
    /// along the pull.
    pub damping: f64,
    /// Mass that may be added where nodes are lightest for their springs, over all mass, so that steps are longer.
    pub added_mass: f64,
    /// Points of the curve up to the largest strain: forces are means in between.
    pub points: u32,
}

/// What a moving pull tells beside its measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionReport {
    /// Step of time [µs], and how many were made.
    pub step_us: f64,
    pub steps: u64,
    /// Mass that was added over all mass.
    pub added_mass: f64,
    /// Largest kinetic energy over that of the springs, in the means between points of the curve, from a tenth of the
    /// largest force up to it.
    pub kinetic_share: f64,
}

impl MotionReport {
    /// Kinetic energy over that of the springs, up to which a pull counts as one at rest: the share that the
    /// reference asks of tests whose result does not depend on their speed.
    pub const LARGEST_KINETIC_SHARE: f64 = 0.01;
}

impl MotionTest {
    fn check(&self) -> Result<(), FrameError> {
        let (rate, damping, added) = (self.strain_rate_per_us, self.damping, self.added_mass);
        let (zero, above) = ("0 or above", "above 0");
        check(|| "strain rate [1/us]".into(), rate, rate > 0.0, above)?;
        check(|| "damping".into(), damping, damping >= 0.0, zero)?;
        check(|| "added mass".into(), added, added >= 0.0, zero)?;
        let points = f64::from(self.points);
        check(
            || "points of the curve".into(),
            points,
            points >= 1.0,
            "1 or more",
        )
    }
}
