//! Claims jobs from a server, runs them, and returns what they give.
//!
//! What it knows: the server's worker routes and when a lease is kept, lost or given back. What it
//! does not know: mechanics (that is `loadframe-physics`), how a spec is run in a folder (that is
//! `loadframe-run`) and SQL (that is the server's).
//!
//! - [`Worker`] claims one lease after the other until it is told to stop, or its time is over.
//! - [`Allocation`] is the batch system's job that it lives in, and the time that is left of it.
//! - `attempt` carries out a lease: a heartbeat beside the solver, an uploader that sends everything
//!   to the server in order, and at the end complete, fail or release.
mod allocation;
mod attempt;
mod scratch;
mod worker;

pub use allocation::{Allocation, duration};
pub use worker::{Worker, WorkerEnd, WorkerError, WorkerOptions};
