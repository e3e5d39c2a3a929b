//! What the end-to-end tests stand on: real `loadframe` processes, real files, plain HTTP.
//!
//! [`Server`] and [`Worker`] are processes in temporary folders, killed when dropped. [`Client`]
//! speaks REST to a server; [`Relay`] stands between a worker and its server and sees or cuts what
//! passes. [`JobFiles`] is what a job left behind, from a server or from `loadframe run`, in a form
//! that two runs can be compared by. Tests wait with [`until`] for conditions, never for seconds.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "in a test an unmet expectation should stop it there, and what it says is for people"
)]
mod client;
mod files;
mod jobs;
mod process;
mod random;
mod relay;
mod rows;
mod server;
mod turn;
mod wait;
mod worker;

pub use client::{Answer, Client};
pub use files::JobFiles;
pub use jobs::{LONG, SLOW, SMALL, Size, TINY, is_sound, losses, run_alone, with_seed};
pub use process::{Process, loadframe};
pub use random::Chance;
pub use relay::{Cut, Relay, Seen};
pub use rows::{edit_rows, rows};
pub use server::Server;
pub use wait::{PATIENCE, soak, until};
pub use worker::Worker;
