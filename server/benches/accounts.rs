//! What accounts cost: submit, claim to completion, and list, on a server of one person and on one with
//! accounts, in turns.
//!
//! Held (issue "share in a group"): with accounts the queue keeps 90 % of what it does without. The median
//! of the rounds' ratios is what is compared; it ends with 1 where that is less.
#![allow(clippy::print_stdout, reason = "the table is what this bench is for")]
mod lab;

use std::process::ExitCode;

use lab::Server;
use lab::turns::{in_turns, rates};

/// Jobs and lists of a round.
const JOBS: u64 = 160;
const LISTS: u64 = 48;
/// What must be kept.
const KEPT: f64 = 0.9;

fn main() -> ExitCode {
    let (without, with) = (Server::start(), Server::with_accounts());
    let ratios = in_turns(
        [("without accounts", &without), ("with accounts", &with)],
        ["submit", "list of 200", "claim, upload, complete"],
        |server| {
            rates([
                (JOBS, server.together(JOBS, async || server.submit().await)),
                (LISTS, server.together(LISTS, async || server.list().await)),
                (JOBS, server.together(JOBS, async || server.cycle().await)),
            ])
        },
    );
    if ratios.iter().all(|ratio| *ratio >= KEPT) {
        ExitCode::SUCCESS
    } else {
        println!("less than {KEPT} of what it does without accounts");
        ExitCode::FAILURE
    }
}
