//! Measures how far results are off for how they are computed, and checks what the engine says of it.
//!
//!   cargo run --release -p loadframe-physics --example stated_errors -- measure KIND SPECS [THREADS]
//!   cargo run --release -p loadframe-physics --example stated_errors -- check KIND SPECS [THREADS]
//!
//! `measure` draws jobs of a kind and prints the table that is shipped beside the engine; `check` draws
//! others, at the presets, and prints for how many of them the finest run of the same job lies within two
//! of the errors that their results state. It fails where that is less than nine of ten.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a command")]
mod fabrics;
mod kept;
mod measure;
mod run;
mod scenes;
mod sort;

use std::process::ExitCode;

use fabrics::{LARGE, SMALL};
use measure::{for_each, table};
use scenes::Scenes;
use sort::Sort;

/// Seeds of the jobs that are measured, and of those that are checked.
const MEASURED_FROM: u64 = 1;
const CHECKED_FROM: u64 = 100_001;
/// Part of the jobs that twice an error is to hold for, at least.
const PROMISE: f64 = 0.9;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let number = |index: usize| -> Option<u64> { words.get(index)?.parse().ok() };
    let sort = words.get(1).and_then(|kind| sort_of(kind));
    let threads = number(3).unwrap_or(1);
    match (words.first(), sort, number(2)) {
        (Some(&"measure"), Some(sort), Some(specs)) => {
            let seeds = MEASURED_FROM..MEASURED_FROM + specs;
            match serde_json::to_string_pretty(&table(&*sort, words[1], seeds, threads)) {
                Ok(text) => println!("{text}"),
                Err(error) => {
                    eprintln!("{error}");
                    return ExitCode::FAILURE;
                }
            }
            ExitCode::SUCCESS
        }
        (Some(&"check"), Some(sort), Some(specs)) => check(&*sort, specs, threads),
        _ => {
            eprintln!(
                "stated_errors measure|check nonwoven_tensile|nonwoven_tensile_large|granular_scene SPECS [THREADS]"
            );
            ExitCode::FAILURE
        }
    }
}

fn sort_of(kind: &str) -> Option<Box<dyn Sort>> {
    match kind {
        "nonwoven_tensile" => Some(Box::new(SMALL)),
        "nonwoven_tensile_large" => Some(Box::new(LARGE)),
        "granular_scene" => Some(Box::new(Scenes)),
        _ => None,
    }
}

fn check(sort: &dyn Sort, specs: u64, threads: u64) -> ExitCode {
    let seeds = CHECKED_FROM..CHECKED_FROM + specs;
    let all = for_each(seeds, threads, |seed| {
        sort::errors_apart(sort, seed, kept::report)
    });
    let mut is_kept = true;
    for name in sort.results() {
        let found = all.iter().flatten().filter(|(found, _)| found == name);
        let known: Vec<f64> = found.filter_map(|(_, apart)| *apart).collect();
        let inside = known.iter().filter(|apart| **apart <= 2.0).count();
        let largest = known.iter().copied().fold(0.0, f64::max);
        println!(
            "{name}: {inside} of {} within two stated errors, the farthest at {largest:.1}; {} without an error",
            known.len(),
            specs as usize - known.len(),
        );
        is_kept &= !known.is_empty() && inside as f64 >= PROMISE * known.len() as f64;
    }
    if is_kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
