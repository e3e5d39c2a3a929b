//! Conjugate gradients, preconditioned by a multigrid cycle, for grids too large to factor.
//!
//! Every second line of particles makes the next coarser grid; displacements between its particles
//! are bilinear, and its matrix is the one that gives them the same energy (Galerkin). The coarsest
//! grid is factored. A sweep of block Gauss-Seidel forwards before, and backwards after the coarser
//! grid's correction makes the cycle symmetric, as conjugate gradients need it. Everything runs in
//! one fixed order. The grids, their cycle and the iterations it preconditions are one method, and one file.
//!
//! Source: [BriggsHensonMcCormick2000], chapters 3 and 8.
use loadframe_numerics::{
    NoFactor, Team,
    equilibrium::{Ended, Enough, Found, Gradients, Preconditioned},
};

use crate::matrix::{Block, GridMatrix, STEPS, dot};
use crate::section::Grid;
use crate::solve::direct::Direct;
use crate::supports::Supports;

/// Grids of at most so many particles are factored: as long as it takes less than a sweep of a
/// finer one.
pub(crate) const COARSEST: usize = 12_000;

/// Iterations after which something is wrong.
const MOST_ITERATIONS: usize = 2_000;

/// One grid of the hierarchy.
#[derive(Debug)]
struct Level {
    matrix: GridMatrix,
    held: Vec<bool>,
    /// Inverses of the diagonal blocks over free displacements.
    inverses: Vec<Block>,
    /// How this grid's lines lie between those of the next coarser one.
    x: Vec<Between>,
    y: Vec<Between>,
    right: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
}

/// A line between two coarser lines: the lower one, and the weight of the one after it.
#[derive(Debug, Clone, Copy)]
struct Between {
    lower: usize,
    weight: f64,
}

/// The hierarchy of grids, and the vectors of iterations on the finest.
#[derive(Debug)]
pub(crate) struct Multigrid {
    hierarchy: Hierarchy,
    vectors: Gradients<2>,
}

#[derive(Debug)]
struct Hierarchy {
    /// From the finest on; the finest's matrix is a copy of the lattice's.
    levels: Vec<Level>,
    coarsest: Direct,
    coarsest_matrix: GridMatrix,
    right: Vec<f64>,
    solution: Vec<f64>,
}

/// Every second line, and the last.
fn coarser(lines: &[f64]) -> (Vec<f64>, Vec<Between>) {
    let last = lines.len() - 1;
    let mut kept: Vec<usize> = (0..=last).step_by(2).collect();
    if last % 2 == 1 {
        kept.push(last);
    }
    let mut between = Vec::with_capacity(lines.len());
    for (line, place) in lines.iter().enumerate() {
        let lower = (line / 2).min(kept.len() - 2);
        let (from, to) = (lines[kept[lower]], lines[kept[lower + 1]]);
        between.push(Between {
            lower,
            weight: (place - from) / (to - from),
        });
    }
    (kept.iter().map(|&line| lines[line]).collect(), between)
}

impl Multigrid {
    /// Makes the hierarchy of a grid, down to at most `coarsest` particles.
    pub(crate) fn new(grid: &Grid, supports: &Supports, coarsest: usize) -> Result<Self, NoFactor> {
        let mut x_mm = grid.x_mm().to_vec();
        let mut y_mm = grid.y_mm().to_vec();
        let mut held: Vec<bool> = (0..2 * grid.particles())
            .map(|displacement| supports.is_held(displacement))
            .collect();
        let mut levels = Vec::new();
        while x_mm.len() * y_mm.len() > coarsest && x_mm.len() > 3 && y_mm.len() > 3 {
            let (coarse_x, x) = coarser(&x_mm);
            let (coarse_y, y) = coarser(&y_mm);
            let size = 2 * x_mm.len() * y_mm.len();
            let coarse_held = held_above(&held, &x, &y, coarse_x.len(), coarse_y.len());
            levels.push(Level {
                matrix: GridMatrix::zeros(x_mm.len(), y_mm.len()),
                inverses: vec![[0.0; 4]; size / 2],
                held: std::mem::replace(&mut held, coarse_held),
                x,
                y,
                right: vec![0.0; size],
                solution: vec![0.0; size],
                residual: vec![0.0; size],
            });
            x_mm = coarse_x;
            y_mm = coarse_y;
        }
        let coarsest_matrix = GridMatrix::zeros(x_mm.len(), y_mm.len());
        let size = 2 * coarsest_matrix.particles();
        let coarsest = Direct::new(&coarsest_matrix, &Supports::held_at(&held))?;
        Ok(Self {
            hierarchy: Hierarchy {
                levels,
                coarsest,
                coarsest_matrix,
                right: vec![0.0; size],
                solution: vec![0.0; size],
            },
            vectors: Gradients::new(grid.particles()),
        })
    }

    /// Makes the coarser matrices of a finest one.
    pub(crate) fn prepare(&mut self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        self.hierarchy.prepare(matrix)
    }

    /// Solves to a residual of `tolerance` times the right-hand side, or as near as round-off
    /// allows; the number of iterations.
    pub(crate) fn solve(
        &mut self,
        matrix: &GridMatrix,
        right: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Result<u64, NoFactor> {
        let found = self.iterate(matrix, right, solution, tolerance);
        match found.ended {
            Ended::Near | Ended::Spent(_) => Ok(found.iterations as u64),
            Ended::CurvesDown(_) => Err(NoFactor::Indefinite { unknown: 0 }),
        }
    }

    /// Whether iterations come that near, with no direction along which the matrix curves down.
    pub(crate) fn converges(
        &mut self,
        matrix: &GridMatrix,
        right: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> bool {
        self.iterate(matrix, right, solution, tolerance).ended == Ended::Near
    }

    fn iterate(
        &mut self,
        matrix: &GridMatrix,
        right: &[f64],
        solution: &mut [f64],
        tolerance: f64,
    ) -> Found {
        let Self { hierarchy, vectors } = self;
        solution.fill(0.0);
        let residual = vectors.residual.as_flattened_mut();
        residual.copy_from_slice(right);
        hierarchy.release(residual);
        vectors.solve(
            &mut Finest { hierarchy, matrix },
            &Team::alone(),
            solution.as_chunks_mut().0,
            Enough::Residual(tolerance),
            MOST_ITERATIONS,
        )
    }
}

/// The finest grid's equations, preconditioned by a cycle.
struct Finest<'a> {
    hierarchy: &'a mut Hierarchy,
    matrix: &'a GridMatrix,
}

impl Preconditioned<2> for Finest<'_> {
    fn apply(&mut self, motion: &[[f64; 2]], forces: &mut [[f64; 2]]) -> f64 {
        let (motion, forces) = (motion.as_flattened(), forces.as_flattened_mut());
        self.matrix.multiply(motion, forces);
        self.hierarchy.release(forces);
        dot(motion, forces)
    }

    fn precondition(&mut self, residual: &[[f64; 2]], corrected: &mut [[f64; 2]]) -> f64 {
        let (residual, corrected) = (residual.as_flattened(), corrected.as_flattened_mut());
        corrected.copy_from_slice(self.hierarchy.cycle(residual));
        dot(residual, corrected)
    }
}

impl Hierarchy {
    /// Makes the coarser matrices of a finest one.
    fn prepare(&mut self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        if let Some(first) = self.levels.first_mut() {
            first.matrix.blocks.copy_from_slice(&matrix.blocks);
        } else {
            self.coarsest_matrix.blocks.copy_from_slice(&matrix.blocks);
        }
        for place in 0..self.levels.len() {
            let (finer, rest) = self.levels.split_at_mut(place + 1);
            let finer = &mut finer[place];
            finer.invert_diagonal()?;
            let target = rest
                .first_mut()
                .map_or(&mut self.coarsest_matrix, |level| &mut level.matrix);
            finer.coarsen_into(target);
        }
        self.coarsest.factor(&self.coarsest_matrix)
    }

    fn release(&self, values: &mut [f64]) {
        if let Some(level) = self.levels.first() {
            level.release(values);
        }
    }

    /// One cycle for a residual of the finest grid.
    fn cycle(&mut self, residual: &[f64]) -> &[f64] {
        let depth = self.levels.len();
        if depth == 0 {
            self.coarsest.solve(residual, &mut self.solution);
            return &self.solution;
        }
        self.levels[0].right.copy_from_slice(residual);
        for place in 0..depth {
            let (finer, rest) = self.levels.split_at_mut(place + 1);
            let finer = &mut finer[place];
            finer.solution.fill(0.0);
            finer.sweep(true);
            let coarse = rest
                .first_mut()
                .map_or(&mut self.right, |level| &mut level.right);
            finer.restrict_residual(coarse);
        }
        self.coarsest.solve(&self.right, &mut self.solution);
        for place in (0..depth).rev() {
            let (finer, rest) = self.levels.split_at_mut(place + 1);
            let finer = &mut finer[place];
            let coarse = rest.first().map_or(&self.solution, |level| &level.solution);
            finer.add_correction(coarse);
            finer.sweep(false);
        }
        &self.levels[0].solution
    }
}

/// A coarser particle is held where the particle in the same place is.
fn held_above(
    held: &[bool],
    x: &[Between],
    y: &[Between],
    per_row: usize,
    rows: usize,
) -> Vec<bool> {
    let same = |lines: &[Between], coarse: usize| {
        lines.iter().position(|line| {
            (line.lower == coarse && line.weight.abs() < f64::EPSILON)
                || (line.lower + 1 == coarse && (line.weight - 1.0).abs() < f64::EPSILON)
        })
    };
    let mut above = vec![false; 2 * per_row * rows];
    let columns: Vec<_> = (0..per_row).map(|i| same(x, i)).collect();
    for j in 0..rows {
        let Some(fine_j) = same(y, j) else { continue };
        for (i, fine_i) in columns.iter().enumerate() {
            let Some(fine_i) = fine_i else { continue };
            for axis in 0..2 {
                above[2 * (j * per_row + i) + axis] = held[2 * (fine_j * x.len() + fine_i) + axis];
            }
        }
    }
    above
}

impl Level {
    fn release(&self, values: &mut [f64]) {
        for (value, held) in values.iter_mut().zip(&self.held) {
            if *held {
                *value = 0.0;
            }
        }
    }

    /// The coarser particles a particle's displacement is made of, and their weights.
    fn parents(&self, i: usize, j: usize, coarse_per_row: usize) -> [(usize, f64); 4] {
        let (x, y) = (self.x[i], self.y[j]);
        let lower = y.lower * coarse_per_row + x.lower;
        [
            (lower, (1.0 - x.weight) * (1.0 - y.weight)),
            (lower + 1, x.weight * (1.0 - y.weight)),
            (lower + coarse_per_row, (1.0 - x.weight) * y.weight),
            (lower + coarse_per_row + 1, x.weight * y.weight),
        ]
    }

    fn invert_diagonal(&mut self) -> Result<(), NoFactor> {
        for particle in 0..self.matrix.particles() {
            let [mut xx, mut xy, _, mut yy] = self.matrix.blocks[particle][0];
            let [held_x, held_y] = [self.held[2 * particle], self.held[2 * particle + 1]];
            if held_x {
                (xx, xy) = (1.0, 0.0);
            }
            if held_y {
                (yy, xy) = (1.0, 0.0);
            }
            let determinant = xx * yy - xy * xy;
            if xx <= 0.0 || determinant <= 0.0 {
                return Err(NoFactor::Indefinite {
                    unknown: 2 * particle,
                });
            }
            let inverse = [
                yy / determinant,
                -xy / determinant,
                -xy / determinant,
                xx / determinant,
            ];
            self.inverses[particle] = [
                if held_x { 0.0 } else { inverse[0] },
                inverse[1],
                inverse[2],
                if held_y { 0.0 } else { inverse[3] },
            ];
        }
        Ok(())
    }

    /// Pᵀ A P, held displacements left out of P.
    fn coarsen_into(&self, coarse: &mut GridMatrix) {
        coarse.clear();
        let fine = &self.matrix;
        for particle in 0..fine.particles() {
            let (i, j) = (particle % fine.per_row, particle / fine.per_row);
            let own = self.parents(i, j, coarse.per_row);
            for (kind, &step) in STEPS.iter().enumerate() {
                let Some(other) = fine.neighbour(particle, step) else {
                    continue;
                };
                let mut block = fine.blocks[particle][kind];
                for (entry, value) in block.iter_mut().enumerate() {
                    if self.held[2 * particle + entry / 2] || self.held[2 * other + entry % 2] {
                        *value = 0.0;
                    }
                }
                let (oi, oj) = (other % fine.per_row, other / fine.per_row);
                let parents = self.parents(oi, oj, coarse.per_row);
                for &(row, row_weight) in &own {
                    for &(column, column_weight) in &parents {
                        let weight = row_weight * column_weight;
                        if weight != 0.0 {
                            coarse.add_block([row, column], weight, block, kind == 0);
                        }
                    }
                }
            }
        }
    }

    /// Block Gauss-Seidel over all particles, forwards or backwards.
    fn sweep(&mut self, forwards: bool) {
        let per_row = self.matrix.per_row;
        let rows = self.matrix.rows;
        let count = per_row * rows;
        let (blocks, x) = (&self.matrix.blocks, &mut self.solution);
        for turn in 0..count {
            let particle = if forwards { turn } else { count - 1 - turn };
            let (i, j) = (particle % per_row, particle / per_row);
            let mut sum = [self.right[2 * particle], self.right[2 * particle + 1]];
            let mut take = |block: &Block, other: usize| {
                sum[0] -= block[0] * x[2 * other] + block[1] * x[2 * other + 1];
                sum[1] -= block[2] * x[2 * other] + block[3] * x[2 * other + 1];
            };
            let (left, right) = (i > 0, i + 1 < per_row);
            let own = &blocks[particle];
            if right {
                take(&own[1], particle + 1);
            }
            if j + 1 < rows {
                let above = particle + per_row;
                if left {
                    take(&own[2], above - 1);
                }
                take(&own[3], above);
                if right {
                    take(&own[4], above + 1);
                }
            }
            let mut take_back = |other: usize, kind: usize| {
                let [a, b, c, d] = blocks[other][kind];
                take(&[a, c, b, d], other);
            };
            if left {
                take_back(particle - 1, 1);
            }
            if j > 0 {
                let below = particle - per_row;
                if right {
                    take_back(below + 1, 2);
                }
                take_back(below, 3);
                if left {
                    take_back(below - 1, 4);
                }
            }
            let inverse = &self.inverses[particle];
            // A held displacement stays 0, and so takes nothing from the diagonal block.
            x[2 * particle] = inverse[0] * sum[0] + inverse[1] * sum[1];
            x[2 * particle + 1] = inverse[2] * sum[0] + inverse[3] * sum[1];
        }
    }

    fn restrict_residual(&mut self, coarse: &mut [f64]) {
        let mut residual = std::mem::take(&mut self.residual);
        self.matrix.multiply(&self.solution, &mut residual);
        coarse.fill(0.0);
        let coarse_per_row = self.x[self.x.len() - 1].lower + 2;
        for j in 0..self.y.len() {
            for i in 0..self.x.len() {
                let particle = j * self.x.len() + i;
                for (parent, weight) in self.parents(i, j, coarse_per_row) {
                    for axis in 0..2 {
                        let displacement = 2 * particle + axis;
                        if !self.held[displacement] {
                            coarse[2 * parent + axis] +=
                                weight * (self.right[displacement] - residual[displacement]);
                        }
                    }
                }
            }
        }
        self.residual = residual;
    }

    fn add_correction(&mut self, coarse: &[f64]) {
        let coarse_per_row = self.x[self.x.len() - 1].lower + 2;
        for j in 0..self.y.len() {
            for i in 0..self.x.len() {
                let particle = j * self.x.len() + i;
                for (parent, weight) in self.parents(i, j, coarse_per_row) {
                    for axis in 0..2 {
                        let displacement = 2 * particle + axis;
                        if !self.held[displacement] {
                            self.solution[displacement] += weight * coarse[2 * parent + axis];
                        }
                    }
                }
            }
        }
    }
}
