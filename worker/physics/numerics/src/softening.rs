//! Equations whose matrix lost, or was given, a few parts since it was factored.
//!
//! A network that breaks part by part has, after every break, the matrix
//!
//! K' = K - B C Bᵀ,  B = [b₁ … b_m],  C = diag(c₁ … c_m)
//!
//! and K alone has a factor. A part is taken with c > 0 and given with c < 0. With Z = K⁻¹ B, W = √|C| and
//! the signs S of C the inverse is (Woodbury 1950; Hager, SIAM Review 31, 1989, equation 2)
//!
//! K'⁻¹ f = K⁻¹ f + Z W (S - W BᵀZ W)⁻¹ W Bᵀ K⁻¹ f
//!
//! and S - W BᵀZ W = L S Lᵀ with a lower triangle L of positive diagonal just as long as K' stays positive
//! definite part by part. L grows by a row with every part, so that a part costs one solution with K
//! and a pass over what was taken before.

/// K without the parts that were taken from it; `len` columns of the size of K.
#[derive(Debug, Clone)]
pub struct Softening {
    size: usize,
    /// Entries of all columns b, one after the other, and where each column ends.
    entries: Vec<(u32, f64)>,
    ends: Vec<usize>,
    /// √|c| of each column, and 1 where it was taken, -1 where it was given.
    roots: Vec<f64>,
    signs: Vec<f64>,
    /// Z, column by column.
    solved: Vec<f64>,
    /// Rows of L, one after the other: 1, 2, 3 ... long.
    factor: Vec<f64>,
    right: Vec<f64>,
}

/// Without the part that was to be taken, the matrix would not be positive definite: what is left
/// is a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("without this part the rest would be loose: {left:e} of its stiffness is left")]
pub struct Singular {
    /// Pivot of the part, 1 where the part does not matter and 0 where all depends on it.
    pub left: f64,
}

/// A pivot so small that only round-off keeps it from 0.
const LEAST_PIVOT: f64 = 1e-11;

impl Softening {
    /// Nothing is taken yet from a matrix of `size` rows.
    #[must_use]
    pub fn new(size: usize) -> Self {
        Self {
            size,
            entries: Vec::new(),
            ends: Vec::new(),
            roots: Vec::new(),
            signs: Vec::new(),
            solved: Vec::new(),
            factor: Vec::new(),
            right: vec![0.0; size],
        }
    }

    /// Number of parts that were taken.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether the matrix is as it was factored.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Forgets all parts: the matrix was factored anew.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
        self.roots.clear();
        self.signs.clear();
        self.solved.clear();
        self.factor.clear();
    }

    /// Takes c b bᵀ away, or gives it where c < 0, `b` by its entries; `solve(right, solution)` is that of
    /// K. Gives the part's pivot: 1 where it does not matter, above 1 where it was given.
    ///
    /// # Errors
    /// [`Singular`] when what is left would not be positive definite; then nothing is taken.
    pub fn take(
        &mut self,
        entries: &[(u32, f64)],
        coefficient: f64,
        mut solve: impl FnMut(&[f64], &mut [f64]),
    ) -> Result<f64, Singular> {
        self.right.fill(0.0);
        for &(place, value) in entries {
            self.right[place as usize] += value;
        }
        let count = self.len();
        self.solved.resize((count + 1) * self.size, 0.0);
        let solution = &mut self.solved[count * self.size..];
        solve(&self.right, solution);

        let (root, sign) = (coefficient.abs().sqrt(), coefficient.signum());
        let own = 1.0 - coefficient * sparse_dot(entries, solution);
        let first = self.factor.len();
        for other in 0..count {
            let column = &self.entries[self.start(other)..self.ends[other]];
            let solution = &self.solved[count * self.size..];
            let mut value = -self.roots[other] * root * sparse_dot(column, solution);
            let row = row_start(other);
            for place in 0..other {
                let below = self.factor[row + place] * self.factor[first + place];
                value -= self.signs[place] * below;
            }
            self.factor
                .push(self.signs[other] * value / self.factor[row + other]);
        }
        let before: f64 = self.factor[first..]
            .iter()
            .zip(&self.signs)
            .map(|(value, sign)| sign * value * value)
            .sum();
        let pivot = own - sign * before;
        if pivot.is_nan() || pivot < LEAST_PIVOT {
            self.factor.truncate(first);
            self.solved.truncate(count * self.size);
            return Err(Singular { left: pivot });
        }
        self.factor.push(pivot.sqrt());
        self.entries.extend_from_slice(entries);
        self.ends.push(self.entries.len());
        self.roots.push(root);
        self.signs.push(sign);
        Ok(pivot)
    }

    /// Turns K⁻¹ f into K'⁻¹ f.
    pub fn correct(&self, solution: &mut [f64]) {
        let count = self.len();
        let mut weights = Vec::with_capacity(count);
        for part in 0..count {
            let column = &self.entries[self.start(part)..self.ends[part]];
            let mut value = self.roots[part] * sparse_dot(column, solution);
            let row = row_start(part);
            for (place, weight) in weights.iter().enumerate() {
                value -= self.factor[row + place] * weight;
            }
            weights.push(value / self.factor[row + part]);
        }
        for (weight, sign) in weights.iter_mut().zip(&self.signs) {
            *weight *= sign;
        }
        for part in (0..count).rev() {
            let weight = weights[part] / self.factor[row_start(part) + part];
            weights[part] = weight;
            for (place, above) in weights[..part].iter_mut().enumerate() {
                *above -= self.factor[row_start(part) + place] * weight;
            }
        }
        for (part, weight) in weights.iter().enumerate() {
            let factor = weight * self.roots[part];
            let column = &self.solved[part * self.size..(part + 1) * self.size];
            for (value, of_column) in solution.iter_mut().zip(column) {
                *value += factor * of_column;
            }
        }
    }

    fn start(&self, part: usize) -> usize {
        if part == 0 { 0 } else { self.ends[part - 1] }
    }
}

fn row_start(row: usize) -> usize {
    row * (row + 1) / 2
}

fn sparse_dot(entries: &[(u32, f64)], dense: &[f64]) -> f64 {
    entries
        .iter()
        .map(|&(place, value)| value * dense[place as usize])
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs of stiffness 1 .. n in a row, held at the left: K⁻¹ is known.
    fn chain(size: usize) -> impl FnMut(&[f64], &mut [f64]) {
        move |right, solution| {
            let mut tension: f64 = right.iter().sum();
            let mut at = 0.0;
            for place in 0..size {
                at += tension / (place + 1) as f64;
                solution[place] = at;
                tension -= right[place];
            }
        }
    }

    #[test]
    fn softened_springs_stretch_by_their_new_stiffness() {
        let size = 6;
        let mut softening = Softening::new(size);
        // half of spring 2 (stiffness 3), nine tenths of spring 4 (stiffness 5), then half the rest
        softening
            .take(&[(2, 1.0), (1, -1.0)], 1.5, chain(size))
            .unwrap();
        softening
            .take(&[(4, 1.0), (3, -1.0)], 4.5, chain(size))
            .unwrap();
        let pivot = softening
            .take(&[(4, 1.0), (3, -1.0)], 0.25, chain(size))
            .unwrap();
        assert!(
            (pivot - 0.5).abs() < 1e-12,
            "half of what was left: {pivot}"
        );
        pulled(&softening, [1.0, 2.0, 1.5, 4.0, 0.25, 6.0]);
    }

    #[test]
    fn what_was_taken_is_given_back_in_part_and_taken_again() {
        let size = 6;
        let mut softening = Softening::new(size);
        let third = [(2, 1.0), (1, -1.0)];
        let fifth = [(4, 1.0), (3, -1.0)];
        softening.take(&third, 2.9, chain(size)).unwrap();
        softening.take(&fifth, 4.0, chain(size)).unwrap();
        let pivot = softening.take(&third, -1.9, chain(size)).unwrap();
        assert!((pivot - 20.0).abs() < 1e-9, "from 0.1 to 2: {pivot}");
        pulled(&softening, [1.0, 2.0, 2.0, 4.0, 1.0, 6.0]);
        softening.take(&third, 0.5, chain(size)).unwrap();
        softening.take(&fifth, -7.0, chain(size)).unwrap();
        pulled(&softening, [1.0, 2.0, 1.5, 4.0, 8.0, 6.0]);
    }

    /// A force of 2 at the free end stretches every spring by 2 over its stiffness.
    fn pulled(softening: &Softening, stiffness: [f64; 6]) {
        let right = [0.0, 0.0, 0.0, 0.0, 0.0, 2.0];
        let mut solution = vec![0.0; 6];
        chain(6)(&right, &mut solution);
        softening.correct(&mut solution);
        let mut at = 0.0;
        for (value, stiffness) in solution.iter().zip(stiffness) {
            at += 2.0 / stiffness;
            assert!((value - at).abs() < 1e-11, "{value} {at}");
        }
    }

    #[test]
    fn what_is_given_back_is_there_again() {
        let size = 5;
        let mut softening = Softening::new(size);
        // all but a millionth of spring 1 (stiffness 2), then half of spring 3 (4), then twice what was
        // taken of spring 1 is given back, and a little of spring 3 is taken again
        for (place, coefficient) in [(1, 2.0 - 2e-6), (3, 2.0), (1, -4.0), (3, 0.5)] {
            let entries = [(place, 1.0), (place - 1, -1.0)];
            let pivot = softening.take(&entries, coefficient, chain(size));
            assert_eq!(pivot.unwrap() > 1.0, coefficient < 0.0);
        }
        let mut solution = vec![0.0; size];
        chain(size)(&[0.0, 0.0, 0.0, 0.0, 3.0], &mut solution);
        softening.correct(&mut solution);
        let mut at = 0.0;
        for (value, stiffness) in solution.iter().zip([1.0, 4.0 + 2e-6, 3.0, 1.5, 5.0]) {
            at += 3.0 / stiffness;
            assert!((value - at).abs() < 1e-8, "{value} {at}");
        }
    }

    #[test]
    fn the_last_hold_is_not_taken() {
        let size = 4;
        let mut softening = Softening::new(size);
        let refused = softening.take(&[(0, 1.0)], 1.0, chain(size));
        assert!(refused.unwrap_err().left.abs() < 1e-12);
        assert!(softening.is_empty());
        softening.take(&[(0, 1.0)], 0.5, chain(size)).unwrap();
        let mut solution = vec![0.0; size];
        chain(size)(&[1.0, 0.0, 0.0, 0.0], &mut solution);
        softening.correct(&mut solution);
        assert!(solution.iter().all(|value| (value - 2.0).abs() < 1e-12));
        softening.clear();
        assert_eq!(softening.len(), 0);
    }
}
