//! Studies: many runs of one job, for what they say together.
//!
//! A study of accuracy varies [`Knob`]s, which a kind names beside its spec
//! ([`crate::spec_trait::Studied::knobs`]). A study of parameters is a file, a [`ParameterStudy`], whose
//! cases set any values of the job's spec; it needs nothing of the kind but the spec itself.
mod apply;
mod cases;
mod knob;
mod parameters;

pub use cases::Case;
pub use knob::{Knob, TurnError};
pub use parameters::{ParameterStudy, WrittenCase};

#[cfg(test)]
mod tests;
