//! Arithmetic that gives the same bits on every machine and on any number of threads.
//!
//! [`Team`] shares passes over arrays among threads and sums in a fixed order; [`wide`] runs a kernel
//! in the widest vector instructions that the machine has. [`next_look`] finds where the first of many
//! quantities passes a limit; [`Softening`] solves equations whose matrix lost parts since it was factored,
//! as [`SparseCholesky`] factors it. [`equilibrium`] goes to where forces balance.
mod cholesky;
mod crossing;
pub mod equilibrium;
mod parallel;
mod softening;
mod wide;

pub use cholesky::{NoFactor, SparseCholesky};
pub use crossing::{Crossing, next_look};
pub use parallel::{Team, ThreadsError};
pub use softening::{Singular, Softening};
pub use wide::wide;
