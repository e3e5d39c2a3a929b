//! What exactness costs: a spec at many settings, each against a finer one.
//!
//! [`Design`] says what is run: each knob of the kind by itself, over its values, the other knobs
//! as the spec has them, with the same seeds at every setting, so that differences between settings
//! are not hidden by the scatter between specimens. [`Study`] holds errors and times; it becomes
//! `accuracy.csv`, `accuracy.json` and `accuracy.svg`, and tables for a terminal.
//!
//! Kinds take part by naming their knobs ([`loadframe_api::study::Knob`]); nothing here knows them.
mod analysis;
mod design;
mod files;
mod plot;
mod terminal;

pub use analysis::{Error, KnobStudy, RepeatsRow, Row, Scatter, Study};
pub use design::{Design, DesignError, Request};

#[cfg(test)]
mod tests;
