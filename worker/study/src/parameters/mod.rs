//! What parameters do to the results of a job: the cases of a study file side by side.
//!
//! [`Design`] makes a setting of each case, all with the same seeds. [`Study`] holds every test,
//! the statistics of each case, and what can be said of each result from the numbers alone; it
//! becomes `parameters.csv`, `parameters.json`, `parameters.md` and `parameters.svg`, and tables for
//! a terminal.
//!
//! Any kind takes part; a study file names values by JSON pointer
//! ([`loadframe_api::study::ParameterStudy`]).
mod analysis;
mod case;
mod design;
mod files;
mod finding;
mod labels;
mod markdown;
mod plot;
mod terminal;

pub use analysis::Study;
pub use case::{CaseResult, CaseRow, Test};
pub use design::Design;
pub use finding::{Finding, Step, Trend};

#[cfg(test)]
mod tests;
