//! Arithmetic that gives the same bits on every machine and on any number of threads.
//!
//! [`Team`] shares passes over arrays among threads and sums in a fixed order; [`wide`] runs a kernel
//! in the widest vector instructions that the machine has.
mod parallel;
mod wide;

pub use parallel::{Team, ThreadsError};
pub use wide::wide;
