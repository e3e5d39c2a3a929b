//! Two servers measured in turns in one run, so that whatever else the machine does meets both alike.
#![allow(clippy::print_stdout, reason = "the table is what is wanted")]
use std::time::Duration;

use super::Server;

/// Rounds, after one that warms up, where `QUEUE_BENCH_ROUNDS` does not say how many.
const ROUNDS: usize = 15;

/// Rates [1/s] of so many things done in a time each.
pub(crate) fn rates<const N: usize>(done: [(u64, Duration); N]) -> [f64; N] {
    done.map(|(count, time)| count as f64 / time.as_secs_f64())
}

/// Prints what each server does in a second, the medians of the rounds, by the names of servers and of what is
/// done; gives the medians of the ratios of the second to the first.
pub(crate) fn in_turns<const N: usize>(
    servers: [(&str, &Server); 2],
    names: [&str; N],
    round: impl Fn(&Server) -> [f64; N],
) -> [f64; N] {
    // a page of 200 jobs is full from the first list on
    for (_, server) in servers {
        server.together(200, async || server.submit().await);
        round(server);
    }
    let wanted = std::env::var("QUEUE_BENCH_ROUNDS").map(|text| text.parse());
    let count = wanted.map_or(ROUNDS, |count| count.expect("a number of rounds"));
    assert!(count > 0, "there are no medians of no rounds");
    let rounds: Vec<[[f64; N]; 2]> = (0..count)
        .map(|number| {
            let mut both = [[0.0; N]; 2];
            // each goes first as often as the other
            for turn in [number % 2, 1 - number % 2] {
                both[turn] = round(servers[turn].1);
            }
            both
        })
        .collect();
    let [(first, _), (second, _)] = servers;
    println!("| | {first}, 1/s | {second}, 1/s | ratio |\n|---|---|---|---|");
    std::array::from_fn(|what| {
        let of = |server: usize| median(rounds.iter().map(|both| both[server][what]).collect());
        let ratios = rounds.iter().map(|both| both[1][what] / both[0][what]);
        let ratio = median(ratios.collect());
        println!(
            "| {} | {:.0} | {:.0} | {ratio:.3} |",
            names[what],
            of(0),
            of(1)
        );
        ratio
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
