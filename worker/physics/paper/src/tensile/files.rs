//! Files of a test of a fibre: its curve, its tube in pictures.
use loadframe_harness::vtk::{Array, Lines, Series};
use std::io;

use loadframe_harness::{Halt, Recorder, csv};

use super::fibre::{Picture, Specimen};
use crate::fibre::Sort;

/// Writes all files.
pub(super) fn write(
    specimen: &Specimen<'_>,
    curve: &[Vec<f64>],
    pictures: &[Picture],
    recorder: &mut dyn Recorder,
) -> Result<(), Halt> {
    recorder.file("curve.csv", &mut |out| {
        csv::header(out, specimen.columns())?;
        curve.iter().try_for_each(|point| csv::row(out, point))
    })?;
    write_pictures(specimen, pictures, recorder)?;
    Ok(())
}

/// Writes the tube in these states, and the series of them.
pub(super) fn write_pictures(
    specimen: &Specimen<'_>,
    pictures: &[Picture],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    if pictures.is_empty() {
        return Ok(());
    }
    let ends: Vec<[u32; 2]> = specimen
        .springs()
        .iter()
        .map(|spring| spring.points)
        .collect();
    let sorts: Vec<i32> = specimen
        .springs()
        .iter()
        .map(|spring| number(spring.sort))
        .collect();
    let stiffness = specimen
        .springs()
        .iter()
        .map(|spring| spring.stiffness_mn_per_um);
    let stiffness: Vec<f64> = stiffness.collect();
    let coarseness = specimen.pulp.coarseness_mg_per_m(&specimen.section);
    let masses = specimen.tube.masses_ug(coarseness);
    let mut entries = Vec::with_capacity(pictures.len());
    for picture in pictures {
        let name = format!("snapshots/tube_{:05}.vtp", picture.step);
        // mN is 10⁻³ N
        let forces: Vec<f64> = picture
            .tensions_mn
            .iter()
            .map(|tension| 1e-3 * tension)
            .collect();
        let lines = Lines {
            points: &picture.points_um,
            ends: &ends,
            point_data: &[
                Array::vectors("displacement_um", &picture.displacements_um),
                Array::scalars("mass_ug", &masses),
            ],
            cell_data: &[
                Array::scalars("force_n", &forces),
                Array::scalars("stiffness_mn_per_um", &stiffness),
                Array::indices("sort", &sorts),
            ],
        };
        recorder.file(&name, &mut |out| lines.write(out))?;
        entries.push((picture.at, name));
    }
    let series = Series { entries };
    recorder.file("snapshots.pvd", &mut |out| series.write(out))?;
    Ok(())
}

/// Sorts of springs in pictures, as the guide lists them.
fn number(sort: Sort) -> i32 {
    match sort {
        Sort::Along => 0,
        Sort::Around => 1,
        Sort::Diagonal => 2,
        Sort::Across => 3,
        Sort::Second => 4,
    }
}
