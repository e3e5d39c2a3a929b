//! The tables that the test of a sheet leaves behind.
use std::io;

use loadframe_api::spec::paper_tensile::SHEET_CURVE;
use loadframe_harness::{Recorder, csv};

use super::course::{Kept, Mode};
use super::specimen::Specimen;
use crate::frame::{Bore, Broken};

/// mN in N, nJ in N mm, GPa in MPa, µm in mm.
const N: f64 = 1e-3;
const N_MM: f64 = 1e-6;
const MPA: f64 = 1e3;
const MM: f64 = 1e-3;

/// Columns of the breaks; the first six mean what they mean for nonwovens.
const EVENTS: [&str; 13] = [
    "step",
    "round",
    "nominal_strain",
    "bond",
    "force_n",
    "energy_released_n_mm",
    "mode",
    "normal_force_n",
    "shear_force_n",
    "fibre",
    "segment",
    "stress_mpa",
    "jaw_force_after_n",
];

/// Gives all tables to the recorder.
pub(super) fn write(
    specimen: &Specimen,
    kept: &Kept,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    recorder.file("curve.csv", &mut |out| {
        csv::header(out, &SHEET_CURVE)?;
        kept.points
            .iter()
            .try_for_each(|point| csv::row(out, point))
    })?;
    recorder.file("events.csv", &mut |out| {
        csv::header(out, &EVENTS)?;
        events(specimen, kept).try_for_each(|row| csv::row(out, &row))
    })?;
    let Some(lengths) = specimen.laid.as_ref().and_then(|laid| laid.lengths()) else {
        return Ok(());
    };
    recorder.file("fibre_lengths.csv", &mut |out| {
        let columns = [
            "length_from_mm",
            "length_to_mm",
            "share_by_number",
            "share_by_length",
        ];
        csv::header(out, &columns)?;
        let bins = lengths.by_number.len();
        let edge = |bin: usize| MM * lengths.upper * bin as f64 / bins as f64;
        let shares = lengths.by_number.iter().zip(&lengths.by_length);
        for (bin, (by_number, by_length)) in shares.enumerate() {
            csv::row(out, &[edge(bin), edge(bin + 1), *by_number, *by_length])?;
        }
        Ok(())
    })
}

/// What is not of the part that broke is not a number, and an empty cell.
fn events<'a>(
    specimen: &'a Specimen,
    kept: &'a Kept,
) -> impl Iterator<Item = [f64; EVENTS.len()]> + 'a {
    const NONE: f64 = f64::NAN;
    kept.records.iter().map(|record| {
        let event = &record.event;
        let (bond, fibre, segment) = match event.broken {
            Broken::Bond(bond) => (bond as f64, NONE, NONE),
            Broken::Segment(segment) => {
                let fibre = specimen.network.segment_fibre(segment);
                let first = specimen.network.first_segment(fibre);
                (NONE, fibre as f64, (segment - first) as f64)
            }
        };
        let (force, normal, shear, stress) = match event.bore {
            Bore::Bond {
                normal_mn,
                shear_mn,
            } => (
                N * normal_mn.hypot(shear_mn),
                N * normal_mn,
                N * shear_mn,
                NONE,
            ),
            Bore::Segment { stress_gpa } => (NONE, NONE, NONE, MPA * stress_gpa),
        };
        let mode = record
            .bond()
            .and_then(|bond| specimen.mode(bond, event.bore));
        [
            f64::from(event.avalanche),
            f64::from(record.round),
            event.strain,
            bond,
            force,
            N_MM * event.energy_released_nj,
            number(mode),
            normal,
            shear,
            fibre,
            segment,
            stress,
            N * event.force_after_mn,
        ]
    })
}

/// Modes in tables and pictures, as the guide lists them: 1 opened, 2 sheared, 3 a fibre.
pub(super) fn number(mode: Option<Mode>) -> f64 {
    match mode {
        Some(Mode::Opened) => 1.0,
        Some(Mode::Sheared) => 2.0,
        None => 3.0,
    }
}
