//! The factor of a grid's matrix, for the displacements that are free.
use loadframe_numerics::{NoFactor, SparseCholesky};

use crate::matrix::{GridMatrix, STEPS};
use crate::solve::order::nested_dissection;
use crate::supports::Supports;

/// Place of a displacement that is not free.
const HELD: u32 = u32::MAX;

/// A pivot so small against its diagonal that only round-off keeps it from 0.
const SINGULAR: f64 = 1e-13;

/// A displacement in the middle of a grid touches 18, half of which come before it.
const ENTRIES: usize = 10;

/// The block between a particle and another one that is eliminated no later.
struct Beside {
    particle: usize,
    /// Where the block begins among the matrix' values.
    begin: usize,
    /// Whether its rows are of the particle itself; else they are of the other one.
    is_own: bool,
}

/// Blocks between a particle and itself and those around it that have free displacements, in the order of
/// their elimination.
fn blocks_beside(matrix: &GridMatrix, particle: usize, place: &[u32], found: &mut Vec<Beside>) {
    const BLOCK: usize = 4;
    let first = |particle: usize| place[2 * particle].min(place[2 * particle + 1]);
    found.clear();
    for (kind, &(dx, dy)) in STEPS.iter().enumerate() {
        let begin = |owner: usize| BLOCK * (STEPS.len() * owner + kind);
        let after = matrix.neighbour(particle, (dx, dy)).map(|other| Beside {
            particle: other,
            begin: begin(particle),
            is_own: true,
        });
        let before = matrix.neighbour(particle, (-dx, -dy)).map(|other| Beside {
            particle: other,
            begin: begin(other),
            is_own: false,
        });
        found.extend(after);
        found.extend(before.filter(|_| kind > 0));
    }
    let own = first(particle);
    found.retain(|other| first(other.particle) <= own);
    found.sort_unstable_by_key(|other| first(other.particle));
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
        let mut rows = Vec::with_capacity(ENTRIES * free.len());
        let mut sources = Vec::with_capacity(ENTRIES * free.len());
        let mut beside = Vec::with_capacity(9);
        // both of a particle's displacements touch the same others
        for own in free.chunk_by(|a, b| a / 2 == b / 2) {
            blocks_beside(matrix, own[0] as usize / 2, &place, &mut beside);
            for &displacement in own {
                let (at, axis) = (starts.len(), displacement as usize % 2);
                starts.push(rows.len() as u32);
                for block in &beside {
                    for other_axis in 0..2 {
                        let row = place[2 * block.particle + other_axis];
                        // held ones lie beyond every place
                        if row as usize <= at {
                            let [first, second] = if block.is_own {
                                [axis, other_axis]
                            } else {
                                [other_axis, axis]
                            };
                            rows.push(row);
                            sources.push((block.begin + 2 * first + second) as u32);
                        }
                    }
                }
            }
        }
        starts.push(rows.len() as u32);
        Ok(Self {
            sources,
            factor: SparseCholesky::new(free, starts, rows)?,
        })
    }

    /// Factors a matrix of the analysed pattern.
    pub(crate) fn factor(&mut self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        let values = matrix.blocks.as_flattened().as_flattened();
        let entries = self.sources.iter().map(|&source| values[source as usize]);
        self.factor.factor(entries)?;
        self.refuse_tiny_pivots(matrix)
    }

    /// Round-off can leave a zero pivot slightly positive.
    fn refuse_tiny_pivots(&self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        let tiny = self.factor.find_pivot(|displacement, pivot| {
            let ratio = pivot / matrix.diagonal(displacement);
            ratio < SINGULAR || ratio.is_nan()
        });
        match tiny {
            Some(unknown) => Err(NoFactor::Indefinite { unknown }),
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
