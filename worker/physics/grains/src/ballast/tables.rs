//! The files of a test.
use std::io;

use loadframe_harness::{Recorder, csv};

use super::{
    blocks::Block,
    cycles::Cycle,
    heard::{Heard, Row},
    moments::Moments,
    oedometer::Oedometer,
};
use crate::output::fragments;

/// A row of the curve; `start` is where the cycles begin, time [s] and height [m].
pub(super) fn curve_row(heard: &Heard<'_>, row: &Row, start: (f64, f64)) -> Vec<f64> {
    let place = row.place.unwrap_or_default();
    let mut values = vec![
        row.time - start.0,
        1e-3 * row.force,
        1e3 * row.displacement(start.1),
        (place.cycle + 1) as f64,
        f64::from(u8::from(place.is_unloading)),
        row.inertial_number,
        row.unbalanced,
        row.coordination,
        1e-3 * row.mean_stress,
        row.step_ratio,
        1e3 * row.displacement(row.cycle_start),
        1e3 * (row.height - row.lowest),
        heard.bed_porosity(row),
    ];
    values.extend(row.stress.map(|stress| 1e-3 * stress));
    let [xx, yy, zz, ..] = row.stress;
    values.push(0.5 * (xx + yy) / zz);
    values.push(1e3 * row.displacement(heard.set_down));
    values.extend(row.on_walls.map(|force| 1e-3 * force));
    if let (Some(tilt), Some([x, y, _])) = (row.tilt(), row.turn) {
        values.extend([tilt, x, y]);
    }
    values.extend(row.broken_bonds);
    values
}

/// Writes all tables, and the scene.
pub(super) fn write(
    heard: &Heard<'_>,
    cycles: &[Cycle],
    oedometer: Option<&Oedometer>,
    moments: &Moments,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let script = heard.script;
    let (rows, start) = heard.loading();
    let rows: Vec<Vec<f64>> = rows.map(|row| curve_row(heard, row, start)).collect();
    table(recorder, "curve.csv", &script.columns(), &rows)?;
    let rows: Vec<Vec<f64>> = (1..)
        .zip(cycles)
        .map(|(number, cycle)| cycle.row(number))
        .collect();
    table(recorder, "cycles.csv", &CYCLE_COLUMNS, &rows)?;
    let blocks = Block::of(cycles);
    if blocks.len() > 1 {
        let rows = (1..).zip(&blocks);
        let rows: Vec<Vec<f64>> = rows.map(|(number, block)| block.row(number)).collect();
        table(recorder, "blocks.csv", &Block::COLUMNS, &rows)?;
    }
    write_preparation(heard, recorder)?;
    write_profile(heard, recorder)?;
    if let Some(oedometer) = oedometer {
        write_oedometer(oedometer, recorder)?;
    }
    if script.is_breakable() {
        write_fragments(moments, recorder)?;
    }
    recorder.file("scene.json", &mut |out| {
        let job = serde_json::json!({"kind": "granular_scene", "spec": script.scene});
        serde_json::to_writer(&mut *out, &job)?;
        writeln!(out)
    })
}

pub(super) fn table(
    recorder: &mut dyn Recorder,
    name: &str,
    columns: &[&str],
    rows: &[Vec<f64>],
) -> io::Result<()> {
    recorder.file(name, &mut |out| {
        csv::header(out, columns)?;
        rows.iter().try_for_each(|row| csv::row(out, row))
    })
}

const CYCLE_COLUMNS: [&str; 9] = [
    "cycle",
    "start_displacement_mm",
    "peak_displacement_mm",
    "end_displacement_mm",
    "settlement_in_cycle_mm",
    "peak_force_kn",
    "unloading_stiffness_n_per_m",
    "loading_stiffness_n_per_m",
    "dissipated_energy_j",
];

impl Cycle {
    fn row(&self, number: usize) -> Vec<f64> {
        vec![
            number as f64,
            1e3 * self.start,
            1e3 * self.peak,
            1e3 * self.end,
            1e3 * (self.end - self.start),
            1e-3 * self.peak_force,
            self.unloading_stiffness.unwrap_or(f64::NAN),
            self.loading_stiffness.unwrap_or(f64::NAN),
            self.dissipated,
        ]
    }
}

/// The state of the bed at the end of every stage. Phases are words, so that this table is written
/// by itself.
pub(super) fn write_preparation(heard: &Heard<'_>, recorder: &mut dyn Recorder) -> io::Result<()> {
    let mut text =
        "stage,phase,time_s,bed_porosity,coordination_number,unbalanced_force_ratio\n".to_owned();
    for (stage, phase) in heard.script.phases.iter().enumerate() {
        let mut rows = heard.rows.iter().rev();
        let Some(row) = rows.find(|row| row.stage == stage) else {
            continue;
        };
        let porosity = heard.bed_porosity(row);
        let line = format!(
            "{},{},{},{porosity},{},{}\n",
            stage + 1,
            phase.name(),
            row.time,
            row.coordination,
            row.unbalanced
        );
        text.push_str(&line);
    }
    recorder.file("preparation.csv", &mut |out| out.write_all(text.as_bytes()))
}

/// Porosity over height before the cycles, at the largest force and at the end.
fn write_profile(heard: &Heard<'_>, recorder: &mut dyn Recorder) -> io::Result<()> {
    let moments = [
        heard.last_before_loading(),
        heard.peak_row(),
        heard.rows.last(),
    ];
    let moments = moments.map(|row| row.map(|row| heard.porosities(row)));
    let slices = heard.script.slices.iter();
    let rows: Vec<Vec<f64>> = slices
        .enumerate()
        .map(|(index, slice)| {
            let porosities = moments.iter().map(|moment| match moment {
                Some(porosities) => porosities[index],
                None => f64::NAN,
            });
            slice.heights.into_iter().chain(porosities).collect()
        })
        .collect();
    let columns = [
        "lower_m",
        "upper_m",
        "porosity_before_loading",
        "porosity_at_peak",
        "porosity_at_end",
    ];
    table(recorder, "porosity_profile.csv", &columns, &rows)
}

fn write_oedometer(oedometer: &Oedometer, recorder: &mut dyn Recorder) -> io::Result<()> {
    let path: Vec<Vec<f64>> = oedometer
        .path
        .iter()
        .map(|[stress, strain, ratio]| {
            vec![1e-3 * stress, stress.abs().log10() - 3.0, *strain, *ratio]
        })
        .collect();
    let columns = [
        "stress_kpa",
        "log10_stress_over_kpa",
        "axial_strain",
        "void_ratio",
    ];
    table(recorder, "oedometer.csv", &columns, &path)?;
    let steps: Vec<Vec<f64>> = oedometer
        .steps
        .iter()
        .map(|step| {
            vec![
                f64::from(u8::from(!step.is_loading)),
                1e-3 * step.stresses[0],
                1e-3 * step.stresses[1],
                step.void_ratios[0],
                step.void_ratios[1],
                1e-6 * step.modulus,
            ]
        })
        .collect();
    let columns = [
        "unloading",
        "from_stress_kpa",
        "to_stress_kpa",
        "from_void_ratio",
        "to_void_ratio",
        "oedometric_modulus_mpa",
    ];
    table(recorder, "oedometric_modulus.csv", &columns, &steps)
}

/// Shares of mass by size of fragment when the bed was poured, before the cycles, at the largest
/// force and at the end.
fn write_fragments(moments: &Moments, recorder: &mut dyn Recorder) -> io::Result<()> {
    let Moments(rows) = moments;
    recorder.file("fragment_moments.csv", &mut |out| {
        write!(out, "moment,")?;
        csv::header(out, &fragments::COLUMNS)?;
        rows.iter().try_for_each(|(moment, row)| {
            write!(out, "{moment},")?;
            csv::row(out, &row.numbers())
        })
    })
}
