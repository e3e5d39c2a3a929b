//! Symmetric matrices over the particles of a grid: every particle touches its eight neighbours.
//!
//! Kept are the block of a particle with itself and those with four of its neighbours; the other
//! four are the transposes kept at the neighbours. 160 bytes a particle, no indices.

/// Where a neighbour stands: itself, east, north-west, north, north-east.
pub(crate) const STEPS: [(isize, isize); 5] = [(0, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

/// A 2 × 2 block by rows.
pub(crate) type Block = [f64; 4];

/// A symmetric matrix over the displacements of a grid's particles [N/mm].
#[derive(Debug, Clone)]
pub(crate) struct GridMatrix {
    pub(crate) per_row: usize,
    pub(crate) rows: usize,
    pub(crate) blocks: Vec<[Block; 5]>,
}

impl GridMatrix {
    pub(crate) fn zeros(per_row: usize, rows: usize) -> Self {
        Self {
            per_row,
            rows,
            blocks: vec![[[0.0; 4]; 5]; per_row * rows],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.blocks.fill([[0.0; 4]; 5]);
    }

    pub(crate) fn particles(&self) -> usize {
        self.blocks.len()
    }

    /// Particle number `(i, j)` after a step, if it is on the grid.
    pub(crate) fn neighbour(&self, particle: usize, step: (isize, isize)) -> Option<usize> {
        let i = (particle % self.per_row).checked_add_signed(step.0)?;
        let j = (particle / self.per_row).checked_add_signed(step.1)?;
        (i < self.per_row && j < self.rows).then(|| j * self.per_row + i)
    }

    /// Adds a matrix over the four corners of the cell whose lower left corner is `lower`.
    pub(crate) fn add_cell(&mut self, lower: usize, matrix: &[[f64; 8]; 8]) {
        let upper = lower + self.per_row;
        // Particle, place of the neighbour's block, and the two corners in the cell.
        let places = [
            (lower, 0, 0, 0),
            (lower + 1, 0, 1, 1),
            (upper + 1, 0, 2, 2),
            (upper, 0, 3, 3),
            (lower, 1, 0, 1),
            (upper, 1, 3, 2),
            (lower, 3, 0, 3),
            (lower + 1, 3, 1, 2),
            (lower, 4, 0, 2),
            (lower + 1, 2, 1, 3),
        ];
        for (particle, place, row, column) in places {
            let block = &mut self.blocks[particle][place];
            for (entry, value) in block.iter_mut().enumerate() {
                *value += matrix[2 * row + entry / 2][2 * column + entry % 2];
            }
        }
    }

    /// Adds a spring between neighbours: +block on the diagonal, -block between.
    pub(crate) fn add_spring(&mut self, [first, second]: [usize; 2], block: Block) {
        let (from, to) = (first.min(second), first.max(second));
        let place = self.place(from, to);
        for (entry, value) in block.iter().enumerate() {
            self.blocks[from][0][entry] += value;
            self.blocks[to][0][entry] += value;
            self.blocks[from][place][entry] -= value;
        }
    }

    /// Adds a symmetric matrix over two neighbours, the earlier one first.
    pub(crate) fn add_pair(&mut self, [first, second]: [usize; 2], matrix: &[[f64; 4]; 4]) {
        let place = self.place(first, second);
        for (particle, place, row, column) in
            [(first, 0, 0, 0), (second, 0, 2, 2), (first, place, 0, 2)]
        {
            for (entry, value) in self.blocks[particle][place].iter_mut().enumerate() {
                *value += matrix[row + entry / 2][column + entry % 2];
            }
        }
    }

    /// Adds weight times a block between two particles of one cell, and its transpose on the other
    /// side, which is what a `diagonal` block already is.
    pub(crate) fn add_block(
        &mut self,
        [row, column]: [usize; 2],
        weight: f64,
        block: Block,
        diagonal: bool,
    ) {
        let (owner, place, transposed) = if row <= column {
            (row, self.place(row, column), false)
        } else {
            (column, self.place(column, row), true)
        };
        // A diagonal block of the finer matrix meets every pair of parents from both sides: only
        // one of them is kept. One between two particles is met once and counts for both sides,
        // so that on the diagonal it and its transpose are added.
        if diagonal && transposed {
            return;
        }
        let [a, b, c, d] = block;
        let turned = [a, c, b, d];
        let added = if transposed { turned } else { block };
        let target = &mut self.blocks[owner][place];
        for (entry, value) in target.iter_mut().zip(added) {
            *entry += weight * value;
        }
        if row == column && !diagonal {
            for (entry, value) in target.iter_mut().zip(turned) {
                *entry += weight * value;
            }
        }
    }

    /// Where the block between a particle and a later one of the same cell is kept.
    fn place(&self, from: usize, to: usize) -> usize {
        let (left, right) = (from % self.per_row, to % self.per_row);
        if from == to {
            0
        } else if from / self.per_row == to / self.per_row {
            1
        } else if right < left {
            2
        } else {
            3 + usize::from(right > left)
        }
    }

    /// y = A x.
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.rows {
            for i in 0..self.per_row {
                let particle = j * self.per_row + i;
                let own = [x[2 * particle], x[2 * particle + 1]];
                let blocks = &self.blocks[particle];
                let mut sum = times(&blocks[0], own);
                let on_grid = [
                    i + 1 < self.per_row,
                    i > 0 && j + 1 < self.rows,
                    j + 1 < self.rows,
                    i + 1 < self.per_row && j + 1 < self.rows,
                ];
                let neighbours = [
                    particle + 1,
                    (particle + self.per_row).wrapping_sub(1),
                    particle + self.per_row,
                    particle + self.per_row + 1,
                ];
                for place in 0..4 {
                    if on_grid[place] {
                        let block = &blocks[place + 1];
                        let other = neighbours[place];
                        let part = times(block, [x[2 * other], x[2 * other + 1]]);
                        sum[0] += part[0];
                        sum[1] += part[1];
                        y[2 * other] += block[0] * own[0] + block[2] * own[1];
                        y[2 * other + 1] += block[1] * own[0] + block[3] * own[1];
                    }
                }
                y[2 * particle] += sum[0];
                y[2 * particle + 1] += sum[1];
            }
        }
    }

    /// Σⱼ |Aᵢⱼ| over what is not `held`; 0 where i is.
    pub(crate) fn absolute_row_sums(&self, held: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut sums = vec![0.0; 2 * self.particles()];
        for particle in 0..self.particles() {
            for (kind, &step) in STEPS.iter().enumerate() {
                let Some(other) = self.neighbour(particle, step) else {
                    continue;
                };
                for (entry, value) in self.blocks[particle][kind].iter().enumerate() {
                    let (row, column) = (2 * particle + entry / 2, 2 * other + entry % 2);
                    if !held(row) && !held(column) {
                        sums[row] += value.abs();
                        if kind > 0 {
                            sums[column] += value.abs();
                        }
                    }
                }
            }
        }
        sums
    }

    /// Diagonal entry of a displacement.
    pub(crate) fn diagonal(&self, displacement: usize) -> f64 {
        self.blocks[displacement / 2][0][3 * (displacement % 2)]
    }
}

/// Σ a · b, one after the other.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times(block: &Block, x: [f64; 2]) -> [f64; 2] {
    [
        block[0] * x[0] + block[1] * x[1],
        block[2] * x[0] + block[3] * x[1],
    ]
}
