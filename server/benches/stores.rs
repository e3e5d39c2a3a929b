//! The queue on SQLite and on PostgreSQL, in turns: submit, claim, heartbeat, completion, list.
//!
//! `tests/postgres bench` starts a PostgreSQL for it; another one is measured where `LOADFRAME_TEST_POSTGRES` names
//! it. Both are as durable as they are in use: a commit is on the disk before it is answered.
#![allow(clippy::print_stdout, reason = "the table is what this bench is for")]
#[path = "../tests/shared/database.rs"]
mod database;
mod lab;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use lab::Server;
use lab::turns::{in_turns, rates};
use loadframe_api::worker::Lease;

/// What is done in a round: jobs by one client and by 16, heartbeats, lists.
const ONE_BY_ONE: u64 = 24;
const JOBS: u64 = 160;
const HEARTBEATS: u64 = 480;
const LISTS: u64 = 48;

fn round(server: &Server) -> [f64; 7] {
    let leases = Mutex::new(Vec::<Lease>::new());
    let claim = async || {
        let lease = server.claim(0.0).await.expect("a job");
        leases
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(lease);
    };
    let alone = server.runtime.block_on(async {
        let begin = std::time::Instant::now();
        for _ in 0..ONE_BY_ONE {
            server.submit().await;
        }
        begin.elapsed()
    });
    let submit = server.together(JOBS, async || server.submit().await);
    let list = server.together(LISTS, async || server.list().await);
    let claim = server.together(JOBS, claim);
    let leases = leases.into_inner().unwrap_or_else(PoisonError::into_inner);
    // one after the other, by whoever is next
    let next = AtomicUsize::new(0);
    let each = || &leases[next.fetch_add(1, Ordering::Relaxed) % leases.len()];
    let heartbeat = server.together(HEARTBEATS, async || server.heartbeat(each()).await);
    next.store(0, Ordering::Relaxed);
    let finish = server.together(JOBS, async || server.finish(each()).await);
    let cycle = server.together(ONE_BY_ONE, async || server.cycle().await);
    rates([
        (ONE_BY_ONE, alone),
        (JOBS, submit),
        (LISTS, list),
        (JOBS, claim),
        (HEARTBEATS, heartbeat),
        (JOBS, finish),
        (ONE_BY_ONE, cycle),
    ])
}

fn main() {
    // where no database is named, all of them are in folders
    if database::address(Path::new("")).is_none() {
        println!("the queue on PostgreSQL is measured by tests/postgres bench");
        return;
    }
    let (sqlite, postgres) = (Server::start(), Server::on(database::place));
    in_turns(
        [("SQLite", &sqlite), ("PostgreSQL", &postgres)],
        [
            "submit, one client",
            "submit, 16 clients",
            "list of 200",
            "claim",
            "heartbeat",
            "upload, complete",
            "claim, upload, complete",
        ],
        round,
    );
}
