//! The service as its users meet it: by shell, by curl, by event stream.
#![allow(clippy::unwrap_used, reason = "tests stop at what is unexpected")]
mod access;
mod autoscale;
mod events;
mod results;
mod shell;
