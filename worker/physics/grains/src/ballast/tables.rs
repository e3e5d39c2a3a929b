//! The files of a test.
use std::io;

use loadframe_api::spec::ballast::Script;
use loadframe_harness::csv;

use super::{
    cycles::{Cycle, place_in_cycles},
    moments::Moments,
    oedometer::Oedometer,
    tester::{Row, Tester},
};

/// Columns of the curve.
pub(super) fn curve_columns(script: &Script) -> Vec<&'static str> {
    let mut columns = vec![
        "time_s",
        "force_kn",
        "displacement_mm",
        "cycle",
        "unloading",
        "inertial_number",
        "unbalanced_force_ratio",
        "coordination_number",
        "bed_mean_stress_kpa",
        "step_over_critical",
    ];
    if script.is_breakable() {
        columns.push("broken_bonds");
    }
    columns
}

/// A row of the curve; `start` is where the cycles begin, time [s] and height [m].
pub(super) fn curve_row(script: &Script, row: &Row, start: (f64, f64)) -> Vec<f64> {
    let time = row.time - start.0;
    let (cycle, part) = place_in_cycles(script, time);
    let mut values = vec![
        time,
        1e-3 * row.force,
        1e3 * row.displacement(start.1),
        (cycle + 1) as f64,
        f64::from(u8::from(part > 0.5)),
        row.inertial_number,
        row.unbalanced,
        row.coordination,
        1e-3 * row.mean_stress,
        row.step_ratio,
    ];
    values.extend(row.broken_bonds);
    values
}

/// Writes all tables, and the scene.
pub(super) fn write(
    tester: &mut Tester<'_>,
    cycles: &[Cycle],
    oedometer: Option<&Oedometer>,
) -> io::Result<()> {
    let script = tester.script;
    let (rows, start) = tester.loading();
    let rows: Vec<Vec<f64>> = rows.map(|row| curve_row(script, row, start)).collect();
    table(tester, "curve.csv", &curve_columns(script), &rows)?;
    let rows: Vec<Vec<f64>> = (1..)
        .zip(cycles)
        .map(|(number, cycle)| cycle.row(number))
        .collect();
    table(tester, "cycles.csv", &CYCLE_COLUMNS, &rows)?;
    write_preparation(tester)?;
    write_profile(tester)?;
    if let Some(oedometer) = oedometer {
        write_oedometer(tester, oedometer)?;
    }
    if script.is_breakable() {
        write_fragments(tester)?;
    }
    tester.write("scene.json", &mut |out| {
        let job = serde_json::json!({"kind": "granular_scene", "spec": script.scene});
        serde_json::to_writer(&mut *out, &job)?;
        writeln!(out)
    })
}

fn table(
    tester: &mut Tester<'_>,
    name: &str,
    columns: &[&str],
    rows: &[Vec<f64>],
) -> io::Result<()> {
    tester.write(name, &mut |out| {
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
fn write_preparation(tester: &mut Tester<'_>) -> io::Result<()> {
    let mut text =
        "stage,phase,time_s,bed_porosity,coordination_number,unbalanced_force_ratio\n".to_owned();
    for (stage, phase) in tester.script.phases.iter().enumerate() {
        let mut rows = tester.rows.iter().rev();
        let Some(row) = rows.find(|row| row.stage == stage) else {
            continue;
        };
        let porosity = tester.bed_porosity(row);
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
    tester.write("preparation.csv", &mut |out| out.write_all(text.as_bytes()))
}

impl Tester<'_> {
    /// Volume of each slice below the loading wall at a row [m³].
    fn room(&self, row: &Row) -> impl Iterator<Item = f64> {
        let (area, height) = (self.script.loaded_area, row.height);
        let slices = self.script.slices.iter();
        slices.map(move |slice| slice.room(area, height))
    }

    /// Porosity of the slices that the bed fills at a row.
    pub(super) fn bed_porosity(&self, row: &Row) -> f64 {
        let volume: f64 = self.room(row).sum();
        let solid: f64 = self.solids(row).iter().sum();
        1.0 - solid / volume
    }

    /// Porosity of each slice at a row, unknown where the loading wall has taken all of it.
    fn porosities(&self, row: &Row) -> Vec<f64> {
        let slices = self.room(row).zip(self.solids(row));
        let porosity = |(volume, solid): (f64, &f64)| match volume > 0.0 {
            true => 1.0 - solid / volume,
            false => f64::NAN,
        };
        slices.map(porosity).collect()
    }

    /// The row of the cycles with the largest force.
    pub(super) fn peak_row(&self) -> Option<&Row> {
        let (rows, _) = self.loading();
        rows.reduce(|best, row| if row.force > best.force { row } else { best })
    }
}

/// Porosity over height before the cycles, at the largest force and at the end.
fn write_profile(tester: &mut Tester<'_>) -> io::Result<()> {
    let moments = [
        tester.last_before_loading(),
        tester.peak_row(),
        tester.rows.last(),
    ];
    let moments = moments.map(|row| row.map(|row| tester.porosities(row)));
    let slices = tester.script.slices.iter();
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
    table(tester, "porosity_profile.csv", &columns, &rows)
}

fn write_oedometer(tester: &mut Tester<'_>, oedometer: &Oedometer) -> io::Result<()> {
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
    table(tester, "oedometer.csv", &columns, &path)?;
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
    table(tester, "oedometric_modulus.csv", &columns, &steps)
}

/// Shares of mass by size of fragment when the bed was poured, before the cycles, at the largest
/// force and at the end.
fn write_fragments(tester: &mut Tester<'_>) -> io::Result<()> {
    let moments = Moments::of(tester);
    let mut text = format!("moment,{}\n", moments.header);
    for (moment, row) in moments.rows {
        text.push_str(&format!("{moment},{row}\n"));
    }
    tester.write("fragment_moments.csv", &mut |out| {
        out.write_all(text.as_bytes())
    })
}
