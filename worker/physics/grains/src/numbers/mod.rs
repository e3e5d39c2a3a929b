//! Vectors in space, and numbers side by side: the arithmetic of everything else.
//!
//! [`lanes`] are numbers of several contacts at once, [`rows`] what contacts read of particles and add
//! to them, [`ahead`] asks for memory before it is needed. Nothing here knows what the numbers mean.
pub(crate) mod ahead;
pub(crate) mod lanes;
pub(crate) mod rows;

/// A point or vector in space, SI.
pub(crate) type Vector = nalgebra::Vector3<f64>;
