//! Validation: the PET fabric of [Zilka2022] against its simulations, against near-exact solutions
//! of the same model by a second program (`prototype.py`), and against the experiment; and that the
//! page of the ballast tells what the engine computes.
//!
//! Three seeds for each form of jaws run in every test; `LOADFRAME_VALIDATION=write` runs ten and
//! writes `tests/validation/nonwoven.md`, misses included. One material is a demonstration: whether
//! the model predicts other fabrics is not shown here.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "tests stop at what is unexpected and speak to people"
)]
mod ballast;
mod page;
mod reference;

use loadframe_tests::run_alone;
use serde_json::{Value, json};
use std::ops::RangeInclusive;

/// Results of one test.
#[derive(Clone, Copy, Debug)]
struct Run {
    jaws: &'static str,
    seed: u64,
    /// In the order of [`QUANTITIES`].
    values: [f64; 4],
}

/// Summary names of what is compared.
const QUANTITIES: [&str; 4] = [
    "max_force",
    "strain_at_max_force",
    "poisson_ratio",
    "secant_stiffness_at_10_percent",
];
const JAWS: [&str; 2] = ["half_bond", "clamped_rows"];

fn pet_case() -> Value {
    serde_json::from_str(include_str!("../../api/examples/nonwoven_tensile.json")).unwrap()
}

fn run(jaws: &'static str, seed: u64, folder: &std::path::Path) -> Run {
    let mut body = pet_case();
    body["spec"]["seed"] = json!(seed);
    body["spec"]["fabric"]["lattice"]["jaws"] = json!(jaws);
    // what it is held against was computed to near-exact equilibrium, at whole strain steps
    body["spec"]["accuracy"] = json!({"force_accuracy": 1e4, "break_precision": null});
    body["spec"]["output"] = json!({"snapshot_every_steps": 0});
    let outcome = run_alone(&body, 2, &folder.join(format!("{jaws}-{seed}"))).outcome;
    let checks = outcome["quality"].as_object().unwrap().iter();
    for (name, check) in checks.filter(|(name, _)| *name != "overstepped_force") {
        assert_eq!(check["ok"], true, "{jaws}, seed {seed}: {name}: {check}");
    }
    let warnings = outcome["warnings"].as_array().unwrap();
    for warning in warnings {
        assert_eq!(warning["code"], "break_overstepped", "{jaws}, seed {seed}");
    }
    let value = |name: &str| outcome["summary"][name]["value"].as_f64().unwrap();
    Run {
        jaws,
        seed,
        values: QUANTITIES.map(value),
    }
}

fn run_all(seeds: RangeInclusive<u64>) -> Vec<Run> {
    let folder = tempfile::TempDir::new().unwrap();
    let each = JAWS
        .into_iter()
        .flat_map(|jaws| seeds.clone().map(move |seed| (jaws, seed)));
    each.map(|(jaws, seed)| run(jaws, seed, folder.path()))
        .collect()
}

#[test]
fn same_specimens_by_a_second_program() {
    reference::check_specimens();
}

#[test]
fn pet_fabric_against_thesis_and_experiment() {
    const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/validation/nonwoven.md");
    let writes = std::env::var("LOADFRAME_VALIDATION").is_ok_and(|word| word == "write");
    let runs = run_all(1..=if writes { 10 } else { 3 });
    eprintln!("{}", page::write(&runs));
    reference::check(&runs);
    if writes {
        std::fs::write(PAGE, page::write(&runs)).unwrap();
    }
    let committed = std::fs::read_to_string(PAGE).unwrap();
    for run in &runs {
        let row = page::row(run);
        assert!(
            committed.contains(&row),
            "the page no longer tells what the engine computes (LOADFRAME_VALIDATION=write renews it): {row}"
        );
    }
}
