//! The vocabulary of loadframe: what a job says, what its result says, and the messages between
//! clients, server and workers.
//!
//! A submission is read in this order: [`Submission::from_slice`] takes the envelope apart, finds
//! the kind in the one list of [`kinds`], holds the spec against the kind's JSON Schema (the one
//! source of types, units and limits), parses it, and asks the kind's own cross-checks. Every
//! violation is reported at once, by JSON pointer.
mod accuracy;
pub mod allocations;
mod calibration;
mod changes;
pub mod comparison;
mod digest;
mod disjoint_sets;
mod earlier;
mod envelope;
mod event;
mod examples;
pub mod fibre;
mod file_name;
pub mod filling;
mod job;
mod json;
mod kind_schemas;
pub mod kinds;
mod limits;
mod message;
mod outcome;
pub mod people;
mod plain;
mod preview;
mod problem;
mod results;
mod schema;
pub mod section;
mod signature;
pub mod spec;
mod spec_trait;
pub mod study;
mod submission_error;
pub mod surface;
pub mod table;
mod timestamp;
mod violations;
mod waiting;
mod words;
pub mod worker;

pub use accuracy::{Accuracy, Preset};
pub use calibration::{Calibration, Estimate, Sharing};
pub use changes::JobChanges;
pub use digest::sha256_hex;
pub use disjoint_sets::DisjointSets;
pub use earlier::{Earlier, EarlierJob};
pub use envelope::{Envelope, Submission};
pub use event::{Event, JobDeleted, PointsReady, ProgressNow};
pub use examples::UnknownExample;
pub use file_name::{FileNameError, PARTIAL_FOLDER, check_file_name};
pub use job::{
    AttemptEnd, AttemptView, CurveView, FieldView, JobLinks, JobOutcome, JobStatus, JobView,
    LogLine, Page, ReasonCode, SetAside, ShownValue, WorkerView,
};
pub use kind_schemas::{kind_schema, unit_of_field};
pub use kinds::{Example, JobKind, JobSpec};
pub use limits::{Excess, JobLimits, Limits, OVERRUN_FACTOR};
pub use message::{Message, messages_that_take};
pub use outcome::{
    BodyProperties, Cost, ErrorBasis, ErrorEstimate, ErrorPart, FileEntry, Outcome, OutcomeStatus,
    Provenance, QualityCheck, Quantity, Report, Tenth, Warning,
};
pub use plain::{csv_cell, printable};
pub use preview::{Extent, Preview, PreviewFile};
pub use problem::{Problem, Violation};
pub use results::{result_names, result_units};
pub use schema::{answer_schemas, body_schemas};
pub use spec_trait::{Spec, Studied};
pub use submission_error::SubmissionError;
pub use timestamp::Timestamp;
pub use violations::Violations;
pub use waiting::{NeedsView, WaitCode, WaitingView};
pub use words::words;
