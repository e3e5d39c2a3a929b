//! What every store must hold, whatever lies beneath it: the rules of the queue, seen from outside.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
mod arriving;
mod backlog;
mod calls;
mod claims;
mod curves;
#[path = "../shared/database.rs"]
mod database;
mod endings;
mod events;
mod faults;
mod files;
mod full_disk;
mod lab;
mod long_queue;
mod losses;
mod matched;
#[path = "../shared/outcome.rs"]
mod outcome;
mod recovery;
mod requests;
mod safety;
mod shared;
mod submissions;
mod sweeping;
mod texts;
mod tokens;
mod values;
