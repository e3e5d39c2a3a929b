//! The uniform body's equations, solved by Fourier transforms: the preconditioner.
//!
//! On a periodic grid of one material the equations are a convolution, and every wave stands alone
//! with a 2 × 2 matrix. That matrix is real because the two derivatives of the cell have the same
//! phase. Both unknowns are transformed at once as the real and the imaginary part of one complex
//! field z: with k and -k side by side, u₂ + i u₃ = P⁻¹ applied becomes
//!
//! z(k) → m z(k) + (d + i q) z(-k)*,   m = (p + r)/2, d = (p - r)/2 of P⁻¹ = [p, q; q, r].   (1)
//!
//! `rustfft`'s scalar planner: the same bits whatever vector instructions a processor has.
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlannerScalar};

use super::cells::Cells;
use super::torus::Torus;

type Number = Complex<f64>;

/// Solves the equations of a uniform body.
pub(super) struct Spectrum {
    grid: [usize; 2],
    /// Forward and back along 2, then along 3.
    along: [[Arc<dyn Fft<f64>>; 2]; 2],
    /// m, d and q of (1) over all waves, those along 3 in sequence, divided by the number of nodes.
    factors: Vec<[f64; 3]>,
    waves: Vec<Number>,
    turned: Vec<Number>,
    scratch: Vec<Number>,
}

impl fmt::Debug for Spectrum {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Spectrum of {:?} pixels", self.grid)
    }
}

impl Spectrum {
    /// Of a body all of whose pixels are of one kind.
    pub(super) fn new(torus: &Torus, cells: &impl Cells, kind: u32) -> Self {
        let mut planner = FftPlannerScalar::new();
        let along = torus.grid.map(|count| {
            [
                planner.plan_fft_forward(count),
                planner.plan_fft_inverse(count),
            ]
        });
        let scratch = along
            .iter()
            .flatten()
            .map(|plan| plan.get_inplace_scratch_len())
            .max()
            .unwrap_or(0);
        let zero = Number::new(0.0, 0.0);
        Self {
            grid: torus.grid,
            factors: factors(torus, cells, kind),
            waves: vec![zero; torus.nodes()],
            turned: vec![zero; torus.nodes()],
            scratch: vec![zero; scratch],
            along,
        }
    }

    /// Displacements without a mean under forces, whose mean is left out.
    pub(super) fn solve(&mut self, forces: &[[f64; 2]], displacements: &mut [[f64; 2]]) {
        for (wave, force) in self.waves.iter_mut().zip(forces) {
            *wave = Number::new(force[0], force[1]);
        }
        let [columns, rows] = self.grid;
        self.along[0][0].process_with_scratch(&mut self.waves, &mut self.scratch);
        transpose(&self.waves, &mut self.turned, columns);
        self.along[1][0].process_with_scratch(&mut self.turned, &mut self.scratch);
        self.weigh();
        self.along[1][1].process_with_scratch(&mut self.turned, &mut self.scratch);
        transpose(&self.turned, &mut self.waves, rows);
        self.along[0][1].process_with_scratch(&mut self.waves, &mut self.scratch);
        for (displacement, wave) in displacements.iter_mut().zip(&self.waves) {
            *displacement = [wave.re, wave.im];
        }
    }

    /// (1), every pair of waves k and -k once.
    fn weigh(&mut self) {
        let [columns, rows] = self.grid;
        for i in 0..=columns / 2 {
            let opposite = (columns - i) % columns;
            for j in 0..rows {
                let here = i * rows + j;
                let there = opposite * rows + (rows - j) % rows;
                // on its own column a pair would be met twice
                if i == opposite && there < here {
                    continue;
                }
                let [m, d, q] = self.factors[here];
                let mix = Number::new(d, q);
                let (z, w) = (self.turned[here], self.turned[there]);
                self.turned[here] = z * m + mix * w.conj();
                self.turned[there] = w * m + mix * z.conj();
            }
        }
    }
}

fn factors(torus: &Torus, cells: &impl Cells, kind: u32) -> Vec<[f64; 3]> {
    let [columns, rows] = torus.grid;
    let [a, b] = torus.sides_mm;
    let halves = |count: usize| -> Vec<[f64; 2]> {
        (0..count)
            .map(|wave| {
                let (s, c) = (PI * wave as f64 / count as f64).sin_cos();
                // of the shortest wave exactly 0
                [s, if 2 * wave == count { 0.0 } else { c }]
            })
            .collect()
    };
    let (along_2, along_3) = (halves(columns), halves(rows));
    let scale = 1.0 / torus.nodes() as f64;
    let mut factors = Vec::with_capacity(torus.nodes());
    for [s2, c2] in along_2 {
        for &[s3, c3] in &along_3 {
            // ∂₂ = (2i/a) sin(k₂/2) cos(k₃/2), ∂₃ alike, but for a common phase; Σ h u: 4 sin sin
            let (d2, d3) = (2.0 / a * s2 * c3, 2.0 / b * c2 * s3);
            let hourglass = 16.0 * s2 * s2 * s3 * s3;
            let [p, q, r] = cells.symbol(kind, [d2 * d2, d3 * d3, d2 * d3, hourglass]);
            let determinant = p * r - q * q;
            factors.push(if determinant > 0.0 {
                let inverse = [r / determinant, -q / determinant, p / determinant];
                [
                    0.5 * scale * (inverse[0] + inverse[2]),
                    0.5 * scale * (inverse[0] - inverse[2]),
                    scale * inverse[1],
                ]
            } else {
                // the mean, which is free
                [0.0; 3]
            });
        }
    }
    factors
}

/// Rows of `columns` numbers become columns; by blocks that stay in the cache.
fn transpose(from: &[Number], to: &mut [Number], columns: usize) {
    const BLOCK: usize = 16;
    let rows = from.len() / columns;
    for first_row in (0..rows).step_by(BLOCK) {
        for first in (0..columns).step_by(BLOCK) {
            for row in first_row..rows.min(first_row + BLOCK) {
                for column in first..columns.min(first + BLOCK) {
                    to[column * rows + row] = from[row * columns + column];
                }
            }
        }
    }
}
