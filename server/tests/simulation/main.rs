//! A server, its workers, its users, the network between them and the clock, simulated: one thread, one
//! stream of random numbers, minutes of their time in a moment of ours.
//!
//! The store is the real one on a real database. What the world does to it is in [`world`], by a seed:
//! messages are late by up to 30 s, lost, doubled and overtake each other; workers die, freeze and are
//! cut off; the server is killed before or after what it was asked, freezes, and its clock leaps by hours.
//! [`worker`]s and [`people`] do as the real ones do, and send again what was not answered. What must hold
//! at every moment, and once the world is whole again, is in [`history`]:
//!
//! 1. what was accepted comes to its end;
//! 2. a job is in the hands of one worker;
//! 3. numbers of attempts grow by one;
//! 4. what has ended stays as it ended, unless a person retries it;
//! 5. a result is published whole, once, by who held the lease;
//! 6. events tell everything, in order.
//!
//! `LOADFRAME_SEEDS=10000 cargo test --release -p loadframe-server --test simulation -- --nocapture` tries so many
//! seeds (`LOADFRAME_FIRST_SEED` is the first); a failure names its seed, and `LOADFRAME_TRACE=1` with that seed
//! prints what happened.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stderr, reason = "seeds, and what happened under them")]
#[path = "../shared/database.rs"]
mod database;
mod happening;
mod history;
mod network;
mod people;
mod schema;
mod server;
mod words;
mod worker;
mod world;

use std::sync::atomic::{AtomicU64, Ordering};

use world::World;

/// Seeds where nobody asks for more.
const SEEDS: u64 = 24;

fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().expect("a number of seeds"))
}

/// What happened under a seed.
fn happened(seed: u64) -> Vec<String> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(async {
        let mut world = World::new(seed).await;
        world.run().await;
        world.end().await
    })
}

#[test]
fn six_invariants_hold_whatever_network_machines_and_clocks_do() {
    let (first, count) = (
        number("LOADFRAME_FIRST_SEED").unwrap_or(0),
        number("LOADFRAME_SEEDS").unwrap_or(SEEDS),
    );
    let next = AtomicU64::new(first);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let begun = std::time::Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count {
                        break;
                    }
                    let trace = happened(seed);
                    if std::env::var_os("LOADFRAME_TRACE").is_some() {
                        eprintln!("{}", trace.join("\n"));
                    }
                    if (seed - first + 1).is_multiple_of(500) {
                        eprintln!("{} seeds in {:.0?}", seed - first + 1, begun.elapsed());
                    }
                }
            });
        }
    });
}

#[test]
fn a_seed_tells_everything() {
    for seed in [3, 8] {
        let (once, again) = (happened(seed), happened(seed));
        let different = once.iter().zip(&again).position(|(a, b)| a != b);
        assert_eq!(
            different,
            None,
            "{:?}",
            different.map(|at| (&once[at], &again[at]))
        );
        assert_eq!(once.len(), again.len());
    }
}
