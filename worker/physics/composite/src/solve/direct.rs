//! The factor of a grid's matrix, for the displacements that are free.
use loadframe_numerics::SparseCholesky;

use crate::matrix::{GridMatrix, STEPS};
use crate::solve::order::nested_dissection;
use crate::supports::Supports;

/// Place of a displacement that is not free.
const HELD: u32 = u32::MAX;

/// A pivot so small against its diagonal that only round-off keeps it from 0.
const SINGULAR: f64 = 1e-13;

/// Why a matrix has no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoFactor {
    /// It is not positive definite; seen at this displacement.
    Indefinite { displacement: usize },
    /// It does not fit into memory.
    TooLarge,
}

impl From<loadframe_numerics::NoFactor> for NoFactor {
    fn from(error: loadframe_numerics::NoFactor) -> Self {
        match error {
            loadframe_numerics::NoFactor::Indefinite { unknown } => Self::Indefinite {
                displacement: unknown,
            },
            loadframe_numerics::NoFactor::TooLarge => Self::TooLarge,
        }
    }
}

/// The pattern of a matrix and its factor, made once, and the factor's values.
#[derive(Debug)]
pub(crate) struct Direct {
    /// Where in the grid's matrix each entry comes from.
    sources: Vec<u32>,
    factor: SparseCholesky,
}

impl Direct {
    /// Analyses the pattern.
    pub(crate) fn new(matrix: &GridMatrix, supports: &Supports) -> Result<Self, NoFactor> {
        let mut place = vec![HELD; 2 * matrix.particles()];
        let mut free = Vec::new();
        for particle in nested_dissection(matrix.per_row, matrix.rows) {
            for displacement in [2 * particle, 2 * particle + 1] {
                if !supports.is_held(displacement as usize) {
                    place[displacement as usize] = free.len() as u32;
                    free.push(displacement);
                }
            }
        }
        let mut starts = Vec::with_capacity(free.len() + 1);
        let mut rows = Vec::new();
        let mut sources = Vec::new();
        let mut column = Vec::with_capacity(18);
        for (at, &displacement) in free.iter().enumerate() {
            starts.push(rows.len() as u32);
            column.clear();
            let (particle, axis) = (displacement as usize / 2, displacement as usize % 2);
            for (kind, &(dx, dy)) in STEPS.iter().enumerate() {
                let mut visit = |other: usize, owner: usize, is_own: bool| {
                    for other_axis in 0..2 {
                        let row = place[2 * other + other_axis];
                        // held ones lie beyond every place
                        if row as usize <= at {
                            let entry = if is_own {
                                2 * axis + other_axis
                            } else {
                                2 * other_axis + axis
                            };
                            column.push((row, (owner * 20 + kind * 4 + entry) as u32));
                        }
                    }
                };
                if let Some(other) = matrix.neighbour(particle, (dx, dy)) {
                    visit(other, particle, true);
                }
                if kind > 0
                    && let Some(other) = matrix.neighbour(particle, (-dx, -dy))
                {
                    visit(other, other, false);
                }
            }
            column.sort_unstable();
            rows.extend(column.iter().map(|entry| entry.0));
            sources.extend(column.iter().map(|entry| entry.1));
        }
        starts.push(rows.len() as u32);
        Ok(Self {
            sources,
            factor: SparseCholesky::new(free, starts, rows)?,
        })
    }

    /// Factors a matrix of the analysed pattern.
    pub(crate) fn factor(&mut self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        self.factor.factor(self.sources.iter().map(|&source| {
            let source = source as usize;
            matrix.blocks[source / 20][source % 20 / 4][source % 4]
        }))?;
        self.refuse_tiny_pivots(matrix)
    }

    /// Round-off can leave a zero pivot slightly positive.
    fn refuse_tiny_pivots(&self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        let tiny = self.factor.find_pivot(|displacement, pivot| {
            let ratio = pivot / matrix.diagonal(displacement);
            ratio < SINGULAR || ratio.is_nan()
        });
        match tiny {
            Some(displacement) => Err(NoFactor::Indefinite { displacement }),
            None => Ok(()),
        }
    }

    /// As [`SparseCholesky::solve`].
    pub(crate) fn solve(&self, right: &[f64], solution: &mut [f64]) {
        self.factor.solve(right, solution);
    }

    /// As [`SparseCholesky::solve_several`].
    pub(crate) fn solve_several(&self, columns: &mut [Vec<f64>]) {
        self.factor.solve_several(columns);
    }
}
