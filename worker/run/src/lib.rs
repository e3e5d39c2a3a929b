//! A run of one spec in a folder.
//!
//! [`execute`] calls the simulation with a `Recording`, which writes result files (hashed while
//! written), keeps the log, measures cost and time to go, and hands everything on to a
//! [`Destination`]. A checkpoint is a [`SavedRun`]: the simulation's own bytes with what the
//! recording needs to go on. At the end `outcome.json` is assembled. [`run_to_directory`] is the
//! whole of it for a folder somebody keeps; `attempt` is for a lease.
mod cost;
mod directory;
mod eta;
mod execute;
mod outcome;
mod recording;
mod result_files;
mod saved_run;

pub(crate) use cost::Spent;
pub use directory::{DirectoryEnd, DirectoryError, DirectoryOptions, News, run_to_directory};
pub(crate) use eta::TimeToGo;
pub use execute::{Ended, Plan, RunError, execute};
pub use recording::{Destination, Progress};
pub use result_files::sha256_of_file;
pub use saved_run::{SavedRun, SavedRunError};
