//! How well a grid follows what lies in it.
use loadframe_api::section::fibre::Band;
use loadframe_api::section::lines::pass_through;

use crate::section::grid::Grid;

/// How well a grid follows what lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fit {
    /// Lines of particles pass through all faces of plies and fibres and through the ends of fibres.
    Exact,
    /// All but those of fibres at an angle to both axes, which no grid follows.
    Slanted,
    /// Cells are cut by faces along an axis, or by ends of fibres along one.
    Cut,
}

pub(super) fn fit(grid: &Grid, faces: &[Vec<f64>; 2], bands: &[Band]) -> Fit {
    if !pass_through(grid.x_mm(), &faces[0]) || !pass_through(grid.y_mm(), &faces[1]) {
        Fit::Cut
    } else if bands.iter().any(Band::is_slanted) {
        Fit::Slanted
    } else {
        Fit::Exact
    }
}
