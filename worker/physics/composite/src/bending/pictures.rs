//! Pictures of a test: the deformed section with what its cells hold, its bonds, its open cracks.
use loadframe_harness::vtk::{Array, Lines, Polygons, Series};
use loadframe_harness::{Recorder, SimulationError};

use super::model::Model;
use super::tested::{Broken, Tested};
use crate::breaking::BrokenPart;
use crate::lattice::gather;
use crate::measure::mean_gradient;
use crate::section::{Grid, Layout};

/// The largest displacement in pictures over the smaller side, unless a factor is asked for.
const SHOWN: f64 = 0.1;

/// The section where it does not break.
const SECTION: &str = "snapshots/section.vtp";

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

/// The section before its load.
pub(super) fn write_first(
    layout: &Layout,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let shown = Shown {
        u: &vec![0.0; 2 * layout.grid().particles()],
        stresses: None,
        damage: None,
    };
    write_cells(layout, SECTION, &shown, 1.0, recorder)
}

/// The deformed section, at the moments that count.
pub(super) fn write(
    model: &Model<'_>,
    tested: &Tested,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let factor = factor(model, tested);
    let mut entries = Vec::new();
    if let Some(broken) = &tested.broken {
        let looks = [("peak", &broken.peak), ("end", &broken.end)];
        for (name, look) in looks {
            let Some(look) = look else { continue };
            let name = format!("snapshots/{name}.vtp");
            let shown = Shown {
                u: &look.displacements_mm,
                stresses: Some(look.stresses_mpa.clone()),
                damage: Some(&look.damage),
            };
            write_cells(&model.layout, &name, &shown, factor, recorder)?;
            entries.push((look.displacement_mm, name));
        }
        write_cracks(model, broken, factor, recorder)?;
    } else {
        let name = SECTION.to_owned();
        let u = tested.displacements_mm();
        let shown = Shown {
            u,
            stresses: stresses(model, u),
            damage: None,
        };
        write_cells(&model.layout, &name, &shown, factor, recorder)?;
        write_bonds(model, u, factor, recorder)?;
        entries.push((1.0, name));
    }
    let series = Series { entries };
    recorder.file("snapshots.pvd", &mut |out| series.write(out))?;
    Ok(())
}

/// What a picture shows beside the section itself.
struct Shown<'a> {
    u: &'a [f64],
    /// σ_xx, σ_yy and σ_xy of every cell [MPa].
    stresses: Option<Vec<[f64; 3]>>,
    /// Lost part of every cell's stiffness.
    damage: Option<&'a [f64]>,
}

/// Where a particle is drawn.
fn drawn(grid: &Grid, u: &[f64], factor: f64, particle: usize) -> [f64; 3] {
    let [x, y] = grid.place_mm(particle);
    [
        x + factor * u[2 * particle],
        y + factor * u[2 * particle + 1],
        0.0,
    ]
}

/// The deformed section as cells with stress and strain.
fn write_cells(
    layout: &Layout,
    name: &str,
    shown: &Shown<'_>,
    factor: f64,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let grid = layout.grid();
    let u = shown.u;
    let cells = grid.cells();
    let mut points = Vec::with_capacity(4 * cells);
    let mut displacement = Vec::with_capacity(12 * cells);
    let mut strain = [const { Vec::new() }; 3];
    for cell in 0..cells {
        let corners = grid.corners(cell);
        for particle in corners {
            points.push(drawn(grid, u, factor, particle));
            displacement.extend([u[2 * particle], u[2 * particle + 1], 0.0]);
        }
        let [[xx, xy], [yx, yy]] = mean_gradient(grid.sides_mm(cell), &gather(u, corners));
        for (all, one) in strain.iter_mut().zip([xx, yy, xy + yx]) {
            all.push(one);
        }
    }
    let mut data = vec![Array::scalars("fibre_share", layout.fibre_share())];
    if let Some(damage) = shown.damage {
        data.push(Array::scalars("damage", damage));
    }
    for (name, values) in ["strain_xx", "strain_yy", "strain_xy"].iter().zip(&strain) {
        data.push(Array::scalars(name, values));
    }
    let mut stress = [const { Vec::new() }; 4];
    for [xx, yy, xy] in shown.stresses.iter().flatten() {
        let mises = (xx * xx - xx * yy + yy * yy + 3.0 * xy * xy).sqrt();
        for (all, one) in stress.iter_mut().zip([*xx, *yy, *xy, mises]) {
            all.push(one);
        }
    }
    if shown.stresses.is_some() {
        let names = [
            "stress_xx_mpa",
            "stress_yy_mpa",
            "stress_xy_mpa",
            "stress_mises_mpa",
        ];
        let arrays = names.iter().zip(&stress);
        data.extend(arrays.map(|(name, values)| Array::scalars(name, values)));
    }
    let polygons = Polygons {
        points: &points,
        corners: &vec![4; cells],
        point_data: &[Array::vectors("displacement_mm", &displacement)],
        cell_data: &data,
    };
    recorder.file(name, &mut |out| polygons.write(out))?;
    Ok(())
}

/// The bonds with their forces.
fn write_bonds(
    model: &Model<'_>,
    u: &[f64],
    factor: f64,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let (ends, forces) = bonds(model, u);
    let grid = model.lattice.grid();
    let particles: Vec<[f64; 3]> = (0..grid.particles())
        .map(|particle| drawn(grid, u, factor, particle))
        .collect();
    let lines = Lines {
        points: &particles,
        ends: &ends,
        point_data: &[],
        cell_data: &[Array::scalars("force_n", &forces)],
    };
    recorder.file("snapshots/bonds.vtp", &mut |out| lines.write(out))?;
    Ok(())
}

/// Cracks that are open through, as lines across their cells, where the section is at the end.
fn write_cracks(
    model: &Model<'_>,
    broken: &Broken,
    factor: f64,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let Some(end) = &broken.end else {
        return Ok(());
    };
    let grid = model.lattice.grid();
    let (mut points, mut ends) = (Vec::new(), Vec::new());
    let (mut numbers, mut parts) = (Vec::new(), Vec::new());
    for event in broken
        .events
        .iter()
        .filter(|event| event.crack_area_mm2 > 0.0)
    {
        let [mut x, mut y] = [0.0; 2];
        for particle in grid.corners(event.cell) {
            let place = drawn(grid, &end.displacements_mm, factor, particle);
            x += 0.25 * place[0];
            y += 0.25 * place[1];
        }
        let half = 0.5 * event.crack_area_mm2 / model.lattice.thickness_mm();
        let along = [-event.normal[1] * half, event.normal[0] * half];
        let first = points.len() as u32;
        points.push([x - along[0], y - along[1], 0.0]);
        points.push([x + along[0], y + along[1], 0.0]);
        ends.push([first, first + 1]);
        numbers.push(event.number as f64);
        parts.push(part_number(event.part));
    }
    let lines = Lines {
        points: &points,
        ends: &ends,
        point_data: &[],
        cell_data: &[
            Array::scalars("event", &numbers),
            Array::scalars("part", &parts),
        ],
    };
    recorder.file("snapshots/cracks.vtp", &mut |out| lines.write(out))?;
    Ok(())
}

/// Which sort of part broke, as a number for pictures: matrix or ply 0, fibre 1, interface 2, face
/// between plies 3.
fn part_number(part: BrokenPart) -> f64 {
    match part {
        BrokenPart::Matrix => 0.0,
        BrokenPart::Fibre(_) => 1.0,
        BrokenPart::Interface(_) => 2.0,
        BrokenPart::PlyFace(_) => 3.0,
    }
}

/// σ_xx, σ_yy and σ_xy of every cell [MPa]; `None` in the paper's lattice, whose cells have none.
fn stresses(model: &Model<'_>, u: &[f64]) -> Option<Vec<[f64; 3]>> {
    let geometry = model.geometry();
    (0..model.lattice.grid().cells())
        .map(|cell| model.lattice.stress(geometry, cell, u))
        .collect()
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
