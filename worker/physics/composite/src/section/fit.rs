//! How well a grid follows what lies in it.
use loadframe_api::section::fibre::{Band, gaps_beside_ends};
use loadframe_api::section::lines::{has_one_cell, pass_through};

use crate::section::grid::Grid;

/// How well a grid follows what lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fit {
    /// Lines of particles pass through all faces of plies and fibres and through the ends of fibres.
    Exact,
    /// The same, but a narrow gap beside a fibre that ends is one cell wide, which half of the cells do not
    /// make any wider: what that one takes from the truth is not seen.
    OneCell,
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
    } else if has_one_cell_beside_ends(grid, bands) {
        Fit::OneCell
    } else {
        Fit::Exact
    }
}

fn has_one_cell_beside_ends(grid: &Grid, bands: &[Band]) -> bool {
    let lines = [grid.x_mm(), grid.y_mm()];
    let sides = lines.map(|lines| lines[lines.len() - 1]);
    lines.into_iter().enumerate().any(|(axis, lines)| {
        let gaps = gaps_beside_ends(bands, axis, sides);
        gaps.iter().any(|gap| has_one_cell(lines, *gap))
    })
}
