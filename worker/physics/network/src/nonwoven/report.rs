//! Results of a test in the words of tensile standards, and whether to believe them.
use loadframe_api::{
    Report,
    spec::nonwoven_tensile::{Breaking, Fabric, NonwovenTensile, Solver},
};
use loadframe_harness::{ReportBuilder, curve};

use super::{
    cycles, distribution,
    experiment::{LARGEST_OVERSTEP, StopReason},
    readings::{self, N_PER_M, N_PER_TEX, PA, Pull, USUAL_STRAIN},
    specimen::Specimen,
    state::{Point, State},
};
use crate::equilibrium::work::Work;

/// Largest difference between the jaw forces, relative to the maximum force, that goes without
/// warning: the force error ISO 7500-1 allows a testing machine of class 1.
const LARGEST_IMBALANCE: f64 = 0.01;
/// N mm per mm² in J/m².
const J_PER_M2: f64 = 1e3;
/// N mm in J.
const J: f64 = 1e-3;
/// Results related to the width, readings at strains apart.
const PER_WIDTH: [&str; 5] = [
    "strength",
    "energy_absorption",
    "strength_pa",
    "tensile_index",
    "tenacity",
];
/// Strains listed in a warning before it only counts.
const LISTED_STRAINS: usize = 5;

/// The report of a finished test.
pub(super) fn report(
    spec: &NonwovenTensile,
    specimen: &Specimen,
    state: &State,
    stop_reason: StopReason,
) -> Report {
    let mut report = ReportBuilder::new(stop_reason.name());
    results(&mut report, spec, specimen, state, stop_reason);
    if !spec.test.history.is_empty() {
        cycles::report(&mut report, spec, state, stop_reason);
    } else if let Fabric::Network(_) = spec.fabric {
        // how wrong lattices may be was measured; over the few steps of a small pull their work is a coarse sum
        cycles::check_pull(&mut report, state);
    }
    checks(&mut report, spec, state);
    warn(&mut report, spec, specimen, state, stop_reason);
    count_work(&mut report, &state.work);
    let mut report = report.finish();
    if let Some(reason) = readings::without_width(specimen) {
        for name in PER_WIDTH {
            if let Some(quantity) = report.summary.get_mut(name) {
                *quantity = quantity.clone().or_because(reason);
            }
        }
    }
    report
}

fn results(
    report: &mut ReportBuilder,
    spec: &NonwovenTensile,
    specimen: &Specimen,
    state: &State,
    stop_reason: StopReason,
) {
    let column = |value: fn(&Point) -> f64| -> Vec<(f64, f64)> {
        let points = state.points.iter();
        points
            .map(|point| (point.nominal_strain, value(point)))
            .collect()
    };
    let forces = column(|point| point.force);
    let peak = curve::peak(&forces);
    let max_force = peak.map(|peak| forces[peak].1);
    let work_to_peak = peak.map(|peak| curve::area(&forces[..=peak]) * specimen.gauge_length);
    // a way back says nothing of a first pull
    let pulled = state.points.iter().position(|point| point.is_unloading);
    let pulled = pulled.unwrap_or(state.points.len());
    let width_strains = column(|point| point.width_strain.unwrap_or(f64::NAN));
    let pull = Pull {
        specimen,
        forces: &forces[..pulled],
        width_strains: &width_strains[..pulled],
        stop_reason,
    };
    let usual = pull.read(USUAL_STRAIN);
    let per_width = |force: f64| force / specimen.width * N_PER_M;

    report.result(
        "max_force",
        max_force,
        "N",
        "Largest force on the moving jaw.",
    );
    report.result(
        "strain_at_max_force",
        peak.map(|peak| forces[peak].0),
        "1",
        "Nominal strain at the largest force: jaw displacement over gauge length.",
    );
    report.result(
        "strength",
        max_force.map(per_width),
        "N/m",
        "Largest force per width of the specimen.",
    );
    usual.stiffness(report);
    report.result(
        "energy_absorption",
        work_to_peak.map(|work| work / (specimen.width * specimen.gauge_length) * J_PER_M2),
        "J/m2",
        "Work of the moving jaw up to the largest force, per area between the jaws \
         (tensile energy absorption as in ISO 1924).",
    );
    report.result(
        "work_to_max_force",
        work_to_peak.map(|work| work * J),
        "J",
        "Work of the moving jaw up to the largest force.",
    );
    if let Some(thickness) = specimen.thickness {
        let stress = |force: f64| force / (specimen.width * thickness) * PA;
        report.result(
            "strength_pa",
            max_force.map(stress),
            "Pa",
            "Largest force over width times thickness.",
        );
    }
    usual.stress(report);
    if let Some(grammage) = specimen.grammage {
        let index = |force: f64| per_width(force) / grammage;
        report.result(
            "tensile_index",
            max_force.map(index),
            "N m/g",
            "Largest force per width over grammage.",
        );
        report.result(
            "tenacity",
            max_force.map(|force| N_PER_TEX * index(force)),
            "N/tex",
            "Largest force over the mass per length of the specimen.",
        );
    }
    usual.per_mass(report);
    if let Some(layers) = specimen.layers {
        report.result(
            "max_force_per_layer",
            max_force.map(|force| force / f64::from(layers)),
            "N",
            "Largest force over the number of layers; only for comparison with [Zilka2022], whose \
             figures appear to count one layer.",
        );
    }
    report.result(
        "specimen_width",
        specimen.width,
        "mm",
        "Width that forces are related to.",
    );
    report.result(
        "gauge_length",
        specimen.gauge_length,
        "mm",
        "Distance of the jaws before the test.",
    );
    report.result(
        "mean_bond_strength",
        specimen.mean_strength(),
        "N",
        "Mean strength of the bonds that can break, as drawn or given.",
    );
    let network = &specimen.network;
    for (name, count, description) in [
        ("broken_bonds", state.events.len(), "Bonds that broke."),
        (
            "nodes",
            network.positions.len(),
            "Nodes, held ones included.",
        ),
        ("bonds", network.bonds.len(), "Bonds before the test."),
    ] {
        report.count(name, count, description);
    }
    for strain in &spec.output.reading_strains {
        let reading = pull.read(*strain);
        reading.stiffness(report);
        reading.stress(report);
        reading.per_mass(report);
    }
}

fn checks(report: &mut ReportBuilder, spec: &NonwovenTensile, state: &State) {
    let largest = |value: fn(&Point) -> f64| state.points.iter().map(value).fold(0.0, f64::max);
    let imbalance = largest(|point| (point.force - point.bottom_force).abs());
    let relative_imbalance = if imbalance > 0.0 {
        imbalance / state.max_force
    } else {
        0.0
    };
    report.check(
        "largest_residual_ratio",
        largest(|point| point.residual_ratio),
        1.0,
        "1",
        "Largest resultant of a free node over its limit, over all equilibria.",
    );
    report.check(
        "jaw_force_imbalance",
        relative_imbalance,
        LARGEST_IMBALANCE,
        "1",
        "Largest difference between the forces on the two jaws, over the maximum force.",
    );
    report.check(
        "overstepped_force",
        overstepped(state),
        spec.accuracy
            .knobs()
            .break_precision
            .map_or(LARGEST_OVERSTEP, |precision| {
                precision.max(LARGEST_OVERSTEP)
            }),
        "1",
        "How far the force may have risen past where it fell, over its maximum: maximum force \
                 and its strain may be off by so much.",
    );
    report.check(
        "unconverged_steps",
        state.unconverged.len() as f64,
        0.0,
        "1",
        "Strain steps in which an equilibrium was not reached.",
    );
}

/// The fall of the force found least precisely, over the maximum force.
fn overstepped(state: &State) -> f64 {
    state
        .unresolved
        .map_or(0.0, |worst| worst.force / state.max_force.max(worst.force))
}

fn warn(
    report: &mut ReportBuilder,
    spec: &NonwovenTensile,
    specimen: &Specimen,
    state: &State,
    stop_reason: StopReason,
) {
    if !state.unconverged.is_empty() {
        report.warn(
            "unconverged_steps",
            format!(
                "equilibrium was not reached at {}; forces there are upper estimates at best",
                strains(&state.unconverged)
            ),
        );
    }
    if !state.round_off.is_empty() {
        report.warn(
            "round_off_reached",
            format!(
                "at {} the force limit lies below rounding error; equilibrium is as exact as \
                 double precision allows",
                strains(&state.round_off)
            ),
        );
    }
    if let Some((node, strain)) = state.mechanism {
        report.warn(
            "mechanism",
            format!(
                "node {node} is part of a mechanism: at a nominal strain of {strain} nothing \
                 resists its motion along its resultant"
            ),
        );
    }
    if let Some((node, strain)) = state.unstable {
        report.warn(
            "unstable_equilibrium",
            format!(
                "at a nominal strain of {strain} compressed bonds push at node {node} from both sides and \
                 nothing holds it aside: forces are those of a balance that the least push ends; move \
                 the node off the line of its bonds by a little"
            ),
        );
    }
    if let Some(imbalance) = report
        .failed("jaw_force_imbalance")
        .map(|check| check.value)
    {
        report.warn(
            "jaw_force_imbalance",
            format!(
                "the forces on the two jaws differ by {:.2} % of the maximum force; a higher \
                 force_accuracy{} brings them together",
                100.0 * imbalance,
                match spec.accuracy.knobs().solver {
                    Solver::NewtonCg => "",
                    _ => " or the solver newton_cg",
                },
            ),
        );
    }
    let overstepped = report.failed("overstepped_force").map(|check| check.value);
    if let (Some(overstepped), Some(worst)) = (overstepped, state.unresolved) {
        report.warn(
            "break_overstepped",
            format!(
                "at a nominal strain of {:.6} the force fell within a strain step; the maximum force \
                 may be off by {:.1} %, and its strain with it: a break_precision or a smaller \
                 strain_step finds where it begins",
                worst.nominal_strain,
                100.0 * overstepped,
            ),
        );
    }
    let unreached = distribution::unreached(spec, state);
    if !unreached.is_empty() {
        report.warn(
            "strain_not_reached",
            format!(
                "the test ended before {}, at which bond forces were asked for",
                strains(&unreached)
            ),
        );
    }
    let landscape = spec.output.force_landscape.as_ref();
    if let Some(asked) = landscape.filter(|_| !state.has_landscape) {
        report.warn(
            "strain_not_reached",
            format!(
                "the test ended before {}, at which the force landscape was asked for",
                strains(&[asked.strain])
            ),
        );
    }
    let unloaded = specimen.unloaded_bonds();
    if unloaded > 0 {
        report.warn(
            "unloaded_bonds",
            format!(
                "{unloaded} bonds do not lie between the two jaws; they carry no load and are \
                 not strained"
            ),
        );
    }
    let largest = state
        .points
        .iter()
        .position(|point| point.force >= state.max_force);
    // where the pull ended at the largest force
    let is_cut = largest.is_some_and(|peak| {
        let next = state.points.get(peak + 1);
        next.is_none_or(|next| next.is_unloading && !state.points[peak].is_unloading)
    });
    let has_turned = stop_reason == StopReason::HistoryFinished;
    let is_whole_way = has_turned || stop_reason == StopReason::MaxStrain;
    if spec.test.breaking != Breaking::None && is_whole_way && is_cut {
        let end = if has_turned {
            "the pull ended"
        } else {
            "the largest strain was reached"
        };
        report.warn(
            "maximum_at_end",
            format!(
                "the force was still at its maximum when {end}; strength and strain at maximum force \
                 are lower bounds"
            ),
        );
    }
}

/// A list of strains in words.
fn strains(strains: &[f64]) -> String {
    let listed = strains.iter().take(LISTED_STRAINS);
    let listed: Vec<String> = listed.map(|strain| format!("{strain:.6}")).collect();
    let listed = listed.join(", ");
    match strains.len() {
        1 => format!("a nominal strain of {listed}"),
        count if count <= LISTED_STRAINS => format!("nominal strains of {listed}"),
        count => format!("{count} nominal strains, first {listed}"),
    }
}

fn count_work(report: &mut ReportBuilder, work: &Work) {
    for (name, count) in [
        ("bond_evaluations", work.bond_evaluations),
        ("equilibria", work.equilibria),
        ("newton_iterations", work.newton_iterations),
        (
            "conjugate_gradient_iterations",
            work.conjugate_gradient_iterations,
        ),
        ("sweeps", work.sweeps),
    ] {
        report.work(name, count);
    }
}
