//! Rollers pressed against faces: rigid, without friction.
//!
//! In small displacements a roller that has advanced by a into the section stands in the way of every
//! particle of its face: the particle's displacement w along the inward normal and the force p on it obey
//!
//! w ≥ a - g,  p ≥ 0,  p (w - a + g) = 0,  g = R - √(R² - d²)   (8)
//!
//! with the distance d of the particle from the roller's place along the face, both in the
//! undeformed section. The circle is exact; (8) itself is of first order, as all small displacements
//! are: it leaves out the turn of the normal and the way a particle travels along the face.
//! [`Rolling`] has both: there (9) of [`circles`](crate::solve::circles) holds instead.
//!
//! From the bottom up: [`roller`] is what presses, [`reach`] what it could touch, [`trial`] and [`condensed`]
//! find what it does touch, which [`settled`] gives to the equations of equilibrium as supports, to check (8)
//! against what comes back; [`rolling`] follows rollers in large displacements.
mod condensed;
mod reach;
mod roller;
mod rolling;
mod settled;
mod trial;

pub(crate) use reach::{Point, points};
pub use roller::{ContactEquilibrium, PressedRoller, Roller, RollerContact};
pub use rolling::{Rolling, RollingState};
pub use settled::{contact_equilibrium, pressed_equilibrium};
