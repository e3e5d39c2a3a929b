//! The cell as pixels: the share of fibre in each, and the normal of the face that cuts it.
//!
//! Shares are exact areas, so that the pixels hold as much fibre as the cell does.
use nalgebra::Vector6;

use super::phase::{Cut, Space};
use super::{RoundFibre, UnitCell};

/// What fills a pixel alone.
pub(super) const MATRIX: u32 = 0;
pub(super) const FIBRE: u32 = 1;

/// A share nearer to none or all than this is round-off of areas.
const LEAST_SHARE: f64 = 1e-9;

/// A rectangular grid of pixels over the periodic cell; pixel (i, j) is number j columns + i.
#[derive(Debug, Clone)]
pub(super) struct Pixels {
    /// Columns along 2 and rows along 3.
    pub(super) grid: [usize; 2],
    /// Sides of a pixel along 2 and 3 [mm].
    pub(super) sides_mm: [f64; 2],
    /// Place of each pixel's stiffness among `stiffness`: [`MATRIX`], [`FIBRE`] or a cut one's.
    pub(super) kind: Vec<u32>,
    /// Of the matrix, the fibre, and every pixel that is cut [MPa].
    pub(super) stiffness: Vec<Space>,
    /// Of the kinds from the third on.
    pub(super) cuts: Vec<Cut>,
    /// Longer sides of a pixel across the thinnest fibre.
    pub(super) across_fibre: f64,
}

impl Pixels {
    /// Lays pixels over a cell whose fibres do not overlap.
    pub(super) fn new(cell: &UnitCell, grid: [usize; 2], phases: [Space; 2]) -> Self {
        let sides_mm = [0, 1].map(|axis| cell.size_mm[axis] / grid[axis] as f64);
        let mut shares = Shares {
            grid,
            sides: sides_mm,
            share: vec![0.0; grid[0] * grid[1]],
            faces: vec![[0.0; 3]; grid[0] * grid[1]],
        };
        for fibre in &cell.fibres {
            shares.add(fibre);
        }
        let thinnest = cell
            .fibres
            .iter()
            .map(|fibre| fibre.diameter_mm)
            .fold(f64::INFINITY, f64::min);
        Self {
            across_fibre: thinnest / sides_mm[0].max(sides_mm[1]),
            ..Self::of_cuts(grid, sides_mm, phases, |pixel| shares.cut(pixel))
        }
    }

    /// Pixels by their share of fibre and the normal of the face in it.
    pub(super) fn of_cuts(
        grid: [usize; 2],
        sides_mm: [f64; 2],
        [matrix, fibre]: [Space; 2],
        cut: impl Fn(usize) -> Cut,
    ) -> Self {
        let mut stiffness = vec![matrix, fibre];
        let mut cuts = Vec::new();
        let kind = (0..grid[0] * grid[1])
            .map(|pixel| {
                let cut = cut(pixel);
                if cut.fibre_share < LEAST_SHARE {
                    return MATRIX;
                }
                if cut.fibre_share > 1.0 - LEAST_SHARE {
                    return FIBRE;
                }
                stiffness.push(cut.stiffness(&matrix, &fibre));
                cuts.push(cut);
                stiffness.len() as u32 - 1
            })
            .collect();
        Self {
            grid,
            sides_mm,
            kind,
            stiffness,
            cuts,
            across_fibre: f64::INFINITY,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.kind.len()
    }

    /// The face in a pixel, if one cuts it.
    pub(super) fn cut(&self, pixel: usize) -> Option<&Cut> {
        self.cuts.get((self.kind[pixel] as usize).wrapping_sub(2))
    }

    /// Share of fibre in every pixel.
    pub(super) fn fibre_shares(&self) -> Vec<f64> {
        (0..self.count())
            .map(|pixel| self.fibre_share(pixel))
            .collect()
    }

    /// Share of fibre in a pixel.
    pub(super) fn fibre_share(&self, pixel: usize) -> f64 {
        match self.cut(pixel) {
            Some(cut) => cut.fibre_share,
            None => f64::from(self.kind[pixel]),
        }
    }

    /// Mean stress of a pixel by its mean strain [MPa].
    pub(super) fn stress(&self, pixel: usize, strain: &Vector6<f64>) -> Vector6<f64> {
        self.stiffness[self.kind[pixel] as usize] * strain
    }

    /// A pixel and its eight neighbours.
    pub(super) fn around(&self, pixel: usize) -> [usize; 9] {
        let [columns, rows] = self.grid;
        let (i, j) = (pixel % columns, pixel / columns);
        std::array::from_fn(|place| {
            let column = (i + columns + place % 3 - 1) % columns;
            let row = (j + rows + place / 3 - 1) % rows;
            row * columns + column
        })
    }

    /// Middle of a pixel [mm].
    pub(super) fn middle_mm(&self, pixel: usize) -> [f64; 2] {
        [
            ((pixel % self.grid[0]) as f64 + 0.5) * self.sides_mm[0],
            ((pixel / self.grid[0]) as f64 + 0.5) * self.sides_mm[1],
        ]
    }

    /// Mean over all pixels of what each kind has.
    pub(super) fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        let mut counts = vec![0_u32; self.stiffness.len()];
        for &kind in &self.kind {
            counts[kind as usize] += 1;
        }
        let sum: f64 = counts
            .iter()
            .enumerate()
            .filter(|(_, count)| **count > 0)
            .map(|(kind, &count)| f64::from(count) * of(kind))
            .sum();
        sum / self.count() as f64
    }
}

/// Shares while fibres are added.
struct Shares {
    grid: [usize; 2],
    sides: [f64; 2],
    share: Vec<f64>,
    /// Σ |N| n nᵀ over the faces in a pixel, entries 22, 33, 23: facing faces, whose normals are
    /// opposite, do not cancel.
    faces: Vec<[f64; 3]>,
}

impl Shares {
    fn add(&mut self, fibre: &RoundFibre) {
        let radius = fibre.diameter_mm / 2.0;
        let centre = [0, 1].map(|axis| {
            fibre.centre_mm[axis].rem_euclid(self.grid[axis] as f64 * self.sides[axis])
        });
        let range = [0, 1].map(|axis| {
            let place = |offset: f64| ((centre[axis] + offset) / self.sides[axis]).floor();
            place(-radius) as i64..=place(radius) as i64
        });
        for j in range[1].clone() {
            for i in range[0].clone() {
                // relative to the fibre's centre
                let low = [0, 1].map(|axis| [i, j][axis] as f64 * self.sides[axis] - centre[axis]);
                let high = [low[0] + self.sides[0], low[1] + self.sides[1]];
                let column = i.rem_euclid(self.grid[0] as i64) as usize;
                let row = j.rem_euclid(self.grid[1] as i64) as usize;
                self.add_pixel(row * self.grid[0] + column, low, high, radius);
            }
        }
    }

    fn add_pixel(&mut self, pixel: usize, low: [f64; 2], high: [f64; 2], radius: f64) {
        let farthest = [0, 1].map(|axis| low[axis].abs().max(high[axis].abs()));
        if farthest[0] * farthest[0] + farthest[1] * farthest[1] <= radius * radius {
            self.share[pixel] += 1.0;
            return;
        }
        let (area, normal) = disc_in_rectangle(low, high, radius);
        self.share[pixel] += area / (self.sides[0] * self.sides[1]);
        let length = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
        if length > 0.0 {
            let face = &mut self.faces[pixel];
            face[0] += normal[0] * normal[0] / length;
            face[1] += normal[1] * normal[1] / length;
            face[2] += normal[0] * normal[1] / length;
        }
    }

    /// The normal is the first principal axis of the faces: cos 2θ = (t₂₂ - t₃₃)/r, with
    /// r² = (t₂₂ - t₃₃)² + 4 t₂₃².
    fn cut(&self, pixel: usize) -> Cut {
        let [t22, t33, t23] = self.faces[pixel];
        let radius = ((t22 - t33).powi(2) + 4.0 * t23 * t23).sqrt();
        let normal = if radius > 0.0 {
            let double = (t22 - t33) / radius;
            // of the two roots the one that does not cancel, the other by sin 2θ = 2 c s
            if double > 0.0 {
                let c = (0.5 * (1.0 + double)).sqrt();
                [c, t23 / (radius * c)]
            } else {
                let s = (0.5 * (1.0 - double)).sqrt();
                [t23 / (radius * s), s]
            }
        } else {
            [1.0, 0.0]
        };
        Cut {
            fibre_share: self.share[pixel].min(1.0),
            normal,
        }
    }
}

/// Area of a disc about the origin within a rectangle, and ∫ n ds over the arc in it, n outward.
///
/// The area is Green's ½ ∮ (x dy - y dx), edge by edge: of an edge the part inside gives a triangle
/// with the centre, the parts outside give sectors. The integral of the normal over the whole
/// outline of the common part is 0, so that the arc's is what the sides inside the disc leave:
/// (left - right, bottom - top).
fn disc_in_rectangle(low: [f64; 2], high: [f64; 2], radius: f64) -> (f64, [f64; 2]) {
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let mut area = 0.0;
    let mut inside = [0.0; 4];
    for side in 0..4 {
        let (p, q) = (corners[side], corners[(side + 1) % 4]);
        let (part, length) = edge(p, q, radius);
        area += part;
        inside[side] = length;
    }
    let [bottom, right, top, left] = inside;
    (area.max(0.0), [left - right, bottom - top])
}

/// An edge's part of ½ ∮ (x dy - y dx), and its length inside the disc.
fn edge(p: [f64; 2], q: [f64; 2], radius: f64) -> (f64, f64) {
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let dot = |u: [f64; 2], v: [f64; 2]| u[0] * v[0] + u[1] * v[1];
    let sector = |u, v| 0.5 * radius * radius * cross(u, v).atan2(dot(u, v));
    let d = [q[0] - p[0], q[1] - p[1]];
    let length = dot(d, d).sqrt();
    // |p + t d|² = r²
    let middle = -dot(p, d) / dot(d, d);
    let height = cross(p, d) / length;
    let half_square = radius * radius - height * height;
    if half_square <= 0.0 {
        return (sector(p, q), 0.0);
    }
    let half = half_square.sqrt() / length;
    let (from, to) = ((middle - half).max(0.0), (middle + half).min(1.0));
    if from >= to {
        return (sector(p, q), 0.0);
    }
    let at = |t: f64| [p[0] + t * d[0], p[1] + t * d[1]];
    let (enter, leave) = (at(from), at(to));
    let mut area = 0.5 * cross(enter, leave);
    if from > 0.0 {
        area += sector(p, enter);
    }
    if to < 1.0 {
        area += sector(leave, q);
    }
    (area, (to - from) * length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_in_a_rectangle_has_its_quarter_half_segment_and_whole() {
        let pi = std::f64::consts::PI;
        let close = |(area, normal): (f64, [f64; 2]), expected: f64, arc: [f64; 2]| {
            assert!((area - expected).abs() < 1e-14, "{area} {expected}");
            assert!((normal[0] - arc[0]).abs() + (normal[1] - arc[1]).abs() < 1e-14);
        };
        let of = disc_in_rectangle;
        close(of([0.0, 0.0], [2.0, 2.0], 1.0), pi / 4.0, [1.0, 1.0]);
        close(of([-2.0, 0.0], [2.0, 2.0], 1.0), pi / 2.0, [0.0, 2.0]);
        close(of([-2.0, -2.0], [2.0, 2.0], 1.0), pi, [0.0, 0.0]);
        // beyond x = 1/2: r² (φ - sin φ cos φ) with cos φ = 1/2, chord √3
        let segment = pi / 3.0 - 3.0_f64.sqrt() / 4.0;
        close(
            of([0.5, -2.0], [2.0, 2.0], 1.0),
            segment,
            [3.0_f64.sqrt(), 0.0],
        );
        close(of([1.5, 1.5], [2.0, 2.0], 1.0), 0.0, [0.0, 0.0]);
        close(of([-0.5, -0.5], [0.5, 0.5], 1.0), 1.0, [0.0, 0.0]);
    }
}
