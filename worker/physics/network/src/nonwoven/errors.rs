//! How wrong results may be for how they were computed, as measured before.
//!
//! A table is what `cargo run --release -p loadframe-physics --example stated_errors -- measure nonwoven_tensile 30`
//! (or `nonwoven_tensile_large 45`) prints; [`ErrorTable`] reads it. It holds the errors of fabrics drawn at random at levels of three knobs: A_cc,
//! the strain step over the strain at which a bond of mean strength breaks, and the break precision.
//! An error is the root mean square over the fabrics, or half of what 95 % of them stayed below where that
//! is more: twice of it is to hold for 19 of 20.
//!
//! What is not known here: specimens. A result is that of the fabric that was drawn; how far others lie
//! from it repeats tell.
use loadframe_api::Report;
use loadframe_api::spec::nonwoven_tensile::{
    Breaking, Fabric, Lattice, NonwovenTensile, Solver, StrengthDraw,
};
use loadframe_harness::{ErrorTable, Likeness};

use super::specimen::Specimen;

/// Results of rupture, and the measured one that they are proportional to.
const OF_RUPTURE: [(&str, &str); 9] = [
    ("max_force", "strength"),
    ("strength", "strength"),
    ("strength_pa", "strength"),
    ("tensile_index", "strength"),
    ("tenacity", "strength"),
    ("max_force_per_layer", "strength"),
    ("strain_at_max_force", "strain_at_max_force"),
    ("energy_absorption", "energy_absorption"),
    ("work_to_max_force", "energy_absorption"),
];
/// The same of small strains.
const OF_SMALL_STRAIN: [(&str, &str); 5] = [
    ("modulus_at_10_percent", "modulus_at_10_percent"),
    ("secant_stiffness_at_10_percent", "modulus_at_10_percent"),
    ("modulus_at_10_percent_pa", "modulus_at_10_percent"),
    ("modulus_at_10_percent_per_tex", "modulus_at_10_percent"),
    ("poisson_ratio", "poisson_ratio"),
];

/// Tables of fabrics, the smallest ones first: where many bonds carry, a single one of them matters less.
const TABLES: [&str; 2] = [
    include_str!("errors/small.json"),
    include_str!("errors/large.json"),
];

/// Layers of the fabrics that were measured, and the fewest points along a side.
const MOST_LAYERS: u32 = 3;
const FEWEST_POINTS: u32 = 6;
/// Of forces, the first that a test has tells how wrong its forces may be.
const FORCES: [&str; 2] = ["max_force", "secant_stiffness_at_10_percent"];
/// An error is to hold for 19 of 20 when taken so many times.
const PROMISED: f64 = 2.0;

/// Gives results the errors that are known of them. Returns what is to be said of those that have none.
pub(super) fn add(
    report: &mut Report,
    spec: &NonwovenTensile,
    specimen: &Specimen,
    is_torn: bool,
) -> Option<String> {
    let bonds = specimen.network.bonds.len() as f64;
    let table = match ErrorTable::first_reaching(&TABLES, "bonds", bonds) {
        Ok(table) => table,
        Err(error) => return Some(format!("results have no error: its table is none: {error}")),
    };
    if let Some(check) = report.quality.get("unconverged_steps")
        && !check.ok
    {
        return Some(format!(
            "results have no error: it was measured of equilibria, and {} steps have none",
            check.value
        ));
    }
    let knobs = spec.accuracy.knobs();
    let is_measured = knobs.solver == Solver::NewtonCg
        && spec.test.breaking == Breaking::AllOverStrength
        && spec.test.history.is_empty()
        && spec.bond.strength_draw == StrengthDraw::LogNormal;
    let lattice = match &spec.fabric {
        Fabric::Lattice(lattice) if is_measured && is_drawn(lattice) => lattice,
        _ => {
            return Some(format!(
                "results have no error: it was measured for lattices of up to {MOST_LAYERS} layers and at \
                 least {FEWEST_POINTS} points along both sides, alike irregular along all axes, of log-normal \
                 strength, that newton_cg pulls once, all bonds over their strength breaking at once"
            ));
        }
    };
    let law = specimen.mean_law;
    let strength = spec.bond.mean_strength_n.unwrap_or(f64::NAN);
    let strain_of_strength = law.strain(strength);
    let [x, y, z] = lattice.spacing_mm;
    let traits = [
        ("bonds", bonds),
        (
            "rows_over_points_per_row",
            f64::from(lattice.rows) / f64::from(lattice.points_per_row),
        ),
        (
            "mean_irregularity",
            lattice.irregularity.iter().sum::<f64>() / 3.0,
        ),
        (
            "compression_stiffness_over_modulus",
            law.compression_stiffness / law.modulus,
        ),
        (
            "friction_modulus_over_modulus",
            law.friction_modulus / law.modulus,
        ),
        ("strain_of_mean_strength", strain_of_strength),
        ("strength_sigma", spec.bond.strength_sigma),
        ("spacing_x_over_y", x / y),
        ("spacing_z_over_y", z / y),
    ];
    let knobs = [
        ("solver", knobs.force_accuracy),
        ("strain_step", spec.test.strain_step / strain_of_strength),
        (
            "break_precision",
            knobs.break_precision.unwrap_or(f64::INFINITY),
        ),
    ];
    // the force at a given strain is no strength, and its error none of one
    let of_rupture = if is_torn { &OF_RUPTURE[..] } else { &[] };
    let mut stated = report.clone();
    let words = table.add(
        &mut stated,
        &Likeness {
            traits: &traits,
            knobs: &knobs,
            results: &[of_rupture, &OF_SMALL_STRAIN].concat(),
        },
    );
    let refuted = refuted(&stated);
    if refuted.is_none() {
        *report = stated;
    }
    refuted.or(words)
}

/// Whether a lattice is of those that were drawn, apart from what a table has the range of.
fn is_drawn(lattice: &Lattice) -> bool {
    let [x, y, z] = lattice.irregularity.map(f64::to_bits);
    let fewest = lattice.points_per_row.min(lattice.rows);
    lattice.layers <= MOST_LAYERS && fewest >= FEWEST_POINTS && x == y && y == z
}

/// Why the errors of a report do not hold: the forces on the two jaws, which are one in equilibrium, differ
/// by more than the error of a force allows. Where a coarse `force_accuracy` was measured they differ too,
/// by what its error has in it.
fn refuted(stated: &Report) -> Option<String> {
    let imbalance = stated.quality.get("jaw_force_imbalance")?;
    let relative = |name: &&str| {
        let force = stated.summary.get(*name)?;
        Some(force.error.as_ref()?.value / force.value?.abs())
    };
    let error = FORCES.iter().find_map(relative)?;
    let is_beyond = !imbalance.ok && imbalance.value > PROMISED * error;
    is_beyond.then(|| {
        format!(
            "results have no error: the forces on the two jaws differ by {:.2} % of the maximum force, and \
             such tests were measured to be {:.2} % off",
            100.0 * imbalance.value,
            100.0 * error
        )
    })
}
