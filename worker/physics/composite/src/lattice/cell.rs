//! The cell of the exact lattice: four particles and what holds them together.
//!
//! A cell of width a, height b and thickness t stores
//!
//! U = ½ a b t εᵀ C ε + ½ k_x q_x² + ½ k_y q_y²   (1)
//!
//! with the mean strain ε of its particles, the plane stiffness C of what it holds, and the
//! hourglass amplitudes q = Σ hᵢ uᵢ, h = (1, -1, 1, -1), the only motion that is neither rigid nor
//! of uniform strain. Any C, off-axis fibres included, is exact in uniform strain. The hourglass
//! stiffnesses
//!
//! k_x = t b / (12 a S₁₁),  k_y = t a / (12 b S₂₂),  S = C⁻¹   (2)
//!
//! make the cell the assumed-stress rectangle of [PianSumihara1984], whose bending is right: along
//! the way σ_xx = β η and σ_yy = β' ξ store no energy together with the mean stress, for every S.
//!
//! What slanted fibres bear as bars depends on the hourglass, too, and couples it to the mean strain, see
//! [`bars`](crate::section::Bars); (2) is then of the stiffness without them.
//!
//! Source: [PianSumihara1984] for rectangles, with full C. Of an aligned orthotropic C this is the
//! lattice of edge and diagonal springs with an area term and a hourglass correction, see
//! [`springs`](crate::lattice::springs).
use crate::stiffness::{Stiffness, compliance};

/// Signs of the corners along x, along y and of the hourglass.
pub(crate) const ALONG_X: [f64; 4] = [-1.0, 1.0, 1.0, -1.0];
pub(crate) const ALONG_Y: [f64; 4] = [-1.0, -1.0, 1.0, 1.0];
pub(crate) const HOURGLASS: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// Displacements or forces of a cell's corners, x and y by turns.
pub(crate) type Corners = [f64; 8];

/// A symmetric matrix over a cell's corners [N/mm].
pub(crate) type CellMatrix = [[f64; 8]; 8];

/// What a cell is made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    /// Width a and height b [mm].
    pub(crate) sides: [f64; 2],
    /// a b t [mm³].
    pub(crate) volume: f64,
    pub(crate) stiffness: Stiffness,
    /// k_x and k_y [N/mm].
    pub(crate) hourglass: [f64; 2],
    /// Of fibres at an angle to the grid.
    pub(crate) bars: Option<CellBars>,
}

/// What bars add to a cell beside their part of its mean stiffness, see [`Bars`](crate::section::Bars).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellBars {
    /// Cosine and sine of their axis.
    pub(crate) axis: [f64; 2],
    /// Between strain and hourglass [N], and of the hourglass [N/mm], both along the axis.
    pub(crate) stiffness: [f64; 2],
}

/// How mean strains make the strain along an axis.
pub(crate) fn strain_along([c, s]: [f64; 2]) -> [f64; 3] {
    [c * c, s * s, c * s]
}

/// The five measures of a cell's deformation: ε_xx, ε_yy, γ_xy [-], q_x, q_y [mm].
pub(crate) type Measures = [f64; 5];

/// How the corners' displacements make the five measures.
pub(crate) type Rates = [Corners; 5];

/// Hourglass stiffness (2) [N/mm].
pub(crate) fn hourglass(stiffness: &Stiffness, [a, b]: [f64; 2], thickness: f64) -> [f64; 2] {
    let s = compliance(stiffness);
    [
        thickness * b / (12.0 * a * s[(0, 0)]),
        thickness * a / (12.0 * b * s[(1, 1)]),
    ]
}

/// Gradients (∂/∂x, ∂/∂y, hourglass) of a field given at the corners by its x and y parts.
pub(crate) fn gradients([a, b]: [f64; 2], u: &Corners) -> [[f64; 2]; 3] {
    let mut gradients = [[0.0; 2]; 3];
    for axis in 0..2 {
        let [p, q, r, s] = [u[axis], u[2 + axis], u[4 + axis], u[6 + axis]];
        gradients[0][axis] = ((q - p) + (r - s)) / (2.0 * a);
        gradients[1][axis] = ((s - p) + (r - q)) / (2.0 * b);
        gradients[2][axis] = (p - q) + (r - s);
    }
    gradients
}

impl Cell {
    /// Measures of small displacements.
    pub(crate) fn measures(&self, u: &Corners) -> Measures {
        let [dx, dy, q] = gradients(self.sides, u);
        [dx[0], dy[1], dy[0] + dx[1], q[0], q[1]]
    }

    /// The rates of [`Cell::measures`].
    pub(crate) fn rates(&self) -> Rates {
        let [a, b] = self.sides;
        let mut rates = [[0.0; 8]; 5];
        for corner in 0..4 {
            let (x, y) = (2 * corner, 2 * corner + 1);
            rates[0][x] = ALONG_X[corner] / (2.0 * a);
            rates[1][y] = ALONG_Y[corner] / (2.0 * b);
            rates[2][x] = ALONG_Y[corner] / (2.0 * b);
            rates[2][y] = ALONG_X[corner] / (2.0 * a);
            rates[3][x] = HOURGLASS[corner];
            rates[4][y] = HOURGLASS[corner];
        }
        rates
    }

    /// The energy's derivatives by the measures: volume times stress [N mm], hourglass forces [N].
    pub(crate) fn answers(&self, e: &Measures) -> Measures {
        let c = &self.stiffness;
        let v = self.volume;
        let mut answers = [
            v * (c[(0, 0)] * e[0] + c[(0, 1)] * e[1] + c[(0, 2)] * e[2]),
            v * (c[(1, 0)] * e[0] + c[(1, 1)] * e[1] + c[(1, 2)] * e[2]),
            v * (c[(2, 0)] * e[0] + c[(2, 1)] * e[1] + c[(2, 2)] * e[2]),
            self.hourglass[0] * e[3],
            self.hourglass[1] * e[4],
        ];
        if let Some(bars) = &self.bars {
            let along = strain_along(bars.axis);
            let [c, s] = bars.axis;
            let strain = along[0] * e[0] + along[1] * e[1] + along[2] * e[2];
            let bent = c * e[3] + s * e[4];
            for (answer, part) in answers.iter_mut().zip(along) {
                *answer += part * (bars.stiffness[0] * bent);
            }
            let force = bars.stiffness[0] * strain + bars.stiffness[1] * bent;
            answers[3] += c * force;
            answers[4] += s * force;
        }
        answers
    }

    /// Second derivatives of the energy by the measures.
    pub(crate) fn moduli(&self) -> [[f64; 5]; 5] {
        let mut moduli = [[0.0; 5]; 5];
        for (row, target) in moduli.iter_mut().take(3).enumerate() {
            for (column, modulus) in target.iter_mut().take(3).enumerate() {
                *modulus = self.volume * self.stiffness[(row, column)];
            }
        }
        moduli[3][3] = self.hourglass[0];
        moduli[4][4] = self.hourglass[1];
        if let Some(bars) = &self.bars {
            for (axis, part) in bars.axis.into_iter().enumerate() {
                for (row, strain) in strain_along(bars.axis).into_iter().enumerate() {
                    let coupled = bars.stiffness[0] * strain * part;
                    moduli[row][3 + axis] += coupled;
                    moduli[3 + axis][row] += coupled;
                }
                for (other, beside) in bars.axis.into_iter().enumerate() {
                    moduli[3 + axis][3 + other] += bars.stiffness[1] * part * beside;
                }
            }
        }
        moduli
    }

    /// Energy (1) [N mm] and forces on the corners' displacements [N] of small displacements.
    pub(crate) fn linear_forces(&self, u: &Corners) -> (f64, Corners) {
        let measures = self.measures(u);
        let answers = self.answers(&measures);
        let [a, b] = self.sides;
        let (along_x, along_y) = (0.5 / a, 0.5 / b);
        let mut forces = [0.0; 8];
        for corner in 0..4 {
            let (x, y, h) = (
                ALONG_X[corner] * along_x,
                ALONG_Y[corner] * along_y,
                HOURGLASS[corner],
            );
            forces[2 * corner] = x * answers[0] + y * answers[2] + h * answers[3];
            forces[2 * corner + 1] = y * answers[1] + x * answers[2] + h * answers[4];
        }
        (energy(&measures, &answers), forces)
    }

    /// Stiffness matrix of small displacements [N/mm].
    pub(crate) fn linear_matrix(&self) -> CellMatrix {
        congruent(&self.rates(), &self.moduli())
    }
}

/// ½ measures · answers.
pub(crate) fn energy(measures: &Measures, answers: &Measures) -> f64 {
    0.5 * measures
        .iter()
        .zip(answers)
        .map(|(e, s)| e * s)
        .sum::<f64>()
}

/// Bᵀ D B.
pub(crate) fn congruent(rates: &Rates, moduli: &[[f64; 5]; 5]) -> CellMatrix {
    let mut half = [[0.0; 8]; 5];
    for (row, moduli) in half.iter_mut().zip(moduli) {
        for (modulus, rate) in moduli.iter().zip(rates) {
            if *modulus != 0.0 {
                for (sum, value) in row.iter_mut().zip(rate) {
                    *sum += modulus * value;
                }
            }
        }
    }
    let mut matrix = [[0.0; 8]; 8];
    for (rate, half) in rates.iter().zip(&half) {
        for (row, left) in matrix.iter_mut().zip(rate) {
            if *left != 0.0 {
                for (sum, right) in row.iter_mut().zip(half) {
                    *sum += left * right;
                }
            }
        }
    }
    matrix
}

/// Whether a corner has been turned inside out.
pub(crate) fn is_inverted([a, b]: [f64; 2], u: &Corners) -> bool {
    let place = |corner: usize| {
        [
            0.5 * a * (1.0 + ALONG_X[corner]) + u[2 * corner],
            0.5 * b * (1.0 + ALONG_Y[corner]) + u[2 * corner + 1],
        ]
    };
    (0..4).any(|corner| {
        let [here, next, last] = [corner, (corner + 1) % 4, (corner + 3) % 4].map(place);
        let [p, q] = [next, last].map(|p| [p[0] - here[0], p[1] - here[1]]);
        let area = p[0] * q[1] - p[1] * q[0];
        area <= 0.0 || area.is_nan()
    })
}
