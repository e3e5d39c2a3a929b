//! Spheres: what they fill, alone and together, and which are near each other.
//!
//! [`union`] tells what overlapping spheres weigh as one body, [`solid_share`] the part of a sphere in
//! a box, [`neighbours`] which spheres may touch before the next search. Below: [`numbers`](crate::numbers).
pub(crate) mod neighbours;
pub(crate) mod solid_share;
pub(crate) mod sphere;
pub(crate) mod union;
