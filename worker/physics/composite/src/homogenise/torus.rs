//! Fields at the nodes of a periodic grid: pixel (i, j) has its corners at the nodes (i, j) to
//! (i + 1, j + 1), and what leaves at one edge comes in at the other.
use super::cells::{Cells, Rates};

/// Two unknowns at every node.
pub(super) type Field = Vec<[f64; 2]>;

/// Signs of the corners along 2, along 3 and of the hourglass, counterclockwise from the lower left.
const ALONG_2: [f64; 4] = [-1.0, 1.0, 1.0, -1.0];
const ALONG_3: [f64; 4] = [-1.0, -1.0, 1.0, 1.0];
const HOURGLASS: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// A periodic grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Torus {
    /// Columns along 2 and rows along 3.
    pub(super) grid: [usize; 2],
    /// Sides of a pixel [mm].
    pub(super) sides_mm: [f64; 2],
}

impl Torus {
    pub(super) fn nodes(&self) -> usize {
        self.grid[0] * self.grid[1]
    }

    /// The nodes at a pixel's corners.
    fn corners(&self, i: usize, j: usize) -> [usize; 4] {
        let [columns, rows] = self.grid;
        let right = if i + 1 == columns { 0 } else { i + 1 };
        let (lower, upper) = (
            j * columns,
            if j + 1 == rows { 0 } else { (j + 1) * columns },
        );
        [lower + i, lower + right, upper + right, upper + i]
    }

    /// Mean derivatives and hourglass sums of a pixel's corners.
    fn rates(&self, corners: [[f64; 2]; 4]) -> Rates {
        let [a, b] = self.sides_mm;
        let (along_2, along_3) = (0.5 / a, 0.5 / b);
        let mut rates = [[0.0; 2]; 3];
        for unknown in 0..2 {
            let [p, q, r, s] = corners.map(|corner| corner[unknown]);
            rates[0][unknown] = ((q - p) + (r - s)) * along_2;
            rates[1][unknown] = ((s - p) + (r - q)) * along_3;
            rates[2][unknown] = (p - q) + (r - s);
        }
        rates
    }

    /// Calls `each` with every pixel and its rates.
    pub(super) fn for_rates(&self, field: &Field, mut each: impl FnMut(usize, Rates)) {
        for j in 0..self.grid[1] {
            for i in 0..self.grid[0] {
                let corners = self.corners(i, j).map(|node| field[node]);
                each(j * self.grid[0] + i, self.rates(corners));
            }
        }
    }

    /// Adds to the nodes what pixels answer: the transpose of the rates, over all pixels.
    pub(super) fn gather(&self, forces: &mut Field, mut answer: impl FnMut(usize) -> Rates) {
        forces.fill([0.0; 2]);
        for j in 0..self.grid[1] {
            for i in 0..self.grid[0] {
                self.scatter(forces, self.corners(i, j), answer(j * self.grid[0] + i));
            }
        }
    }

    fn scatter(&self, forces: &mut [[f64; 2]], corners: [usize; 4], answer: Rates) {
        let [a, b] = self.sides_mm;
        let (along_2, along_3) = (0.5 / a, 0.5 / b);
        for (corner, node) in corners.into_iter().enumerate() {
            let (y, z) = (ALONG_2[corner] * along_2, ALONG_3[corner] * along_3);
            for unknown in 0..2 {
                forces[node][unknown] += y * answer[0][unknown]
                    + z * answer[1][unknown]
                    + HOURGLASS[corner] * answer[2][unknown];
            }
        }
    }

    /// Forces of displacements, per volume of a pixel.
    pub(super) fn forces(
        &self,
        cells: &impl Cells,
        kinds: &[u32],
        field: &[[f64; 2]],
        out: &mut [[f64; 2]],
    ) {
        out.fill([0.0; 2]);
        for j in 0..self.grid[1] {
            for i in 0..self.grid[0] {
                let corners = self.corners(i, j);
                let rates = self.rates(corners.map(|node| field[node]));
                let answer = cells.answer(kinds[j * self.grid[0] + i], rates);
                self.scatter(out, corners, answer);
            }
        }
    }
}

/// Σ u · v over all nodes.
pub(super) fn dot(u: &[[f64; 2]], v: &[[f64; 2]]) -> f64 {
    let mut sums = [0.0; 2];
    for (u, v) in u.iter().zip(v) {
        sums[0] += u[0] * v[0];
        sums[1] += u[1] * v[1];
    }
    sums[0] + sums[1]
}
