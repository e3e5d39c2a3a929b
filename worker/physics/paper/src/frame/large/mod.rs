//! Large displacements and rotations, co-rotationally.
//!
//! The springs of an element stay as they are; what changes is how their deformations follow from the
//! nodes: from the chord between them and the triads that turn with them (`measure`, `response`). Equilibrium is
//! Newton's (`newton`), and `pull` looks for breaks step by step, because nothing is linear here.
mod measure;
mod newton;
mod pull;
mod response;
mod shape;

pub use pull::{LargePull, LargePullTest, LargeStep};
