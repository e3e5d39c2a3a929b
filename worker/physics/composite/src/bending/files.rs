//! Files of a test: displacements of points and faces, convergence, pictures.
use loadframe_harness::vtk::{Array, Lines, Polygons, Series};
use loadframe_harness::{Recorder, SimulationError, csv};

use super::Recorded;
use super::errors::Finding;
use super::model::{Fineness, Model};
use super::results::{self, Measured, Tested};
use crate::lattice::{Geometry, gather};
use crate::measure::{mean_gradient, point_mm};
use crate::supports::Face;

/// The largest displacement in pictures over the smaller side, unless a factor is asked for.
const SHOWN: f64 = 0.1;

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
        csv::header(out, results::columns(model))?;
        points.iter().try_for_each(|point| csv::row(out, point))
    })?;
    write_points(model, tested, recorder)?;
    write_faces(model, tested, recorder)?;
    write_convergence(model, measured, finding, recorder)?;
    if model.spec.output.picture {
        write_pictures(model, tested, recorder)?;
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
    let others = others.map(|(fineness, values)| {
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

/// Displacements in pictures over true ones.
pub(super) fn factor(model: &Model<'_>, tested: &Tested) -> f64 {
    model.spec.output.deformation_factor.unwrap_or_else(|| {
        let largest = tested
            .displacements_mm()
            .chunks_exact(2)
            .map(|u| u[0].hypot(u[1]))
            .fold(0.0, f64::max);
        let side = model
            .spec
            .section
            .length_mm
            .min(model.spec.section.height_mm);
        if largest > 0.0 {
            SHOWN * side / largest
        } else {
            1.0
        }
    })
}

/// The deformed section as cells with stress and strain, and as bonds with their forces.
fn write_pictures(
    model: &Model<'_>,
    tested: &Tested,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let grid = model.lattice.grid();
    let u = tested.displacements_mm();
    let factor = factor(model, tested);
    let place = |particle: usize| {
        let [x, y] = grid.place_mm(particle);
        [
            x + factor * u[2 * particle],
            y + factor * u[2 * particle + 1],
            0.0,
        ]
    };
    let cells = grid.cells();
    let mut points = Vec::with_capacity(4 * cells);
    let mut displacement = Vec::with_capacity(12 * cells);
    let mut strain = [const { Vec::new() }; 3];
    for cell in 0..cells {
        let corners = grid.corners(cell);
        for particle in corners {
            points.push(place(particle));
            displacement.extend([u[2 * particle], u[2 * particle + 1], 0.0]);
        }
        let [[xx, xy], [yx, yy]] = mean_gradient(grid.sides_mm(cell), &gather(u, corners));
        for (all, one) in strain.iter_mut().zip([xx, yy, xy + yx]) {
            all.push(one);
        }
    }
    let mut data = vec![
        Array::scalars("fibre_share", model.layout.fibre_share()),
        Array::scalars("strain_xx", &strain[0]),
        Array::scalars("strain_yy", &strain[1]),
        Array::scalars("strain_xy", &strain[2]),
    ];
    let stresses = stresses(model, u);
    if let Some(stresses) = &stresses {
        let names = [
            "stress_xx_mpa",
            "stress_yy_mpa",
            "stress_xy_mpa",
            "stress_mises_mpa",
        ];
        data.extend(
            names
                .iter()
                .zip(stresses)
                .map(|(name, values)| Array::scalars(name, values)),
        );
    }
    let polygons = Polygons {
        points: &points,
        corners: &vec![4; cells],
        point_data: &[Array::vectors("displacement_mm", &displacement)],
        cell_data: &data,
    };
    recorder.file("snapshots/section.vtp", &mut |out| polygons.write(out))?;

    let (ends, forces) = bonds(model, u);
    let particles: Vec<[f64; 3]> = (0..grid.particles()).map(place).collect();
    let lines = Lines {
        points: &particles,
        ends: &ends,
        point_data: &[],
        cell_data: &[Array::scalars("force_n", &forces)],
    };
    recorder.file("snapshots/bonds.vtp", &mut |out| lines.write(out))?;
    let series = Series {
        entries: vec![(1.0, "snapshots/section.vtp".to_owned())],
    };
    recorder.file("snapshots.pvd", &mut |out| series.write(out))?;
    Ok(())
}

/// σ_xx, σ_yy, σ_xy and the equivalent stress of [vonMises1913] in plane stress, cell by cell; `None`
/// in the paper's lattice, whose cells have none.
fn stresses(model: &Model<'_>, u: &[f64]) -> Option<[Vec<f64>; 4]> {
    let geometry: Geometry = model.geometry();
    let mut all = [const { Vec::new() }; 4];
    for cell in 0..model.lattice.grid().cells() {
        let [xx, yy, xy] = model.lattice.stress(geometry, cell, u)?;
        let mises = (xx * xx - xx * yy + yy * yy + 3.0 * xy * xy).sqrt();
        for (all, one) in all.iter_mut().zip([xx, yy, xy, mises]) {
            all.push(one);
        }
    }
    Some(all)
}

/// Bonds by their particles, and their forces [N].
fn bonds(model: &Model<'_>, u: &[f64]) -> (Vec<[u32; 2]>, Vec<f64>) {
    let grid = model.lattice.grid();
    let geometry = model.geometry();
    let mut ends = Vec::new();
    let mut forces = Vec::new();
    let Some(found) = model.lattice.bond_forces_in_cells(geometry, u) else {
        for bond in model.lattice.bonds() {
            ends.push(bond.particles);
            forces.push(bond.tension_n(geometry, u));
        }
        return (ends, forces);
    };
    let (columns, rows) = (grid.columns(), grid.rows());
    let particle = |i: usize, j: usize| grid.particle(i, j) as u32;
    for j in 0..=rows {
        for i in 0..columns {
            ends.push([particle(i, j), particle(i + 1, j)]);
        }
    }
    forces.extend(found.along_x);
    for j in 0..rows {
        for i in 0..=columns {
            ends.push([particle(i, j), particle(i, j + 1)]);
        }
    }
    forces.extend(found.along_y);
    for (cell, [rising, falling]) in found.diagonals.into_iter().enumerate() {
        let corners = grid.corners(cell).map(|corner| corner as u32);
        ends.extend([[corners[0], corners[2]], [corners[3], corners[1]]]);
        forces.extend([rising, falling]);
    }
    (ends, forces)
}
