//! How wrong results may be for how they were computed, as measured before.
//!
//! `errors.json` is written by `cargo run --release -p loadframe-physics --example nonwoven_errors` and
//! read here. It holds, for each result that does not grow with the specimen, the relative error that
//! fabrics drawn at random from a stated range had at each level of three knobs, against the finest one:
//! A_cc, the strain step over the strain at which a bond of mean strength breaks, and the break precision.
//! An error is the root mean square over the fabrics, or half of what 95 % of them stayed below where that
//! is more: twice of it is to hold for 19 of 20. What lies between two levels has the error of the coarser.
//!
//! What is not known here: specimens. A result is that of the fabric that was drawn; how far others lie
//! from it repeats tell.
use indexmap::IndexMap;
use loadframe_api::spec::nonwoven_tensile::{Breaking, Fabric, NonwovenTensile, Solver};
use loadframe_api::{ErrorBasis, ErrorPart, Report, Warning};
use serde::Deserialize;

use super::specimen::Specimen;

/// Outermost part of a range, in its logarithm, that counts as its edge.
const EDGE: f64 = 0.03;
/// Results, and the measured one that they are proportional to.
const SAME: [(&str, &str); 13] = [
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

/// Gives results the errors that are known of them, and says where they are not although fabrics like
/// this one were measured.
pub(super) fn add(report: &mut Report, spec: &NonwovenTensile, specimen: &Specimen, is_torn: bool) {
    let Ok(table) = serde_json::from_str::<Table>(include_str!("errors.json")) else {
        return;
    };
    let knobs = spec.accuracy.knobs();
    let (Fabric::Lattice(_), Solver::NewtonCg) = (&spec.fabric, knobs.solver) else {
        return;
    };
    let is_measured =
        spec.test.history.is_empty() && spec.test.breaking == Breaking::AllOverStrength;
    if !is_measured {
        return;
    }
    let traits = traits(spec, specimen);
    for (name, value) in &traits {
        let Some([least, most]) = table.range.get(*name) else {
            return;
        };
        if !(least..=most).contains(&value) {
            report.warnings.push(Warning {
                code: "error_not_known".to_owned(),
                detail: format!(
                    "results have no error: {name} is {value:.4}, and {least:.4} to {most:.4} was measured"
                ),
            });
            return;
        }
    }
    let step = relative_step(spec, specimen);
    let coarser =
        |levels: &[Level], is_coarser: &dyn Fn(f64) -> bool| -> Option<IndexMap<String, f64>> {
            let levels = levels.iter().rev();
            let mut fits = levels.filter(|level| is_coarser(level.at));
            fits.next().map(|level| level.errors.clone())
        };
    let solver = coarser(&table.solver, &|at| at <= knobs.force_accuracy);
    let strain_step = coarser(&table.strain_step, &|at| at >= step);
    let precision = knobs.break_precision.unwrap_or(f64::INFINITY);
    let break_precision = coarser(&table.break_precision, &|at| at >= precision);
    let is_edge = traits.iter().find(|(name, value)| {
        let [least, most] = table.range[*name];
        let width = EDGE * (most / least).ln();
        (value / least).ln() < width || (most / value).ln() < width
    });
    let mut any = false;
    for (name, base) in SAME.into_iter().chain([("poisson_ratio", "poisson_ratio")]) {
        let breaks = !["modulus_at_10_percent", "poisson_ratio"].contains(&base);
        if breaks && !is_torn {
            // the force at a given strain is no strength, and its error none of one
            continue;
        }
        let Some(quantity) = report.summary.get_mut(name) else {
            continue;
        };
        let mut sources = vec![("solver", &solver), ("strain_step", &strain_step)];
        if breaks {
            sources.push(("break_precision", &break_precision));
        }
        let part = |(source, errors): (&str, &Option<IndexMap<String, f64>>)| {
            Some(ErrorPart {
                source: source.to_owned(),
                value: errors.as_ref()?.get(base)? * quantity.value?.abs(),
                basis: ErrorBasis::MeasuredTable,
            })
        };
        let parts: Option<Vec<ErrorPart>> = sources.into_iter().map(part).collect();
        // one part alone would say less than the error is
        if let Some(parts) = parts {
            *quantity = quantity.clone().with_error(parts);
            any = true;
        }
    }
    if !any {
        report.warnings.push(Warning {
            code: "error_not_known".to_owned(),
            detail:
                "results have no error: accuracy or strain_step is coarser than what was measured"
                    .to_owned(),
        });
    } else if let Some((name, value)) = is_edge {
        let [least, most] = table.range[*name];
        report.warnings.push(Warning {
            code: "error_at_edge".to_owned(),
            detail: format!(
                "errors of results are those of fabrics on the edge of what was measured: {name} is \
                 {value:.4}, and {least:.4} to {most:.4} was measured"
            ),
        });
    }
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
