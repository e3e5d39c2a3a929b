//! The inverse of the coarsest grid's stiffness.
use loadframe_numerics::wide;
use nalgebra::{Cholesky, DMatrix};

use super::corners::{Vectors, zeros};
use super::level::Level;
use crate::field::LANES;

/// Part of its trace added to each corner's stiffness: corners that nothing holds must not fly.
const TRACE_SHARE: f64 = 1e-3;

/// K⁻¹ between the corners that are not held.
#[derive(Clone, Debug)]
pub(super) struct Inverse {
    /// Corners it is about.
    corners: Vec<usize>,
    /// Components of a displacement.
    components: usize,
    /// Row by row, one for each component at a corner, each filled up to whole vectors.
    rows: Vec<f32>,
    width: usize,
    total: usize,
}

impl Inverse {
    /// Of so many components; the others do not move.
    pub(super) fn new(level: &Level, components: usize) -> Self {
        let total = level.corners();
        let corners: Vec<usize> = (0..total).filter(|c| !level.is_held(*c)).collect();
        let mut number = vec![usize::MAX; total];
        for (index, corner) in corners.iter().enumerate() {
            number[*corner] = index;
        }
        let size = components * corners.len();
        let mut matrix: DMatrix<f64> = DMatrix::zeros(size, size);
        level.each_block(|a, b, block| {
            let (a, b) = (number[a], number[b]);
            if a == usize::MAX || b == usize::MAX {
                return;
            }
            let [xx, yy, xy, zz, xz, yz] = block.map(f64::from);
            let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            for (i, row) in rows.iter().enumerate().take(components) {
                for (j, entry) in row.iter().enumerate().take(components) {
                    matrix[(components * b + j, components * a + i)] += entry;
                    if a != b {
                        matrix[(components * a + i, components * b + j)] += entry;
                    }
                }
            }
        });
        let mean = matrix.trace() / size as f64;
        for corner in 0..corners.len() {
            let own = components * corner..components * (corner + 1);
            let trace: f64 = own.clone().map(|i| matrix[(i, i)]).sum();
            let share = if trace > 0.0 {
                TRACE_SHARE * trace
            } else {
                mean.max(1.0)
            };
            for i in own {
                matrix[(i, i)] += share;
            }
        }
        let width = size.next_multiple_of(LANES);
        let mut rows = vec![0.0; size * width];
        // rounding of numbers too far apart: no correction is better than a wrong one
        if let Some(factor) = Cholesky::new(matrix) {
            let inverse = factor.inverse();
            for (row, column) in rows.chunks_exact_mut(width).zip(inverse.column_iter()) {
                for (entry, value) in row.iter_mut().zip(column.iter()) {
                    *entry = *value as f32;
                }
            }
        }
        Self {
            corners,
            components,
            rows,
            width,
            total,
        }
    }

    /// Displacements under `force`.
    pub(super) fn apply(&self, force: &Vectors) -> Vectors {
        let mut packed = vec![0.0_f32; self.width];
        wide(
            #[inline(always)]
            || {
                let rows = self.rows.chunks_exact(self.width.max(1));
                for (number, row) in rows.enumerate() {
                    let force =
                        force[number % self.components][self.corners[number / self.components]];
                    for (moved, entry) in packed.iter_mut().zip(row) {
                        *moved = entry.mul_add(force, *moved);
                    }
                }
            },
        );
        let mut moved = zeros(self.total);
        for (corner, own) in self
            .corners
            .iter()
            .zip(packed.chunks_exact(self.components))
        {
            for (moved, own) in moved.iter_mut().zip(own) {
                moved[*corner] = *own;
            }
        }
        moved
    }
}
