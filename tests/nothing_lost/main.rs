//! Nothing is lost and nothing happens twice, whatever dies: real servers and workers, killed,
//! stopped and cut off at random moments.
//!
//! `LOADFRAME_SEED` repeats the moments of a run as far as the machine allows; `LOADFRAME_SOAK`
//! (minutes) lets each of the random tests go on for so long.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "tests stop at what is unexpected and speak to people"
)]
mod away_server;
mod cancelled;
mod exclusive;
mod faulty_machines;
mod killed_server;
mod killed_workers;
mod overrun;
mod paced;
mod planned_stops;
mod stale_leases;
mod stopped_workers;
