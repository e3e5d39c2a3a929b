//! Measures how far nonwoven tests are off for how they are computed, and checks what the engine says of
//! it.
//!
//!   cargo run --release -p loadframe-physics --example nonwoven_errors -- measure SPECS [THREADS]
//!   cargo run --release -p loadframe-physics --example nonwoven_errors -- check SPECS [THREADS]
//!
//! `measure` draws fabrics and writes what belongs into `network/src/nonwoven/errors.json`; `check` draws
//! others, with settings drawn too, and prints for how many of them the finest test of the same fabric
//! lies within two of the errors that their results state. It fails below nine of ten.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a command")]
mod fabrics;

use std::collections::BTreeMap;
use std::num::NonZero;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use fabrics::{FINEST, RESULTS, SMALL, at, drawn, report, settings, value};
use serde_json::{Value, json};

/// Levels of each knob, the coarsest first.
const A_CC: [f64; 4] = [5.0, 20.0, 100.0, 1e3];
const STEPS: [f64; 4] = [0.05, 0.02, 0.01, 0.005];
const PRECISIONS: [f64; 3] = [0.05, 0.01, 0.002];
/// What the others are at while one is varied.
const BASE: [f64; 3] = [1e3, 0.01, 0.01];
/// Seeds of the fabrics that are measured, and of those that are checked.
const MEASURED_FROM: u64 = 1;
const CHECKED_FROM: u64 = 100_001;
/// Part of the fabrics that twice an error is to hold for, at least.
const PROMISE: f64 = 0.9;
const QUANTILE: f64 = 0.95;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let specs = arguments.get(1).and_then(|specs| specs.parse().ok());
    match (arguments.first().map(String::as_str), specs) {
        (Some("measure"), Some(specs)) => measure(specs),
        (Some("check"), Some(specs)) => check(specs),
        _ => {
            eprintln!("nonwoven_errors measure|check SPECS [THREADS]");
            ExitCode::FAILURE
        }
    }
}

/// Relative errors of each result at each level of a knob, one of each fabric.
type Found = BTreeMap<usize, BTreeMap<&'static str, Vec<f64>>>;

/// An error of one fabric: knob, level, result, and how far it is off.
type One = (usize, usize, &'static str, f64);

/// The values of each knob.
const LEVELS: [&[f64]; 3] = [&A_CC, &STEPS, &PRECISIONS];

/// What `work` finds for each seed, on all cores or on as many threads as are given, in the order of the seeds.
fn for_each<T: Send>(from: u64, specs: u64, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let next = AtomicU64::new(from);
    let found = Mutex::new(BTreeMap::new());
    let given = std::env::args()
        .nth(3)
        .and_then(|threads| threads.parse().ok());
    let threads =
        given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= from + specs {
                        return;
                    }
                    let one = work(seed);
                    if let Ok(mut found) = found.lock() {
                        found.insert(seed, one);
                        eprintln!("{} of {specs}", found.len());
                    }
                }
            });
        }
    });
    let found = found.into_inner().unwrap_or_default();
    found.into_values().collect()
}

/// The errors of one fabric.
fn errors_of(seed: u64) -> Vec<One> {
    let (fabric, strain) = drawn(seed, SMALL);
    let mut found = Vec::new();
    for (knob, levels) in LEVELS.into_iter().enumerate() {
        let with = |value: f64| {
            let mut setting = BASE;
            setting[knob] = value;
            report(&at(&fabric, strain, setting))
        };
        let Some(finest) = with(FINEST[knob]) else {
            eprintln!("fabric {seed} has no result");
            continue;
        };
        for (level, setting) in levels.iter().enumerate() {
            let Some(coarse) = with(*setting) else {
                eprintln!("fabric {seed} has no result at {setting}");
                continue;
            };
            found.extend(RESULTS.into_iter().filter_map(|name| {
                let (coarse, finest) = value(&coarse, name).zip(value(&finest, name))?;
                Some((knob, level, name, (coarse - finest).abs() / finest.abs()))
            }));
        }
    }
    found
}

fn measure(specs: u64) -> ExitCode {
    let mut found: [Found; 3] = Default::default();
    let all = for_each(MEASURED_FROM, specs, errors_of);
    for (knob, level, name, error) in all.into_iter().flatten() {
        let errors = found[knob].entry(level).or_default();
        errors.entry(name).or_default().push(error);
    }
    let mut range = BTreeMap::<String, [f64; 2]>::new();
    for seed in MEASURED_FROM..MEASURED_FROM + specs {
        let (fabric, strain) = drawn(seed, SMALL);
        for (name, value) in traits(&fabric, strain) {
            let bounds = range.entry(name).or_insert([value, value]);
            *bounds = [bounds[0].min(value), bounds[1].max(value)];
        }
    }
    let steps = [STEPS[STEPS.len() - 1], STEPS[0]];
    range.insert("strain_step_over_strain_of_mean_strength".to_owned(), steps);
    let [solver, strain_step, break_precision] =
        [0, 1, 2].map(|knob| table(LEVELS[knob], &found[knob]));
    let table = json!({
        "measured_by": format!("nonwoven_errors measure {specs}"),
        "range": range,
        "solver": solver,
        "strain_step": strain_step,
        "break_precision": break_precision,
    });
    match serde_json::to_string_pretty(&table) {
        Ok(text) => println!("{text}"),
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

/// What decides how a fabric errs, as the engine names it.
fn traits(
    fabric: &loadframe_api::spec::nonwoven_tensile::NonwovenTensile,
    strain: f64,
) -> Vec<(String, f64)> {
    let loadframe_api::spec::nonwoven_tensile::Fabric::Lattice(lattice) = &fabric.fabric else {
        return Vec::new();
    };
    let bond = &fabric.bond;
    let ratio = bond.compression_stiffness_n / bond.modulus_n.unwrap_or(f64::NAN);
    vec![
        ("bonds".to_owned(), lattice.bonds() as f64),
        ("mean_irregularity".to_owned(), lattice.irregularity[0]),
        ("compression_stiffness_over_modulus".to_owned(), ratio),
        ("strain_of_mean_strength".to_owned(), strain),
        ("strength_sigma".to_owned(), bond.strength_sigma),
    ]
}

/// The errors of all levels; a coarser one has at least that of the next finer, which chance may have
/// made the larger.
fn table(levels: &[f64], found: &Found) -> Vec<Value> {
    let mut finer = BTreeMap::<&str, f64>::new();
    let mut rows = Vec::new();
    for (level, at) in levels.iter().enumerate().rev() {
        for (name, all) in found.get(&level).into_iter().flatten() {
            let least = finer.entry(name).or_default();
            *least = least.max(error(all));
        }
        rows.push(json!({"at": at, "errors": finer}));
    }
    rows.reverse();
    rows
}

/// The root mean square, or half of what most stay below where that is more; to three digits.
fn error(all: &[f64]) -> f64 {
    let squares: f64 = all.iter().map(|error| error * error).sum();
    let mut sorted = all.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (QUANTILE * all.len() as f64).ceil() as usize;
    let most = sorted[place.clamp(1, all.len()) - 1];
    let error = (squares / all.len() as f64).sqrt().max(0.5 * most);
    format!("{error:.2e}").parse().unwrap_or(error)
}

/// How many of its stated errors each result of a fabric lies from that of the finest test.
fn errors_apart(seed: u64) -> Vec<(&'static str, Option<f64>)> {
    let (fabric, strain) = drawn(seed, SMALL);
    let [test, finest] =
        [settings(seed), FINEST].map(|setting| report(&at(&fabric, strain, setting)));
    let (Some(test), Some(finest)) = (test, finest) else {
        return Vec::new();
    };
    let apart = |name| {
        let stated = test.summary.get(name)?.error.as_ref()?.value;
        let (found, finest) = value(&test, name).zip(value(&finest, name))?;
        Some((found - finest).abs() / stated)
    };
    RESULTS.map(|name| (name, apart(name))).to_vec()
}

fn check(specs: u64) -> ExitCode {
    let all = for_each(CHECKED_FROM, specs, errors_apart);
    let mut is_kept = true;
    for name in RESULTS {
        let found = all.iter().flatten().filter(|(found, _)| *found == name);
        let known: Vec<f64> = found.filter_map(|(_, apart)| *apart).collect();
        let inside = known.iter().filter(|apart| **apart <= 2.0).count();
        let largest = known.iter().copied().fold(0.0, f64::max);
        let unknown = specs as usize - known.len();
        println!(
            "{name}: {inside} of {} within two stated errors, the farthest at {largest:.1}; {unknown} without \
             an error",
            known.len()
        );
        is_kept &= !known.is_empty() && inside as f64 >= PROMISE * known.len() as f64;
    }
    if is_kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
