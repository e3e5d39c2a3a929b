//! Sparse Cholesky factors, given the order of elimination.
//!
//! `faer` factors supernodes on one thread. Every x86-64 processor with AVX2 and FMA gives the same bytes, with
//! or without AVX-512, and whatever its caches: each entry is one chain of fused products in the order of the
//! columns, cut every 512 of them, of which wider vectors only take more side by side. A test holds the bytes.
//! Processors of other families, and those without FMA (before 2013), round otherwise in the last digits.
//! Some unknowns may be held: they have no place in the matrix.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Why a matrix has no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoFactor {
    /// Seen at this unknown.
    #[error("the matrix is not positive definite, seen at unknown {unknown}")]
    Indefinite { unknown: usize },
    #[error("the factor does not fit into memory")]
    TooLarge,
}

/// The pattern of a matrix, analysed once, with its factor.
#[derive(Debug)]
pub struct SparseCholesky {
    /// Unknowns that are free, in order of elimination.
    free: Vec<u32>,
    starts: Vec<u32>,
    rows: Vec<u32>,
    entries: Vec<f64>,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
}

impl SparseCholesky {
    /// Analyses a pattern: of the matrix between the `free` unknowns, in order of elimination, the upper
    /// half with the diagonal, column by column. `starts` says where in `rows` each column begins, and at
    /// last where all end; rows are places in `free`, ascending in each column.
    ///
    /// # Errors
    /// [`NoFactor::TooLarge`].
    pub fn new(free: Vec<u32>, starts: Vec<u32>, rows: Vec<u32>) -> Result<Self, NoFactor> {
        let size = free.len();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        // with its own order given, the analysis reads the upper half whatever side it is told
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
        let mut values = Vec::new();
        values
            .try_reserve_exact(symbolic.len_val())
            .map_err(|_| NoFactor::TooLarge)?;
        values.resize(symbolic.len_val(), 0.0);
        Ok(Self {
            entries: vec![0.0; rows.len()],
            free,
            starts,
            rows,
            symbolic,
            values,
        })
    }

    /// Factors the matrix with these entries, in the order of the pattern's rows.
    ///
    /// # Errors
    /// Why there is no factor.
    pub fn factor(&mut self, entries: impl Iterator<Item = f64>) -> Result<(), NoFactor> {
        for (entry, value) in self.entries.iter_mut().zip(entries) {
            *entry = value;
        }
        self.factor_entries()
    }

    /// The entries of the matrix in the order of the pattern's rows, to be written where they are.
    pub fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Factors the matrix with the entries as they are.
    ///
    /// # Errors
    /// Why there is no factor.
    pub fn factor_entries(&mut self) -> Result<(), NoFactor> {
        let size = self.free.len();
        if size == 0 {
            return Ok(());
        }
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
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => Err(NoFactor::Indefinite {
                unknown: self.free[index.min(size - 1)] as usize,
            }),
        }
    }

    /// The first unknown, in order of elimination, of which `is_bad` says so, given the unknown and its
    /// pivot: the square of the factor's diagonal.
    pub fn find_pivot(&self, is_bad: impl Fn(usize, f64) -> bool) -> Option<usize> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            return None;
        };
        let factor = SupernodalLltRef::new(symbolic, &self.values);
        (0..symbolic.n_supernodes()).find_map(|node| {
            let part = factor.supernode(node);
            let values = part.val();
            (0..values.ncols()).find_map(|column| {
                let root = values[(column, column)];
                let unknown = self.free[part.start() + column] as usize;
                is_bad(unknown, root * root).then_some(unknown)
            })
        })
    }

    /// Solves for the free unknowns: reads the right side there, and writes the solution there; held ones
    /// become 0.
    pub fn solve(&self, right: &[f64], solution: &mut [f64]) {
        let mut column: Vec<f64> = self.free.iter().map(|&at| right[at as usize]).collect();
        self.solve_free(&mut column, 1);
        self.spread(&column, solution);
    }

    /// As [`Self::solve`], of several right sides at once, each of which becomes its solution: one pass
    /// over the factor for all of them.
    pub fn solve_several(&self, columns: &mut [Vec<f64>]) {
        let mut all = Vec::with_capacity(columns.len() * self.free.len());
        for column in columns.iter() {
            all.extend(self.free.iter().map(|&at| column[at as usize]));
        }
        self.solve_free(&mut all, columns.len());
        for (column, solved) in columns.iter_mut().zip(all.chunks(self.free.len().max(1))) {
            self.spread(solved, column);
        }
    }

    /// Number of unknowns that are free.
    pub fn size(&self) -> usize {
        self.free.len()
    }

    /// Stored entries of the factor.
    pub fn stored(&self) -> usize {
        self.values.len()
    }

    /// Multiplications that a factor takes, by its supernodes: n columns above m rows take
    /// n³/6 + n² m/2 + n m²/2.
    pub fn multiplications(&self) -> f64 {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            return 0.0;
        };
        let mut sum = 0.0;
        for node in 0..symbolic.n_supernodes() {
            let columns =
                (symbolic.supernode_end()[node] - symbolic.supernode_begin()[node]) as f64;
            let entries = symbolic.col_ptr_for_val()[node + 1] - symbolic.col_ptr_for_val()[node];
            let below = entries as f64 / columns - columns;
            sum += columns * (columns * columns / 3.0 + columns * below + below * below) / 2.0;
        }
        sum
    }

    /// Solves in place for `count` right sides, one after the other, each of the free unknowns in order of
    /// elimination.
    pub fn solve_free(&self, columns: &mut [f64], count: usize) {
        if self.free.is_empty() {
            return;
        }
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(count, Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(columns, self.free.len(), count),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    fn spread(&self, solved: &[f64], solution: &mut [f64]) {
        solution.fill(0.0);
        for (&at, value) in self.free.iter().zip(solved) {
            solution[at as usize] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of three springs of stiffness 1 between two walls: unknowns 1 and 3 of five are the
    /// points between, the second eliminated first.
    fn chain() -> SparseCholesky {
        SparseCholesky::new(vec![3, 1], vec![0, 1, 3], vec![0, 0, 1]).expect("it is small")
    }

    #[test]
    fn a_chain_of_springs_gives_way_as_springs_in_series_do() {
        let mut chain = chain();
        chain.factor([2.0, -1.0, 2.0].into_iter()).expect("held");
        // a force on the first point: one spring beside two in series, 1 + 1/2
        let mut moved = [7.0; 5];
        chain.solve(&[9.0, 1.0, 9.0, 0.0, 9.0], &mut moved);
        let expected = [0.0, 2.0 / 3.0, 0.0, 1.0 / 3.0, 0.0];
        for (found, expected) in moved.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{moved:?}");
        }
        let mut several = [vec![9.0, 1.0, 9.0, 0.0, 9.0], vec![0.0, 0.0, 0.0, 3.0, 0.0]];
        chain.solve_several(&mut several);
        assert_eq!(several[0], moved);
        assert!((several[1][3] - 2.0).abs() < 1e-15);
    }

    #[test]
    fn pivots_are_what_elimination_leaves() {
        let mut chain = chain();
        chain.factor([2.0, -1.0, 2.0].into_iter()).expect("held");
        // 2, and 2 - 1/2
        let is = |expected: f64| move |_, pivot: f64| (pivot - expected).abs() < 1e-15;
        assert_eq!(chain.find_pivot(is(2.0)), Some(3));
        assert_eq!(chain.find_pivot(is(1.5)), Some(1));
        assert_eq!(chain.find_pivot(is(1.0)), None);
    }

    #[test]
    fn a_matrix_that_is_not_positive_names_the_unknown() {
        let mut chain = chain();
        let refused = chain.factor([2.0, -3.0, 2.0].into_iter());
        assert_eq!(refused, Err(NoFactor::Indefinite { unknown: 1 }));
    }

    /// FNV-1a of the bits of numbers.
    fn digest(values: &[f64]) -> u64 {
        let bytes = values
            .iter()
            .flat_map(|value| value.to_bits().to_le_bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325, |sum, byte| {
            (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    }

    /// A grid of 24 by 24 blocks of 2, then 640 unknowns that all touch: small supernodes as of a section or
    /// a sheet, and one deep enough to be cut. `tests/run` has it on an emulated processor without AVX-512, too.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn factors_have_these_bytes_on_every_processor() {
        if !(std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma"))
        {
            return;
        }
        let (side, dense) = (24, 640);
        let grid = 2 * side * side;
        let size = grid + dense;
        let (mut starts, mut rows, mut entries) = (vec![0], Vec::new(), Vec::new());
        for column in 0..size {
            let is_beside = |row: usize| {
                let (p, q) = (row / 2, column / 2);
                let (dx, dy) = ((p % side).abs_diff(q % side), (p / side).abs_diff(q / side));
                dx <= 1 && dy <= 1
            };
            for row in 0..=column {
                let is_held = column >= grid && (row >= grid || (row + column) % 7 == 0);
                if row == column || is_held || (column < grid && is_beside(row)) {
                    rows.push(row as u32);
                    let off = ((row * 31 + column * 17) % 101) as f64 / 101.0 - 0.5;
                    entries.push(if row == column { size as f64 } else { off });
                }
            }
            starts.push(rows.len() as u32);
        }
        let free = (0..size as u32).collect();
        let mut factor = SparseCholesky::new(free, starts, rows).expect("it is small");
        factor
            .factor(entries.into_iter())
            .expect("diagonals are large");
        let mut column: Vec<f64> = (0..size).map(|at| (at % 13) as f64 - 6.0).collect();
        factor.solve_free(&mut column, 1);
        let found = [digest(&factor.values), digest(&column)];
        let found = found.map(|sum| format!("{sum:016x}"));
        assert_eq!(found, ["0beacbabc53e39ac", "3af0a3b970e31803"]);
    }

    #[test]
    fn nothing_free_is_solved() {
        let mut nothing =
            SparseCholesky::new(Vec::new(), vec![0], Vec::new()).expect("it is small");
        nothing
            .factor(std::iter::empty())
            .expect("nothing to factor");
        let mut moved = [7.0; 2];
        nothing.solve(&[1.0; 2], &mut moved);
        assert_eq!(moved.map(f64::to_bits), [0.0_f64.to_bits(); 2]);
    }
}
