//! A run of one spec in a folder.
//!
//! What it knows: a clock, folders, this machine and this process. What it does not know: mechanics
//! (that is `loadframe-physics`), the network, and what becomes of a result.
//!
//! [`execute`] calls the simulation with a `Recording`, which writes result files (hashed while
//! written), keeps the log, measures cost and time to go, and hands everything on to a
//! [`Destination`]. A checkpoint is a [`SavedRun`]: the simulation's own bytes with what the
//! recording needs to go on. At the end `outcome.json` is assembled. [`run_to_directory`] is the
//! whole of it for a folder somebody keeps; a worker's destination is its server.
//!
//! A [`StopSwitch`] ends a run early. [`Engine`] is the build that computes, as whoever composes
//! the executable names it. [`preview`] draws a specimen without its test. [`calibrate`] and [`free_memory_mb`] measure the machine.
mod calibration;
mod cost;
mod directory;
mod engine;
mod eta;
mod execute;
mod machine;
mod outcome;
mod plan;
mod preview;
mod recording;
mod result_files;
mod results_table;
mod saved_run;
mod spool;
mod stop;

pub use calibration::calibrate;
pub use cost::Spent;
pub use directory::{DirectoryEnd, DirectoryError, DirectoryOptions, RunUpdate, run_to_directory};
pub use engine::Engine;
pub use eta::TimeToGo;
pub use execute::{Ended, RunError, execute};
/// What a preview may be told, and end with.
pub use loadframe_physics::{Halt, Interrupt, InterruptSource, Uninterrupted};
pub use machine::{
    available_threads, free_disk_mb, free_memory_mb, host_name, resident_memory_mb,
    thread_processor_time_s,
};
pub use outcome::{Circumstances, OUTCOME_FILE, assemble};
pub use plan::Plan;
pub use preview::preview;
pub use recording::{Destination, Progress};
pub use result_files::sha256_of_file;
pub use saved_run::{SavedRun, SavedRunError};
pub use stop::{StopCause, StopSwitch};

// what was not looked at must not be called fine
const _: () = assert!(
    loadframe_physics::WATCHES,
    "the feature `unwatched` is for the benchmark `granular` alone: `quality` means nothing with it, so no job runs with it"
);
