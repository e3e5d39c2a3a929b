//! Studies: many tests of one job, for what they say together.
//!
//! - [`accuracy`]: what exactness costs. Each knob of the kind by itself, against its finest value.
//! - [`parameters`]: what a file's cases do to the results.
//!
//! Either is a [`Design`]: [`Settings`], equal ones once, each to be tested with the same seeds, and
//! what is to be made of the finished tests. [`run`] carries it out side by side and keeps finished
//! and unfinished tests in the folder for when it is interrupted; the [`Findings`] that come back
//! write tables, plot and text. Nothing here knows the kinds, nor any server.
pub mod accuracy;
pub mod parameters;

mod design;
mod progress;
mod run;
mod runs_file;
mod settings;
mod svg;
mod test_checkpoint;
mod text;

pub use design::{Design, Findings};
pub use run::{StudyEnd, StudyError, StudyOptions, run};
pub use runs_file::Finished;
pub use settings::Settings;
