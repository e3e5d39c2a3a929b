//! Claims jobs from a server, runs them, and returns what they give.
//!
//! What it knows: a clock, folders, processes, and the server's worker routes. What it does not
//! know: mechanics (that is `loadframe-physics`) and SQL (that is the server's).
//!
//! - [`run`] carries out a spec in a folder: it records files, log and cost, keeps checkpoints and
//!   assembles `outcome.json`. Where points, files and checkpoints go beside the folder is behind
//!   [`run::Destination`], so that a run without a server takes the same road.
//! - `attempt` is that road for a lease: a heartbeat beside the solver, a courier that brings
//!   everything to the server in order, and at the end complete, fail or release.
//! - [`study`] runs a spec at many settings side by side and tells what exactness costs.
//! - [`Worker`] claims one lease after the other until it is told to stop.
mod attempt;
mod calibration;
pub mod client;
mod machine;
pub mod run;
mod scratch;
mod stop;
pub mod study;
mod worker;

pub use calibration::calibrate;
pub use machine::{available_threads, host_name};
pub use stop::{StopCause, StopSwitch};
pub use worker::{Worker, WorkerEnd, WorkerError, WorkerOptions};

/// Version of the engine, as in `provenance`.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");
/// Commit the engine was built from.
pub const ENGINE_COMMIT: &str = env!("LOADFRAME_COMMIT");
