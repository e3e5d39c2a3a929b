//! Which fibres the cells of a grid hold, and how much of them.
use loadframe_api::section::fibre::Band;
use loadframe_api::section::polygon::Polygon;
use loadframe_harness::InterruptSource;

use crate::error::CompositeError;
use crate::section::bars::moments;
use crate::section::grid::Grid;

/// A part of a cell's area below this is round-off, not a fibre.
pub(super) const LEAST_SHARE: f64 = 1e-12;

/// A fibre in a cell: which band, and its share of the cell's area.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) cell: u32,
    pub(crate) band: u32,
    pub(crate) share: f64,
    /// Of its area, see [`moments`]; 0 of one along an axis of the grid.
    pub(super) moments: [f64; 3],
}

/// Shares of all cells that fibres touch, by cell and then by band.
///
/// # Errors
/// [`CompositeError::GivenUp`] at a cancel.
pub(super) fn shares(
    grid: &Grid,
    bands: &[Band],
    interrupt: &dyn InterruptSource,
) -> Result<Vec<Part>, CompositeError> {
    let mut parts = Vec::new();
    for place in 0..bands.len() {
        if interrupt.is_cancelled() {
            return Err(CompositeError::GivenUp);
        }
        add(&mut parts, grid, bands, place);
    }
    parts.sort_by_key(|part| (part.cell, part.band));
    Ok(parts)
}

/// Adds the cells of one band: each cell's rectangle, cut by the band.
fn add(parts: &mut Vec<Part>, grid: &Grid, bands: &[Band], place: usize) {
    let band = &bands[place];
    for j in touched(grid.y_mm(), range(band.polygon(), 1)) {
        let y = [grid.y_mm()[j], grid.y_mm()[j + 1]];
        // Only the columns the band crosses in this row.
        let strip = band
            .polygon()
            .clipped([0.0, 1.0], y[1])
            .clipped([0.0, -1.0], -y[0]);
        for i in touched(grid.x_mm(), range(&strip, 0)) {
            let x = [grid.x_mm()[i], grid.x_mm()[i + 1]];
            let sides = [x[1] - x[0], y[1] - y[0]];
            let within = Polygon::rectangle(x, y).within(band.polygon());
            let share = within.area_and_centroid().0 / (sides[0] * sides[1]);
            if share > LEAST_SHARE {
                let middle = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
                parts.push(Part {
                    cell: (j * grid.columns() + i) as u32,
                    band: place as u32,
                    share: if share > 1.0 - LEAST_SHARE {
                        1.0
                    } else {
                        share
                    },
                    moments: if band.is_slanted() {
                        moments(&within, band.axis, middle, sides)
                    } else {
                        [0.0; 3]
                    },
                });
            }
        }
    }
}

/// Smallest and largest coordinate of its corners [mm].
fn range(polygon: &Polygon, axis: usize) -> [f64; 2] {
    let corners = polygon.corners().iter().map(|corner| corner[axis]);
    corners.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], one| {
        [low.min(one), high.max(one)]
    })
}

/// The intervals between lines that a range touches.
fn touched(lines: &[f64], [from, to]: [f64; 2]) -> std::ops::Range<usize> {
    let first = lines
        .partition_point(|&line| line <= from)
        .saturating_sub(1);
    let last = lines
        .partition_point(|&line| line < to)
        .min(lines.len() - 1);
    first..last
}
