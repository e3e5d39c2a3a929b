//! The inverse of the coarsest grid's stiffness.
use nalgebra::{Cholesky, DMatrix};

use super::level::{Level, Vectors};
use crate::{network::field::dot, wide::wide};

/// Part of its trace added to each corner's stiffness: corners that nothing holds must not fly.
const TRACE_SHARE: f64 = 1e-3;

/// K⁻¹ between the corners that are not held.
#[derive(Debug)]
pub(super) struct Inverse {
    /// Corners it is about.
    corners: Vec<usize>,
    /// Row by row, three rows to a corner.
    rows: Vec<f32>,
    total: usize,
}

impl Inverse {
    pub(super) fn new(level: &Level) -> Self {
        let total = level.corners();
        let corners: Vec<usize> = (0..total).filter(|c| !level.is_held(*c)).collect();
        let mut number = vec![usize::MAX; total];
        for (index, corner) in corners.iter().enumerate() {
            number[*corner] = index;
        }
        let size = 3 * corners.len();
        let mut matrix: DMatrix<f64> = DMatrix::zeros(size, size);
        level.each_block(|a, b, block| {
            let (a, b) = (number[a], number[b]);
            if a == usize::MAX || b == usize::MAX {
                return;
            }
            let [xx, yy, xy, zz, xz, yz] = block.map(f64::from);
            let entries = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            for (i, row) in entries.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    matrix[(3 * b + j, 3 * a + i)] += entry;
                    if a != b {
                        matrix[(3 * a + i, 3 * b + j)] += entry;
                    }
                }
            }
        });
        let mean = matrix.trace() / size as f64;
        for corner in 0..corners.len() {
            let own = 3 * corner..3 * corner + 3;
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
        let rows = match Cholesky::new(matrix) {
            Some(factor) => factor.inverse().iter().map(|entry| *entry as f32).collect(),
            // rounding of numbers too far apart: no correction is better than a wrong one
            None => vec![0.0; size * size],
        };
        Self {
            corners,
            rows,
            total,
        }
    }

    /// Displacements under `force`.
    pub(super) fn apply(&self, force: &Vectors) -> Vectors {
        let components = self
            .corners
            .iter()
            .flat_map(|corner| [0, 1, 2].map(|axis| force[axis][*corner]));
        let packed: Vec<f32> = components.collect();
        let mut moved = [0, 1, 2].map(|_| vec![0.0; self.total]);
        wide(
            #[inline(always)]
            || {
                let rows = self.rows.chunks_exact(packed.len().max(1));
                for (number, row) in rows.enumerate() {
                    moved[number % 3][self.corners[number / 3]] = dot(row, &packed) as f32;
                }
            },
        );
        moved
    }
}
