//! What exactness costs: a spec at many settings, each against a finer one.
//!
//! [`Design`] says what is run: each knob of the kind by itself, over its values, the other knobs
//! as the spec has them. [`run`] carries it out side by side, the same seeds at every setting, so
//! that differences between settings are not hidden by the scatter between specimens, and keeps
//! finished tests in the folder for when it is interrupted. [`Study`] holds errors and times, and
//! [`write()`] turns it into `accuracy.csv`, `accuracy.json` and `accuracy.svg`, [`words()`]
//! into tables for a terminal.
//!
//! Kinds take part by naming their knobs ([`loadframe_api::study::Knob`]); nothing here knows them.
mod analysis;
mod design;
mod files;
mod plot;
mod run;
mod runs_file;
mod words;

pub use analysis::{Error, KnobStudy, RepeatsRow, Row, Scatter, Study};
pub use design::{Design, DesignError, Request};
pub use files::{CSV_FILE, JSON_FILE, SVG_FILE, write};
pub use run::{StudyEnd, StudyError, StudyOptions, run};
pub use words::words;

#[cfg(test)]
mod tests;
