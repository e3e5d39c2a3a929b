//! Sparse Cholesky factors of a grid's matrix, for the displacements that are free.
//!
//! `faer` factors supernodes; the order is ours. It works on one thread, so that the same matrix
//! gives the same bytes on any machine with the same vector instructions.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

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

/// The pattern of a matrix and its factor, made once, and the factor's values.
#[derive(Debug)]
pub(crate) struct Direct {
    /// Free displacements in order of elimination.
    free: Vec<u32>,
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// Where in the grid's matrix each entry comes from.
    sources: Vec<u32>,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    entries: Vec<f64>,
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
                        // Held ones lie beyond every place. Upper half: with its own order given,
                        // faer's analysis reads that one whatever side it is told.
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
        let pattern =
            SymbolicSparseColMatRef::new_checked(free.len(), free.len(), &starts, None, &rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|_| NoFactor::TooLarge)?;
        let values = vec![0.0; symbolic.len_val()];
        let entries = vec![0.0; rows.len()];
        Ok(Self {
            free,
            starts,
            rows,
            sources,
            symbolic,
            values,
            entries,
        })
    }

    /// Factors a matrix of the analysed pattern.
    pub(crate) fn factor(&mut self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        for (entry, &source) in self.entries.iter_mut().zip(&self.sources) {
            let source = source as usize;
            *entry = matrix.blocks[source / 20][source % 20 / 4][source % 4];
        }
        let size = self.free.len();
        let pattern =
            SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.rows);
        let scratch = self
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| NoFactor::TooLarge)?;
        let outcome = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            SparseColMatRef::new(pattern, &self.entries),
            Side::Upper,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        match outcome {
            Ok(_) => self.refuse_tiny_pivots(matrix),
            Err(LltError::NonPositivePivot { index }) => Err(NoFactor::Indefinite {
                displacement: self.free[index.min(size - 1)] as usize,
            }),
        }
    }

    /// Round-off can leave a zero pivot slightly positive.
    fn refuse_tiny_pivots(&self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
        use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            return Ok(());
        };
        let factor = SupernodalLltRef::new(symbolic, &self.values);
        for node in 0..symbolic.n_supernodes() {
            let part = factor.supernode(node);
            let values = part.val();
            for column in 0..values.ncols() {
                let pivot = values[(column, column)];
                let displacement = self.free[part.start() + column] as usize;
                let ratio = pivot * pivot / matrix.diagonal(displacement);
                if ratio < SINGULAR || ratio.is_nan() {
                    return Err(NoFactor::Indefinite { displacement });
                }
            }
        }
        Ok(())
    }

    /// Solves for the free displacements: reads the right-hand side there, and writes the solution
    /// there; all others become 0.
    pub(crate) fn solve(&self, right: &[f64], solution: &mut [f64]) {
        let mut column: Vec<f64> = self.free.iter().map(|&d| right[d as usize]).collect();
        self.solve_free(&mut column, 1);
        solution.fill(0.0);
        for (&displacement, value) in self.free.iter().zip(&column) {
            solution[displacement as usize] = *value;
        }
    }

    /// As [`Direct::solve`], of several right-hand sides at once, each of which becomes its
    /// solution: one pass over the factor for all of them.
    pub(crate) fn solve_several(&self, columns: &mut [Vec<f64>]) {
        let mut free = Vec::with_capacity(columns.len() * self.free.len());
        for column in columns.iter() {
            free.extend(self.free.iter().map(|&d| column[d as usize]));
        }
        self.solve_free(&mut free, columns.len());
        for (column, solved) in columns.iter_mut().zip(free.chunks(self.free.len().max(1))) {
            column.fill(0.0);
            for (&displacement, value) in self.free.iter().zip(solved) {
                column[displacement as usize] = *value;
            }
        }
    }

    /// Solves in place, columns one after the other.
    fn solve_free(&self, columns: &mut [f64], count: usize) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(count, Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(columns, self.free.len(), count),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}
