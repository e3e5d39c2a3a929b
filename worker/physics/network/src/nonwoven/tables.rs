//! The tables a test leaves behind.
use std::io::{self, Write};

use loadframe_api::spec::nonwoven_tensile::{CURVE_COLUMNS, HISTORY_COLUMNS, NonwovenTensile};
use loadframe_harness::{Recorder, csv};

use super::{
    cycles, snapshot,
    specimen::Specimen,
    spectrum,
    state::{HistogramBin, Point, State},
};

/// Columns of the curve.
pub(super) fn columns(spec: &NonwovenTensile, has_width: bool) -> Vec<&'static str> {
    let mut columns = CURVE_COLUMNS[..CURVE_COLUMNS.len() - 2 * usize::from(!has_width)].to_vec();
    if !spec.test.history.is_empty() {
        columns.splice(AFTER_FORCE..AFTER_FORCE, HISTORY_COLUMNS);
    }
    columns
}

/// Place of the columns of a history.
const AFTER_FORCE: usize = 2;

/// A point in the order of the columns.
pub(super) fn values(spec: &NonwovenTensile, point: &Point) -> Vec<f64> {
    let mut values = vec![
        point.nominal_strain,
        point.force,
        point.bottom_force,
        point.broken as f64,
        point.residual_ratio,
        f64::from(point.rounds),
        point.stored_energy,
    ];
    values.extend(point.width_strain);
    values.extend(point.poisson_ratio());
    if !spec.test.history.is_empty() {
        values.splice(AFTER_FORCE..AFTER_FORCE, history(point));
    }
    values
}

/// The columns of a history.
fn history(point: &Point) -> [f64; 2] {
    [
        f64::from(point.cycle),
        f64::from(u8::from(point.is_unloading)),
    ]
}

/// Gives all tables to the recorder.
pub(super) fn write(
    spec: &NonwovenTensile,
    specimen: &Specimen,
    state: &State,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    recorder.file("curve.csv", &mut |out| {
        csv::header(out, &columns(spec, specimen.width_gauge.is_some()))?;
        let mut points = state.points.iter();
        points.try_for_each(|point| csv::row(out, &values(spec, point)))
    })?;
    recorder.file("curve_machine.csv", &mut |out| {
        machine_curve(out, spec, specimen, state)
    })?;
    if specimen.width_gauge.is_some() {
        recorder.file("poisson_ratio.csv", &mut |out| poisson_ratio(out, state))?;
    }
    if !spec.test.history.is_empty() {
        let cycles = cycles::all(spec, state);
        recorder.file("loops.csv", &mut |out| cycles::write(out, &cycles))?;
    }
    recorder.file("events.csv", &mut |out| events(out, state))?;
    spectrum::write(spec, state, recorder)?;
    if !spec.output.force_distribution_strains.is_empty() {
        recorder.file("force_distribution.csv", &mut |out| {
            histogram(out, &state.force_distribution)
        })?;
    }
    if !state.snapshots.is_empty() {
        recorder.file("force_histogram.csv", &mut |out| {
            histogram(out, &state.histogram)
        })?;
        recorder.file("snapshots.pvd", &mut |out| {
            snapshot::series(out, spec, state)
        })?;
    }
    Ok(())
}

/// The curve in the column order of testing machines; the jaw has one speed on the way out and back.
fn machine_curve(
    out: &mut dyn Write,
    spec: &NonwovenTensile,
    specimen: &Specimen,
    state: &State,
) -> io::Result<()> {
    let has_history = !spec.test.history.is_empty();
    let mut columns = vec!["time_s", "displacement_mm", "force_n", "nominal_strain"];
    if has_history {
        columns.extend(HISTORY_COLUMNS);
    }
    csv::header(out, &columns)?;
    let speed_mm_per_s = spec.test.speed_mm_per_min / 60.0;
    // where the jaw turned last, how far it had gone by then, and which way it goes
    let (mut turn, mut gone, mut last) = (0.0_f64, 0.0, (0.0_f64, false));
    for point in &state.points {
        let displacement = point.nominal_strain * specimen.gauge_length;
        if point.is_unloading != last.1 {
            gone += (last.0 - turn).abs();
            turn = last.0;
        }
        last = (displacement, point.is_unloading);
        let time = (gone + (displacement - turn).abs()) / speed_mm_per_s;
        let mut row = vec![time, displacement, point.force, point.nominal_strain];
        if has_history {
            row.extend(history(point));
        }
        csv::row(out, &row)?;
    }
    Ok(())
}

/// Lateral contraction from the first strained step on: the secant ratio −ε_x/ε_y, and the tangent
/// ratio −Δε_x/Δε_y since the step before, which the secant hides.
fn poisson_ratio(out: &mut dyn Write, state: &State) -> io::Result<()> {
    csv::header(
        out,
        &[
            "nominal_strain",
            "width_strain",
            "poisson_ratio",
            "tangent_poisson_ratio",
        ],
    )?;
    for pair in state.points.windows(2) {
        let [before, point] = pair else { continue };
        if point.nominal_strain <= before.nominal_strain {
            // a fall of the force at one strain, or the way back
            continue;
        }
        let (Some(width_before), Some(width), Some(ratio)) = (
            before.width_strain,
            point.width_strain,
            point.poisson_ratio(),
        ) else {
            continue;
        };
        let tangent = (width_before - width) / (point.nominal_strain - before.nominal_strain);
        csv::row(out, &[point.nominal_strain, width, ratio, tangent])?;
    }
    Ok(())
}

fn events(out: &mut dyn Write, state: &State) -> io::Result<()> {
    let columns = [
        "step",
        "round",
        "nominal_strain",
        "bond",
        "force_n",
        "energy_released_n_mm",
    ];
    csv::header(out, &columns)?;
    for event in &state.events {
        let numbers = [
            event.step as f64,
            f64::from(event.round),
            event.nominal_strain,
            f64::from(event.bond),
            event.force,
            event.energy,
        ];
        csv::row(out, &numbers)?;
    }
    Ok(())
}

fn histogram(out: &mut dyn Write, bins: &[HistogramBin]) -> io::Result<()> {
    csv::header(
        out,
        &["nominal_strain", "bin_lower_n", "bin_upper_n", "bonds"],
    )?;
    for bin in bins {
        let numbers = [bin.nominal_strain, bin.lower, bin.upper, bin.bonds as f64];
        csv::row(out, &numbers)?;
    }
    Ok(())
}
