//! Interpolation between the nodes of a row of cells and the corners of these.
//!
//! Within a cell a displacement is a + s b + t c + s t d with the node's coordinates s, t, so the four
//! numbers of each cell are laid out once along x and then serve every row of nodes there. Nodes of no
//! row are rows of one.
use std::ops::Range;

use super::corners::Vectors;
use crate::field::{LANES, Real};

/// Nodes of a row worked on at once.
pub(super) const BLOCK: usize = 256;

/// The four numbers of a cell at each node of a row, for so many components.
pub(super) type Parts<const C: usize> = [[[f32; BLOCK]; 4]; C];

/// Rows of nodes, at most [`BLOCK`] long, whose nodes lie in the same cells one by one.
#[derive(Clone, Debug)]
pub(super) struct Band {
    /// Place of each row's first node.
    pub(super) rows: Vec<u32>,
    pub(super) count: usize,
    /// First corner of the cell of the first node.
    pub(super) corner: u32,
    /// Nodes in that cell, in the next along x, and so on.
    pub(super) runs: Vec<u32>,
}

impl Band {
    /// Adds to `sums`, from corner number `first` on, what the nodes' `forces` are at the corners,
    /// `above` numbers from row to row.
    #[inline(always)]
    pub(super) fn restrict<T: Real, const C: usize>(
        &self,
        at: &[Vec<f32>; 2],
        forces: [&[T]; C],
        first: usize,
        sums: &mut [&mut [f32]; C],
        above: usize,
        parts: &mut Parts<C>,
    ) {
        // what is in two vectors is the same from both
        for column in self.vectors() {
            self.gather::<T, LANES, C>(at, forces, column, parts);
        }
        for column in self.singles() {
            self.gather::<T, 1, C>(at, forces, column, parts);
        }
        let mut nodes = 0..0;
        for (cell, run) in self.runs.iter().enumerate() {
            nodes = nodes.end..nodes.end + *run as usize;
            let mut totals = [[0.0; 4]; C];
            for node in nodes.clone() {
                for (totals, parts) in totals.iter_mut().zip(parts.iter()) {
                    for (total, part) in totals.iter_mut().zip(parts) {
                        *total += part[node];
                    }
                }
            }
            let corner = self.corner as usize + cell - first;
            for (sums, [a, b, c, d]) in sums.iter_mut().zip(totals) {
                sums[corner] += a - b - c + d;
                sums[corner + 1] += b - d;
                sums[corner + above] += c - d;
                sums[corner + above + 1] += d;
            }
        }
    }

    /// Adds up what the rows have in some columns.
    #[inline(always)]
    fn gather<T: Real, const N: usize, const C: usize>(
        &self,
        at: &[Vec<f32>; 2],
        forces: [&[T]; C],
        column: usize,
        parts: &mut Parts<C>,
    ) {
        let mut sums = [[[0.0_f32; N]; 4]; C];
        for row in &self.rows {
            let place = *row as usize + column;
            let [s, t] = at.each_ref().map(
                #[inline(always)]
                |at| &at[place..][..N],
            );
            for (forces, sums) in forces.iter().zip(&mut sums) {
                let forces = &forces[place..][..N];
                let [a, b, c, d] = sums;
                for node in 0..N {
                    let force = forces[node].narrow();
                    let with_t = force * t[node];
                    a[node] += force;
                    b[node] = force.mul_add(s[node], b[node]);
                    c[node] += with_t;
                    d[node] = with_t.mul_add(s[node], d[node]);
                }
            }
        }
        for (parts, sums) in parts.iter_mut().zip(&sums) {
            for (part, sums) in parts.iter_mut().zip(sums) {
                part[column..][..N].copy_from_slice(sums);
            }
        }
    }

    /// Adds the displacements interpolated from the `corners`, `above` numbers from row to row, to
    /// those `moved` from place `first` on, times the nodes' `mobility`.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are slices of what nobody else needs as one"
    )]
    pub(super) fn prolong<T: Real, const C: usize>(
        &self,
        at: &[Vec<f32>; 2],
        corners: &Vectors,
        above: usize,
        mobility: &[T],
        first: usize,
        moved: &mut [&mut [T]; C],
        parts: &mut Parts<C>,
    ) {
        let mut nodes = 0..0;
        for (cell, run) in self.runs.iter().enumerate() {
            nodes = nodes.end..nodes.end + *run as usize;
            let corner = self.corner as usize + cell;
            for (corners, parts) in corners.iter().zip(parts.iter_mut()) {
                let (left, right) = (corners[corner], corners[corner + 1]);
                let (above_left, above_right) =
                    (corners[corner + above], corners[corner + above + 1]);
                let (b, c) = (right - left, above_left - left);
                let of_cell = [left, b, c, above_right - above_left - b];
                for (part, value) in parts.iter_mut().zip(of_cell) {
                    part[nodes.clone()].fill(value);
                }
            }
        }
        // of the last vector, those columns that are not in the one before
        let mut last = [T::one(); LANES];
        last[..self.count.next_multiple_of(LANES) - self.count].fill(T::zero());
        for row in &self.rows {
            let row = *row as usize;
            for (moved, parts) in moved.iter_mut().zip(parts.iter()) {
                for column in self.vectors() {
                    let values = interpolate::<T, LANES>(at, parts, mobility, row, column);
                    let moved = &mut moved[row + column - first..][..LANES];
                    if column + LANES < self.count {
                        for node in 0..LANES {
                            moved[node] += values[node];
                        }
                    } else {
                        for node in 0..LANES {
                            moved[node] = last[node].mul_add(values[node], moved[node]);
                        }
                    }
                }
                for column in self.singles() {
                    let [value] = interpolate(at, parts, mobility, row, column);
                    moved[row + column - first] += value;
                }
            }
        }
    }

    /// First columns of whole vectors; the last one begins in the one before if need be.
    #[inline(always)]
    fn vectors(&self) -> impl Iterator<Item = usize> {
        let last = self.count.checked_sub(LANES);
        last.into_iter().flat_map(|last| {
            let firsts = (0..last + LANES).step_by(LANES);
            firsts.map(move |first| first.min(last))
        })
    }

    /// Columns of rows shorter than a vector.
    #[inline(always)]
    fn singles(&self) -> Range<usize> {
        if self.count < LANES {
            0..self.count
        } else {
            0..0
        }
    }
}

/// Displacements along an axis of some columns of a row, times the nodes' mobility.
#[inline(always)]
fn interpolate<T: Real, const N: usize>(
    at: &[Vec<f32>; 2],
    parts: &[[f32; BLOCK]; 4],
    mobility: &[T],
    row: usize,
    column: usize,
) -> [T; N] {
    let [s, t] = at.each_ref().map(
        #[inline(always)]
        |at| &at[row + column..][..N],
    );
    let mobility = &mobility[row + column..][..N];
    let [a, b, c, d] = parts.each_ref().map(
        #[inline(always)]
        |part| &part[column..][..N],
    );
    let mut values = [T::zero(); N];
    for node in 0..N {
        let at_bottom = s[node].mul_add(b[node], a[node]);
        let upwards = s[node].mul_add(d[node], c[node]);
        values[node] = mobility[node] * T::widen(upwards.mul_add(t[node], at_bottom));
    }
    values
}
