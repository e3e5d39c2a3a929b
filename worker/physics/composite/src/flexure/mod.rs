//! Bending tests between rollers.
mod beam;

pub use beam::Beam;
