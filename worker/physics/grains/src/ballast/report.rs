//! Results of a test of ballast.
use loadframe_api::{Report, spec::ballast::Course};
use loadframe_harness::ReportBuilder;

use super::{
    blocks::Block,
    cycles::Cycle,
    heard::{Heard, Row},
    moments::Moments,
    oedometer::Oedometer,
};

/// The scene's report with the results of the test before its own.
pub(super) fn report(
    heard: &Heard<'_>,
    scene: Report,
    cycles: &[Cycle],
    oedometer: Option<&Oedometer>,
    moments: &Moments,
) -> Report {
    let mut report = ReportBuilder::new("cycles_done");
    let (first, last) = (cycles.first(), cycles.last());
    let of = |cycle: Option<&Cycle>, value: fn(&Cycle) -> f64| cycle.map_or(f64::NAN, value);
    report.result(
        "unloading_stiffness",
        of(first, |cycle| cycle.unloading_stiffness.unwrap_or(f64::NAN)),
        "N/m",
        "Slope of the unloading branch of the first cycle, between 90 and 50 % of its peak force; unknown where the bed creeps on.",
    );
    report.result(
        "peak_displacement",
        1e3 * of(first, |cycle| cycle.peak),
        "mm",
        "Way of plate or sleeper at its deepest in the first cycle.",
    );
    report.result(
        "peak_displacement_from_set_down",
        1e3 * (heard.set_down - heard.loading().1.1 + of(first, |cycle| cycle.peak)),
        "mm",
        "The same from where plate or sleeper was set down: with what compaction, its weight and the smallest force did.",
    );
    report.result(
        "residual_displacement",
        1e3 * of(first, |cycle| cycle.end),
        "mm",
        "Way that is left after the first cycle.",
    );
    if cycles.len() > 1 {
        report.count("cycles", cycles.len(), "Cycles of loading.");
        report.result(
            "last_cycle_displacement",
            1e3 * of(last, |cycle| cycle.peak - cycle.start),
            "mm",
            "Way down within the last cycle.",
        );
        report.result(
            "settlement",
            1e3 * of(last, |cycle| cycle.end),
            "mm",
            "Way that is left after the last cycle.",
        );
        report.result(
            "last_unloading_stiffness",
            of(last, |cycle| cycle.unloading_stiffness.unwrap_or(f64::NAN)),
            "N/m",
            "The same slope in the last cycle.",
        );
    }
    let blocks = Block::of(cycles);
    if blocks.len() > 1 {
        for (number, block) in (1..).zip(&blocks) {
            report.result(
                &format!("settlement_after_block_{number}"),
                1e3 * block.end,
                "mm",
                "Way that is left after the cycles of this block.",
            );
            report.result(
                &format!("unloading_stiffness_of_block_{number}"),
                block.unloading_stiffnesses[1].unwrap_or(f64::NAN),
                "N/m",
                "Slope of the unloading branch in the last cycle of this block.",
            );
        }
    }
    if heard.script.rail.is_some() {
        let tilt = |row: Option<&Row>| row.and_then(Row::tilt).unwrap_or(f64::NAN);
        for (name, row, words) in [
            (
                "tilt_before_loading",
                heard.last_before_loading(),
                "Angle between the sleeper's top and the level before the cycles.",
            ),
            (
                "tilt_at_peak",
                heard.peak_row(),
                "The same at the largest force.",
            ),
            ("tilt_at_end", heard.rows.last(), "The same at the end."),
        ] {
            report.result(name, tilt(row), "rad", words);
        }
    }
    report.result(
        "peak_force",
        of(first, |cycle| cycle.peak_force),
        "N",
        "Largest force of the bed on plate or sleeper in the first cycle, without its weight.",
    );
    if let Some(oedometer) = oedometer {
        report.result(
            "initial_height",
            1e3 * oedometer.height,
            "mm",
            "Height of the bed before the cycles.",
        );
        report.result(
            "initial_void_ratio",
            oedometer.void_ratio,
            "1",
            "Void ratio before the cycles.",
        );
        let porosity = oedometer.void_ratio / (1.0 + oedometer.void_ratio);
        report.result(
            "initial_porosity",
            porosity,
            "1",
            "Porosity before the cycles.",
        );
        let mut loading = oedometer.steps.iter().rev();
        let modulus = loading.find(|step| step.is_loading);
        report.result(
            "oedometric_modulus",
            modulus.map_or(f64::NAN, |step| step.modulus),
            "Pa",
            "Of the last step of loading, from half the peak stress to the peak.",
        );
        let height = heard.rows.last().map_or(f64::NAN, |row| row.height);
        let ratio = super::oedometer::void_ratio(heard, height);
        report.result(
            "porosity",
            ratio / (1.0 + ratio),
            "1",
            "Porosity at the end.",
        );
    } else {
        let porosity = |row: Option<&Row>| row.map_or(f64::NAN, |row| heard.bed_porosity(row));
        report.result(
            "initial_porosity",
            porosity(heard.last_before_loading()),
            "1",
            "Porosity under the sleeper before the cycles.",
        );
        report.result(
            "porosity",
            porosity(heard.rows.last()),
            "1",
            "Porosity under the sleeper at the end.",
        );
    }
    // grains of fewer members have no such pieces
    let has_large = (moments.shares().next()).is_some_and(|(_, [_, large, _])| large > 0.0);
    for (moment, [single, large, whole]) in moments.shares() {
        report.result(
            &format!("mass_in_single_spheres_{moment}"),
            single,
            "1",
            "Share of the mass of breakable grains that is single spheres.",
        );
        report.result(
            &format!("mass_in_whole_grains_{moment}"),
            whole,
            "1",
            "Share of the mass of breakable grains that is grains of which nothing broke off.",
        );
        if has_large {
            report.result(
                &format!("mass_from_135_spheres_{moment}"),
                large,
                "1",
                "Share of the mass of breakable grains that is pieces of 135 spheres and more.",
            );
        }
    }
    if let Some(detail) = not_reached(heard) {
        report.warn("load_not_reached", detail);
    }
    let Report {
        stop_reason,
        mut summary,
        warnings,
        ..
    } = report.finish();
    for (name, quantity) in scene.summary {
        summary.entry(name).or_insert(quantity);
    }
    Report {
        stop_reason,
        summary,
        warnings: [warnings, scene.warnings].concat(),
        // told by the tables
        bodies: Vec::new(),
        ..scene
    }
}

/// Part of a force at which a machine has come to it: its last row is told from where the wall was at rest.
const REACHED: f64 = 0.99;

/// Cycles in which a machine turned before it had come to its force.
fn not_reached(heard: &Heard<'_>) -> Option<String> {
    let short = heard.script.loads.iter().filter_map(|(stage, load)| {
        let Course::Down { force } = load.course else {
            return None;
        };
        let rows = heard.rows.iter().filter(|row| row.stage == *stage);
        let largest = rows.map(|row| row.force).fold(f64::NEG_INFINITY, f64::max);
        (largest < REACHED * force).then_some((load.cycle + 1, largest, force))
    });
    let short: Vec<_> = short.collect();
    let (cycle, largest, force) = short.first()?;
    Some(format!(
        "in {} of its cycles the machine turned before it had come to its force, first in cycle {cycle} \
         at {:.3e} of {:.3e} kN: give it more /test/largest_displacement_m, or it is the most the bed \
         carries",
        short.len(),
        1e-3 * largest,
        1e-3 * force,
    ))
}
