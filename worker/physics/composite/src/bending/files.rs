//! Tables of a test: displacements of points and faces, convergence, events.
use loadframe_harness::{Recorder, SimulationError, csv};

use super::beam_line;
use super::comparison::Fineness;
use super::errors::Finding;
use super::measured::Measured;
use super::model::Model;
use super::pictures;
use super::tested::{Broken, Tested};
use super::watch::Recorded;
use crate::breaking::{BrokenPart, Mode};
use crate::measure::point_mm;
use crate::supports::Face;

/// Writes all files.
pub(super) fn write(
    model: &Model<'_>,
    tested: &Tested,
    measured: &[Measured],
    finding: &Finding,
    recorded: &mut Recorded<'_, '_>,
) -> Result<(), SimulationError> {
    let (points, recorder) = (&recorded.points, &mut *recorded.recorder);
    recorder.file("curve.csv", &mut |out| {
        csv::header(out, model.spec.columns())?;
        points.iter().try_for_each(|point| csv::row(out, point))
    })?;
    write_points(model, tested, recorder)?;
    write_faces(model, tested, recorder)?;
    beam_line::write(model, tested, recorder)?;
    write_convergence(model, measured, finding, recorder)?;
    if let Some(broken) = &tested.broken {
        write_events(model, broken, recorder)?;
    }
    if model.spec.output.picture {
        pictures::write(model, tested, recorder)?;
    }
    Ok(())
}

fn write_points(
    model: &Model<'_>,
    tested: &Tested,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let mut rows = Vec::with_capacity(model.spec.probes_mm.len());
    for &point in &model.spec.probes_mm {
        let [x, y] = point_mm(model.lattice.grid(), point, tested.displacements_mm())?;
        rows.push([point[0], point[1], x, y]);
    }
    if rows.is_empty() {
        return Ok(());
    }
    recorder.file("points.csv", &mut |out| {
        csv::header(out, &["x_mm", "y_mm", "ux_mm", "uy_mm"])?;
        rows.iter().try_for_each(|row| csv::row(out, row))
    })?;
    Ok(())
}

/// Displacements of all particles of the four faces, each along the face.
fn write_faces(
    model: &Model<'_>,
    tested: &Tested,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let grid = model.lattice.grid();
    let u = tested.displacements_mm();
    for (face, name) in [
        (Face::Top, "faces/top.csv"),
        (Face::Bottom, "faces/bottom.csv"),
        (Face::Left, "faces/left.csv"),
        (Face::Right, "faces/right.csv"),
    ] {
        recorder.file(name, &mut |out| {
            csv::header(out, &["along_mm", "ux_mm", "uy_mm"])?;
            for (line, along) in face.lines_mm(grid).iter().enumerate() {
                let particle = face.particle(grid, line);
                csv::row(out, &[*along, u[2 * particle], u[2 * particle + 1]])?;
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Every result on every grid that was tried, that of the test last.
fn write_convergence(
    model: &Model<'_>,
    measured: &[Measured],
    finding: &Finding,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let mut names = vec!["cells_x".to_owned(), "cells_y".to_owned()];
    names.extend(measured.iter().map(|one| csv::column(one.name, one.unit)));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let row = |fineness: &Fineness, values: &mut dyn Iterator<Item = f64>| {
        let cells = fineness.grid.cells.map(f64::from);
        cells.into_iter().chain(values).collect::<Vec<f64>>()
    };
    let grids = model.comparison().grids(model.fineness);
    let others = grids.iter().zip(&finding.others).rev();
    // nothing is known of a grid that is too coarse to crack
    let known = others.filter(|(_, values)| !values.is_empty());
    let others = known.map(|(fineness, values)| {
        let mut values = measured.iter().map(|one| Finding::of(values, one.name));
        row(fineness, &mut values)
    });
    let mut rows: Vec<Vec<f64>> = others.collect();
    rows.push(row(
        &model.fineness,
        &mut measured.iter().map(|one| one.value),
    ));
    recorder.file("convergence.csv", &mut |out| {
        csv::header(out, &names)?;
        rows.iter().try_for_each(|row| csv::row(out, row))
    })?;
    Ok(())
}

/// Every event of a test that breaks.
fn write_events(
    model: &Model<'_>,
    broken: &Broken,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let grid = model.lattice.grid();
    recorder.file("cracks.csv", &mut |out| {
        writeln!(
            out,
            "event,load_factor,displacement_mm,force_n,x_mm,y_mm,part,fibre,mode,tooth,\
             energy_released_n_mm,dissipated_n_mm,crack_area_mm2"
        )?;
        for event in &broken.events {
            let [x, y] = grid.middle_mm(event.cell);
            let (part, fibre) = match event.part {
                BrokenPart::Matrix if model.spec.plies.is_empty() => ("matrix", String::new()),
                BrokenPart::Matrix => ("ply", String::new()),
                BrokenPart::Fibre(place) => ("fibre", place.to_string()),
                BrokenPart::Interface(place) => ("interface", place.to_string()),
                BrokenPart::PlyFace(_) => ("ply_face", String::new()),
            };
            let mode = match event.mode {
                Mode::Tension => "tension",
                Mode::Compression => "compression",
                Mode::Shear => "shear",
            };
            writeln!(
                out,
                "{},{},{},{},{x},{y},{part},{fibre},{mode},{},{},{},{}",
                event.number,
                event.factor,
                event.displacement_mm,
                event.force_n,
                event.tooth,
                event.energy_released_n_mm,
                event.dissipated_n_mm,
                event.crack_area_mm2,
            )?;
        }
        Ok(())
    })?;
    Ok(())
}
