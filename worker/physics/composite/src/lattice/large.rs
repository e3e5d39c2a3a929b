//! The exact lattice's cell in large rotation.
//!
//! The mean deformation gradient F of a cell is split into a rotation and a stretch, F = R U, by the
//! angle θ = atan2(F₂₁ - F₁₂, F₁₁ + F₂₂); the cell stores
//!
//! U = ½ a b t eᵀ C e + ½ k_x (Rᵀq)_x² + ½ k_y (Rᵀq)_y²,  e = (U₁₁ - 1, U₂₂ - 1, 2 U₁₂)   (3)
//!
//! (the strain of Biot). A rigid rotation stores nothing, small strains are those of the linear
//! cell, and in compression the cell stiffens as a spring does, where the strain of Green and
//! Lagrange would soften. Forces and tangent are the exact derivatives of (3), the rotation's own
//! included; so every equilibrium is a stationary point of one energy.
use crate::lattice::cell::{
    ALONG_X, ALONG_Y, Cell, CellMatrix, Corners, HOURGLASS, Measures, Rates, congruent, energy,
    gradients,
};

/// A cell's frame and what its measures do when it turns.
struct Frame {
    /// R's columns.
    first: [f64; 2],
    second: [f64; 2],
    measures: Measures,
    /// Derivatives of the measures by θ at fixed places.
    turning: Measures,
    /// Second derivatives of the measures by θ.
    turning_twice: Measures,
    /// U₁₁ + U₂₂.
    trace: f64,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Frame {
    fn new(cell: &Cell, u: &Corners) -> Self {
        let [dx, dy, q] = gradients(cell.sides, u);
        let turn = [2.0 + dx[0] + dy[1], dx[1] - dy[0]];
        let trace = turn[0].hypot(turn[1]);
        // No frame without a trace; such a cell is inside out, and that is noticed elsewhere.
        let [c, s] = if trace > 0.0 {
            [turn[0] / trace, turn[1] / trace]
        } else {
            [1.0, 0.0]
        };
        // cos θ - 1 without cancellation: strains of 1e-9 keep their digits.
        let versine = if c > 0.0 { -s * s / (1.0 + c) } else { c - 1.0 };
        let (first, second) = ([c, s], [-s, c]);
        let (e11, e22) = (versine + dot(first, dx), versine + dot(second, dy));
        let shear = dot(first, dy) + dot(second, dx);
        let local = [dot(first, q), dot(second, q)];
        Self {
            first,
            second,
            measures: [e11, e22, shear, local[0], local[1]],
            turning: [0.5 * shear, -0.5 * shear, e22 - e11, local[1], -local[0]],
            turning_twice: [-1.0 - e11, -1.0 - e22, -shear, -local[0], -local[1]],
            trace,
        }
    }

    /// Rates of a measure r · g for the directions r given for ∂/∂x, ∂/∂y and the hourglass.
    fn rate(cell: &Cell, parts: [Option<[f64; 2]>; 3]) -> Corners {
        let [a, b] = cell.sides;
        let mut rate = [0.0; 8];
        for corner in 0..4 {
            let weights = [
                ALONG_X[corner] / (2.0 * a),
                ALONG_Y[corner] / (2.0 * b),
                HOURGLASS[corner],
            ];
            for (part, weight) in parts.iter().zip(weights) {
                if let Some([x, y]) = part {
                    rate[2 * corner] += weight * x;
                    rate[2 * corner + 1] += weight * y;
                }
            }
        }
        rate
    }

    /// Rates of the measures at fixed θ.
    fn fixed_rates(&self, cell: &Cell) -> Rates {
        let (r, s) = (self.first, self.second);
        [
            Self::rate(cell, [Some(r), None, None]),
            Self::rate(cell, [None, Some(s), None]),
            Self::rate(cell, [Some(s), Some(r), None]),
            Self::rate(cell, [None, None, Some(r)]),
            Self::rate(cell, [None, None, Some(s)]),
        ]
    }

    /// Rate of θ: (r₂ · d∂x - r₁ · d∂y) / trace.
    fn angle_rate(&self, cell: &Cell) -> Corners {
        let scale = 1.0 / self.trace;
        let r = [-self.first[0] * scale, -self.first[1] * scale];
        let s = [self.second[0] * scale, self.second[1] * scale];
        Self::rate(cell, [Some(s), Some(r), None])
    }

    fn rates(&self, cell: &Cell) -> (Rates, Corners) {
        let mut rates = self.fixed_rates(cell);
        let angle = self.angle_rate(cell);
        for (rate, turning) in rates.iter_mut().zip(self.turning) {
            for (value, angle) in rate.iter_mut().zip(&angle) {
                *value += turning * angle;
            }
        }
        (rates, angle)
    }
}

impl Cell {
    /// Measures of large displacements, and their rates.
    pub(crate) fn large_measures(&self, u: &Corners) -> (Measures, Rates) {
        let frame = Frame::new(self, u);
        (frame.measures, frame.rates(self).0)
    }

    /// Energy (3) [N mm] and its derivatives by the corners' displacements [N].
    pub(crate) fn large_forces(&self, u: &Corners) -> (f64, Corners) {
        let frame = Frame::new(self, u);
        let answers = self.answers(&frame.measures);
        let (rates, _) = frame.rates(self);
        let mut forces = [0.0; 8];
        for (rate, answer) in rates.iter().zip(&answers) {
            for (force, value) in forces.iter_mut().zip(rate) {
                *force += answer * value;
            }
        }
        (energy(&frame.measures, &answers), forces)
    }

    /// Tangent of (3) [N/mm]; without its `geometric` part it is never negative.
    pub(crate) fn large_matrix(&self, u: &Corners, geometric: bool) -> CellMatrix {
        let frame = Frame::new(self, u);
        let (rates, angle) = frame.rates(self);
        let mut matrix = congruent(&rates, &self.moduli());
        if !geometric {
            return matrix;
        }
        let answers = self.answers(&frame.measures);
        let (r, s) = (frame.first, frame.second);
        let back = [-r[0], -r[1]];
        // Mixed derivatives by θ and place, weighted by the answers.
        let mixed = [
            Frame::rate(self, [Some(s), None, None]),
            Frame::rate(self, [None, Some(back), None]),
            Frame::rate(self, [Some(back), Some(s), None]),
            Frame::rate(self, [None, None, Some(s)]),
            Frame::rate(self, [None, None, Some(back)]),
        ];
        let mut first = [0.0; 8];
        for (rate, answer) in mixed.iter().zip(&answers) {
            for (sum, value) in first.iter_mut().zip(rate) {
                *sum += answer * value;
            }
        }
        let weigh = |by: &Measures| -> f64 { by.iter().zip(&answers).map(|(d, s)| d * s).sum() };
        let twice = weigh(&frame.turning_twice);
        // d²θ = -2 dθ d(trace) / trace.
        let curved = -weigh(&frame.turning) / frame.trace;
        let trace = Frame::rate(self, [Some(r), Some(s), None]);
        for row in 0..8 {
            for column in 0..8 {
                matrix[row][column] += first[row] * angle[column]
                    + angle[row] * first[column]
                    + twice * angle[row] * angle[column]
                    + curved * (angle[row] * trace[column] + trace[row] * angle[column]);
            }
        }
        matrix
    }
}
