//! How wrong results may be for how they were computed, as measured before.
//!
//! `errors.json` is what `cargo run --release -p loadframe-physics --example nonwoven_errors -- measure 30`
//! prints; it is read here. It holds, for each result that does not grow with the specimen, the relative error that
//! fabrics drawn at random from a stated range had at each level of three knobs, against the finest one:
//! A_cc, the strain step over the strain at which a bond of mean strength breaks, and the break precision.
//! An error is the root mean square over the fabrics, or half of what 95 % of them stayed below where that
//! is more: twice of it is to hold for 19 of 20. What lies between two levels has the error of the coarser.
//!
//! What is not known here: specimens. A result is that of the fabric that was drawn; how far others lie
//! from it repeats tell.
use indexmap::IndexMap;
use loadframe_api::spec::nonwoven_tensile::{Breaking, Fabric, NonwovenTensile, Solver};
use loadframe_api::{ErrorBasis, ErrorPart, Report};
use serde::Deserialize;

use super::specimen::Specimen;

/// Outermost part of a range, in its logarithm, that counts as its edge.
const EDGE: f64 = 0.03;
/// Results, and the measured one that they are proportional to.
const SAME: [(&str, &str); 14] = [
    ("max_force", "strength"),
    ("strength", "strength"),
    ("strength_pa", "strength"),
    ("tensile_index", "strength"),
    ("tenacity", "strength"),
    ("max_force_per_layer", "strength"),
    ("strain_at_max_force", "strain_at_max_force"),
    ("energy_absorption", "energy_absorption"),
    ("work_to_max_force", "energy_absorption"),
    ("modulus_at_10_percent", "modulus_at_10_percent"),
    ("secant_stiffness_at_10_percent", "modulus_at_10_percent"),
    ("modulus_at_10_percent_pa", "modulus_at_10_percent"),
    ("modulus_at_10_percent_per_tex", "modulus_at_10_percent"),
    ("poisson_ratio", "poisson_ratio"),
];

/// What was measured.
#[derive(Debug, Deserialize)]
struct Table {
    /// The least and the most of what the fabrics had, by name.
    range: IndexMap<String, [f64; 2]>,
    /// By rising A_cc.
    solver: Vec<Level>,
    /// By falling strain step.
    strain_step: Vec<Level>,
    /// By falling precision.
    break_precision: Vec<Level>,
}

/// Relative errors of results at one value of a knob.
#[derive(Debug, Deserialize)]
struct Level {
    at: f64,
    errors: IndexMap<String, f64>,
}

/// Gives results the errors that are known of them. Returns what is to be said of that: why there are
/// none, or that what was measured ends near here.
pub(super) fn add(
    report: &mut Report,
    spec: &NonwovenTensile,
    specimen: &Specimen,
    is_torn: bool,
) -> Option<String> {
    let Ok(table) = serde_json::from_str::<Table>(include_str!("errors.json")) else {
        return Some("results have no error: the table of errors cannot be read".to_owned());
    };
    let knobs = spec.accuracy.knobs();
    let is_measured = matches!(&spec.fabric, Fabric::Lattice(_))
        && knobs.solver == Solver::NewtonCg
        && spec.test.history.is_empty()
        && spec.test.breaking == Breaking::AllOverStrength;
    if !is_measured {
        return Some(
            "results have no error: it was measured for lattices that newton_cg pulls, all bonds over \
             their strength breaking at once"
                .to_owned(),
        );
    }
    let traits = traits(spec, specimen);
    let place = |(name, value): &(&str, f64)| {
        let [least, most] = table.range.get(*name).copied().unwrap_or([f64::NAN; 2]);
        format!("{name} is {value:.4}, and {least:.4} to {most:.4} was measured")
    };
    let is_beyond = |(name, value): &&(&str, f64)| {
        let range = table.range.get(*name);
        range.is_none_or(|[least, most]| !(least..=most).contains(&value))
    };
    if let Some(beyond) = traits.iter().find(is_beyond) {
        return Some(format!("results have no error: {}", place(beyond)));
    }
    let step = relative_step(spec, specimen);
    let precision = knobs.break_precision.unwrap_or(f64::INFINITY);
    let levels = [
        (
            "solver",
            level(&table.solver, |at| at <= knobs.force_accuracy),
        ),
        ("strain_step", level(&table.strain_step, |at| at >= step)),
        (
            "break_precision",
            level(&table.break_precision, |at| at >= precision),
        ),
    ];
    for (name, base) in SAME {
        let is_of_breaking = !["modulus_at_10_percent", "poisson_ratio"].contains(&base);
        if is_of_breaking && !is_torn {
            // the force at a given strain is no strength, and its error none of one
            continue;
        }
        let Some(quantity) = report.summary.get_mut(name) else {
            continue;
        };
        let part = |(source, level): &(&str, Option<&Level>)| {
            Some(ErrorPart {
                source: (*source).to_owned(),
                value: level.as_ref()?.errors.get(base)? * quantity.value?.abs(),
                basis: ErrorBasis::MeasuredTable,
            })
        };
        let sources = &levels[..if is_of_breaking { 3 } else { 2 }];
        // one part alone would say less than the error is
        let parts: Option<Vec<ErrorPart>> = sources.iter().map(part).collect();
        if let Some(parts) = parts {
            *quantity = quantity.clone().with_error(parts);
        }
    }
    let coarse: Vec<&str> = levels
        .iter()
        .filter(|(_, level)| level.is_none())
        .map(|(source, _)| *source)
        .collect();
    if !coarse.is_empty() {
        let coarse = coarse.join(" and ");
        return Some(format!(
            "some results have no error: {coarse} is coarser than was measured"
        ));
    }
    let is_edge = |(name, value): &&(&str, f64)| {
        table.range.get(*name).is_some_and(|[least, most]| {
            let width = EDGE * (most / least).ln();
            (value / least).ln() < width || (most / value).ln() < width
        })
    };
    let edge = traits.iter().find(is_edge)?;
    Some(format!(
        "errors of results are of the edge of what was measured: {}",
        place(edge)
    ))
}

/// The finest level among those that are as coarse as what was asked for.
fn level(levels: &[Level], is_coarse: impl Fn(f64) -> bool) -> Option<&Level> {
    levels.iter().rev().find(|level| is_coarse(level.at))
}

/// What decides how fabrics err, by name.
fn traits(spec: &NonwovenTensile, specimen: &Specimen) -> [(&'static str, f64); 6] {
    let law = specimen.mean_law;
    let irregularity = match &spec.fabric {
        Fabric::Lattice(lattice) => lattice.irregularity.iter().sum::<f64>() / 3.0,
        Fabric::Network(_) => f64::NAN,
    };
    [
        ("bonds", specimen.network.bonds.len() as f64),
        ("mean_irregularity", irregularity),
        (
            "compression_stiffness_over_modulus",
            law.compression_stiffness / law.modulus,
        ),
        (
            "strain_of_mean_strength",
            strain_of_strength(spec, specimen),
        ),
        ("strength_sigma", spec.bond.strength_sigma),
        (
            "strain_step_over_strain_of_mean_strength",
            relative_step(spec, specimen),
        ),
    ]
}

/// The strain step over the strain at which a bond of `mean_strength_n` breaks.
fn relative_step(spec: &NonwovenTensile, specimen: &Specimen) -> f64 {
    spec.test.strain_step / strain_of_strength(spec, specimen)
}

fn strain_of_strength(spec: &NonwovenTensile, specimen: &Specimen) -> f64 {
    let strength = spec.bond.mean_strength_n.unwrap_or(f64::NAN);
    specimen.mean_law.strain(strength)
}
