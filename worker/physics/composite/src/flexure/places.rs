//! Places of a section that a bending test looks at.
use crate::lattice::{Geometry, Lattice};
use crate::section::{Grid, Section, within};

/// σ_xy of the cells of a column from the bottom up, with their heights [mm] and [MPa]; none in the
/// paper's lattice.
pub(super) fn shear_through(
    lattice: &Lattice,
    geometry: Geometry,
    at_mm: f64,
    u: &[f64],
) -> Vec<(f64, f64)> {
    let grid = lattice.grid();
    let Some((column, _)) = within(grid.x_mm(), at_mm) else {
        return Vec::new();
    };
    (0..grid.rows())
        .filter_map(|row| {
            let cell = row * grid.columns() + column;
            let stress = lattice.stress(geometry, cell, u)?;
            Some((grid.sides_mm(cell)[1], stress[2]))
        })
        .collect()
}

/// The particle nearest to the middle of the section.
pub(super) fn middle(section: &Section, grid: &Grid) -> usize {
    let (column, _) = nearest(grid.x_mm(), 0.5 * section.length_mm);
    let (row, _) = nearest(grid.y_mm(), 0.5 * section.height_mm);
    grid.particle(column, row)
}

/// The line nearest to a coordinate, and its place.
fn nearest(lines: &[f64], at: f64) -> (usize, f64) {
    let mut found = (0, lines[0]);
    for (place, &line) in lines.iter().enumerate() {
        if (line - at).abs() < (found.1 - at).abs() {
            found = (place, line);
        }
    }
    found
}
