//! Which fibres the cells of a grid hold, and how much of them.
use crate::section::grid::Grid;
use crate::section::{Band, Polygon};

/// A part of a cell's area below this is round-off, not a fibre.
pub(super) const LEAST_SHARE: f64 = 1e-12;

/// A fibre in a cell: which band, and its share of the cell's area.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) cell: u32,
    pub(crate) band: u32,
    pub(crate) share: f64,
}

/// Over how many cells, measured across it, a fibre at an angle to the grid is spread at least.
///
/// A cell that only a corner of a thin fibre touches has hardly any of its stiffness, and lets it stretch
/// wherever it passes from one row of cells to the next: fibres of 0.7 mm, 135 times as stiff as their matrix,
/// at 20° to 45° on 50 by 50 cells of 1.4 mm, left a clamped section up to 28 % too soft (graded cells; even ones
/// 16 %). Spread over as many cells as here they run on, and it is off by 3 %; over two or three cells thin
/// ones come out closer still, but a fibre that is thicker than a cell loses its own shear stiffness to the
/// matrix it is mixed with. Measured against finite elements, `tests/composite/cases/slanted_*`.
const SPREAD: f64 = 1.5;

/// Half of the thickness over which a cell of these sides holds a fibre [mm].
fn half_spread_mm(band: &Band, [width, height]: [f64; 2]) -> f64 {
    if !band.is_slanted() {
        // lines of particles lie on its faces, or it is a layer of whole rows
        return band.half_thickness_mm;
    }
    let [along, up] = band.axis.map(f64::abs);
    let across = width * up + height * along;
    band.half_thickness_mm.max(0.5 * SPREAD * across)
}

fn spread(band: &Band, half_mm: f64) -> Polygon {
    if half_mm > band.half_thickness_mm {
        band.of_half_thickness(half_mm)
    } else {
        *band.polygon()
    }
}

/// Shares of all cells that fibres touch, by cell and then by band.
pub(super) fn shares(grid: &Grid, bands: &[Band]) -> Vec<Part> {
    let mut parts = Vec::new();
    for place in 0..bands.len() {
        add(&mut parts, grid, bands, place);
    }
    parts.sort_by_key(|part| (part.cell, part.band));
    // fibres closer to each other than they are spread may fill a cell more than once
    for held in parts.chunk_by_mut(|a, b| a.cell == b.cell) {
        let whole: f64 = held.iter().map(|part| part.share).sum();
        if whole > 1.0 + LEAST_SHARE {
            for part in held {
                part.share /= whole;
            }
        }
    }
    parts
}

/// Adds the cells of one band: each cell's rectangle, cut by the band, or by the one over which its fibre is
/// spread.
fn add(parts: &mut Vec<Part>, grid: &Grid, bands: &[Band], place: usize) {
    let band = &bands[place];
    let first = parts.len();
    let largest = [grid.x_mm(), grid.y_mm()].map(|lines| {
        let sides = lines.windows(2).map(|pair| pair[1] - pair[0]);
        sides.fold(0.0, f64::max)
    });
    let widest = spread(band, half_spread_mm(band, largest));
    let (mut area, mut is_spread) = (0.0, false);
    for j in touched(grid.y_mm(), range(&widest, 1)) {
        let y = [grid.y_mm()[j], grid.y_mm()[j + 1]];
        // Only the columns the band crosses in this row.
        let strip = widest.clipped([0.0, 1.0], y[1]).clipped([0.0, -1.0], -y[0]);
        for i in touched(grid.x_mm(), range(&strip, 0)) {
            let x = [grid.x_mm()[i], grid.x_mm()[i + 1]];
            let sides = [x[1] - x[0], y[1] - y[0]];
            let half = half_spread_mm(band, sides);
            is_spread |= half > band.half_thickness_mm;
            let within = Polygon::rectangle(x, y).within(&spread(band, half));
            let held = within.area_and_centroid().0 * (band.half_thickness_mm / half);
            area += held;
            let share = held / (sides[0] * sides[1]);
            if share > LEAST_SHARE {
                parts.push(Part {
                    cell: (j * grid.columns() + i) as u32,
                    band: place as u32,
                    share: if share > 1.0 - LEAST_SHARE {
                        1.0
                    } else {
                        share
                    },
                });
            }
        }
    }
    if is_spread {
        // edges of the section, and cells of another size beside, take a little of it or add to it
        let own = band.polygon().area_and_centroid().0;
        for part in &mut parts[first..] {
            part.share = (part.share * own / area).min(1.0);
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
