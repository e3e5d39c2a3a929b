//! What the engine must reproduce: near-exact solutions of the same fabric by a program of its own.
use crate::{QUANTITIES, Run};

/// Mean and standard deviation over seeds of an independent prototype (Newton with conjugate
/// gradients to 10⁻⁴ of the force limit, written for this project before the engine; its random
/// streams differ, so that only distributions can be compared).
struct Reference {
    jaws: &'static str,
    quantity: &'static str,
    mean: f64,
    deviation: f64,
    seeds: u32,
}

const fn reference(
    jaws: &'static str,
    quantity: &'static str,
    mean: f64,
    deviation: f64,
    seeds: u32,
) -> Reference {
    Reference {
        jaws,
        quantity,
        mean,
        deviation,
        seeds,
    }
}

const REFERENCES: [Reference; 7] = [
    reference("half_bond", "max_force", 3.0 * 134.9, 3.0 * 1.4, 5),
    reference("half_bond", "strain_at_max_force", 1.126, 0.015, 5),
    reference(
        "half_bond",
        "secant_stiffness_at_10_percent",
        3.0 * 28.66,
        3.0 * 0.02,
        5,
    ),
    reference("clamped_rows", "max_force", 403.3, 7.3, 10),
    reference("clamped_rows", "strain_at_max_force", 1.100, 0.019, 10),
    reference("clamped_rows", "poisson_ratio", 0.562, 0.002, 10),
    reference(
        "clamped_rows",
        "secant_stiffness_at_10_percent",
        90.58,
        0.10,
        10,
    ),
];

/// Student's t beyond which two means of the same distribution lie apart once in a hundred times,
/// by the number of seeds behind the reference's deviation (4 and 9 degrees of freedom).
fn student(seeds: u32) -> f64 {
    match seeds {
        5 => 4.60,
        10 => 3.25,
        _ => unreachable!("the references have 5 or 10 seeds"),
    }
}

/// Without a deviation in the source: the range of five seeds, printed with two digits.
const POISSON_HALF_BOND: std::ops::RangeInclusive<f64> = 0.545..=0.565;

/// The mean over the runs with these jaws.
pub(crate) fn mean(runs: &[Run], jaws: &str, quantity: &str) -> f64 {
    let index = QUANTITIES
        .iter()
        .position(|name| *name == quantity)
        .unwrap();
    let chosen = runs.iter().filter(|run| run.jaws == jaws);
    let values: Vec<f64> = chosen.map(|run| run.values[index]).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// Holds the means over seeds against the references.
///
/// # Panics
/// When one lies further off than the scatter over seeds allows.
pub(crate) fn check(runs: &[Run]) {
    let mut misses = Vec::new();
    for reference in &REFERENCES {
        let Reference { jaws, quantity, .. } = reference;
        let found = mean(runs, jaws, quantity);
        let own_seeds = runs.iter().filter(|run| run.jaws == *jaws).count() as f64;
        let error =
            reference.deviation * (1.0 / own_seeds + 1.0 / f64::from(reference.seeds)).sqrt();
        let allowed = student(reference.seeds) * error;
        let off = found - reference.mean;
        let line = format!(
            "{jaws} {quantity}: {found:.4}, reference {:.4}, off {off:+.4} of ± {allowed:.4}",
            reference.mean
        );
        eprintln!("{line}");
        if off.abs() > allowed {
            misses.push(line);
        }
    }
    let poisson = mean(runs, "half_bond", "poisson_ratio");
    if !POISSON_HALF_BOND.contains(&poisson) {
        misses.push(format!(
            "half_bond poisson_ratio: {poisson:.4} not in {POISSON_HALF_BOND:?}"
        ));
    }
    assert!(misses.is_empty(), "{misses:#?}");
}
