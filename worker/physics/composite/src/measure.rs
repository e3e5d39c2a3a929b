//! What is read off displacements: means over faces, points, sums of reactions.
use crate::error::CompositeError;
use crate::lattice::gather;
use crate::section::{Grid, corner_weights};
use crate::supports::Face;

/// Mean displacement of a face along x and y [mm]; exact for displacements that are linear between
/// particles.
#[must_use]
pub fn face_mean_mm(grid: &Grid, face: Face, u: &[f64]) -> [f64; 2] {
    mean_along(face.lines_mm(grid), u, |line| face.particle(grid, line))
}

/// Mean displacement of a column of particles along x and y [mm], as [`face_mean_mm`].
#[must_use]
pub fn column_mean_mm(grid: &Grid, column: usize, u: &[f64]) -> [f64; 2] {
    mean_along(grid.y_mm(), u, |row| grid.particle(column, row))
}

fn mean_along(lines: &[f64], u: &[f64], particle: impl Fn(usize) -> usize) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (line, pair) in lines.windows(2).enumerate() {
        let half = 0.5 * (pair[1] - pair[0]);
        for particle in [particle(line), particle(line + 1)] {
            sums[0] += half * u[2 * particle];
            sums[1] += half * u[2 * particle + 1];
        }
    }
    let side = lines[lines.len() - 1] - lines[0];
    sums.map(|sum| sum / side)
}

/// Displacement along x and y of a point [mm], bilinear between the corners of its cell.
///
/// # Errors
/// When it lies outside the section.
pub fn point_mm(grid: &Grid, point: [f64; 2], u: &[f64]) -> Result<[f64; 2], CompositeError> {
    let (cell, place) = grid.locate(point).ok_or(CompositeError::OutsideSection {
        what: "the probe",
        x_mm: point[0],
        y_mm: point[1],
    })?;
    let corners = gather(u, grid.corners(cell));
    let mut mean = [0.0; 2];
    for (corner, weight) in corner_weights(place).into_iter().enumerate() {
        mean[0] += weight * corners[2 * corner];
        mean[1] += weight * corners[2 * corner + 1];
    }
    Ok(mean)
}

/// Mean derivatives of a cell's displacements: of u_x by x and y, of u_y by x and y [-].
#[must_use]
pub fn mean_gradient([a, b]: [f64; 2], corners: &[f64; 8]) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| {
        let [p, q, r, s] = [0, 2, 4, 6].map(|corner| corners[corner + axis]);
        [(q + r - p - s) / (2.0 * a), (r + s - p - q) / (2.0 * b)]
    })
}

/// Sum of the forces on a face's particles along x and y [N].
#[must_use]
pub fn face_force_n(grid: &Grid, face: Face, forces: &[f64]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for line in 0..face.lines_mm(grid).len() {
        let particle = face.particle(grid, line);
        sums[0] += forces[2 * particle];
        sums[1] += forces[2 * particle + 1];
    }
    sums
}
