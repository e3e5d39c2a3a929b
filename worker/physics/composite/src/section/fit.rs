//! How well a grid follows what lies in it.
use loadframe_api::section::lines::pass_through;

use crate::section::Band;
use crate::section::grid::Grid;

/// How well a grid follows what lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fit {
    /// Lines of particles pass through all faces of plies and fibres.
    Exact,
    /// All but those of fibres at an angle to both axes, which no grid follows.
    Slanted,
    /// The same of fibres thinner than a cell: they are smeared over cells, whose corners of matrix alone let
    /// them stretch, so that the section is too soft until cells are several times thinner than they are.
    Thin,
    /// Cells are cut by faces along an axis.
    Cut,
}

pub(super) fn fit(grid: &Grid, faces: &[Vec<f64>; 2], bands: &[Band]) -> Fit {
    let is_slanted = |band: &Band| band.axis.iter().all(|part| part.abs() > f64::EPSILON);
    if !pass_through(grid.x_mm(), &faces[0]) || !pass_through(grid.y_mm(), &faces[1]) {
        Fit::Cut
    } else if bands
        .iter()
        .any(|band| is_slanted(band) && is_thin(band, largest_mm(grid)))
    {
        Fit::Thin
    } else if bands.iter().any(is_slanted) {
        Fit::Slanted
    } else {
        Fit::Exact
    }
}

fn is_thin(band: &Band, cell_mm: f64) -> bool {
    // of equal sizes round-off must not decide
    2.0 * band.half_thickness_mm < (1.0 - 1e-9) * cell_mm
}

/// The longest side of a cell [mm].
fn largest_mm(grid: &Grid) -> f64 {
    let lines = [grid.x_mm(), grid.y_mm()].into_iter();
    let sides = lines.flat_map(|lines| lines.windows(2).map(|pair| pair[1] - pair[0]));
    sides.fold(0.0, f64::max)
}
