//! How wrong constants are for their grid: by the same cell on half and on a quarter of the pixels.
use super::UnitCell;
use super::constants::Constants;
use super::effective::{Effective, Load};
use super::onset::{Onset, Site, Strengths};
use crate::error::CompositeError;

/// Orders of convergence that are believed. Faces that cut pixels make it 1 in the long run: a
/// faster fall from a quarter to half is chance; one slower than 1/2 is not followed further.
const ORDERS: [f64; 2] = [0.5, 1.0];

/// Round-off and what conjugate gradients leave, over the value.
const LEAST: f64 = 1e-11;

/// Shares of a peak of stress, in matrix, fibre and interface, by which grids of about the same
/// fineness differ, as the face happens to cut their pixels. Measured on one thin fibre, whose
/// stresses are known, on 48² to 120² pixels: 0.7 to 3.3 %, 5.5 % and 0.1 to 1.9 %, all too large.
const PIXEL_SCATTER: [f64; 3] = [0.04, 0.06, 0.03];

/// Fewest pixels along a side: a quarter of them must still be a grid.
const FEWEST: usize = 16;

/// What a grid's constants may be wrong by.
#[derive(Debug, Clone)]
pub struct Errors {
    /// Bounds of the absolute errors, in the units of the constants; that of a Poisson ratio is one
    /// of it.
    pub constants: Constants,
    /// Order of convergence as measured, in the order of [`Constants::NAMES`]; `None` where the two
    /// differences have opposite signs or vanish.
    pub orders: [Option<f64>; 9],
    half: Effective,
}

impl UnitCell {
    /// The effective material, with errors by grids of half and a quarter of the pixels.
    ///
    /// With the differences d₁ of the grid to half of it and d₂ of that to a quarter, the order is
    /// p = log₂(d₂/d₁), kept within [1/2, 1], and the error max(|d₁|, |d₂|/2)/(2ᵖ - 1): that of a
    /// series that falls by 2ᵖ at every halving, where neither difference may be small by chance.
    ///
    /// # Errors
    /// As [`UnitCell::effective`]; when numbers of pixels are no multiples of 4, or below 16.
    pub fn refined(&self, grid: [usize; 2]) -> Result<(Effective, Errors), CompositeError> {
        if let Some(given) = grid
            .iter()
            .find(|count| **count < FEWEST || *count % 4 != 0)
        {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of pixels along a side, for errors by coarser grids",
                given: *given as f64,
                allowed: "a multiple of 4, from 16 to 2048",
            });
        }
        let quarter = self.effective(grid.map(|count| count / 4))?;
        let half = self.effective(grid.map(|count| count / 2))?;
        let fine = self.effective(grid)?;
        let errors = Errors::of(&fine, half, &quarter);
        Ok((fine, errors))
    }
}

impl Errors {
    /// Of the cell on a grid, on half and on a quarter of its pixels along both sides.
    #[must_use]
    pub fn of(fine: &Effective, half: Effective, quarter: &Effective) -> Self {
        let grids = [fine, &half, quarter].map(|effective| effective.constants.values());
        let mut errors = [0.0; 9];
        let mut orders = [None; 9];
        for place in 0..errors.len() {
            let values = grids.map(|values| values[place]);
            (errors[place], orders[place]) = error(values);
        }
        Self {
            constants: Constants::of_values(errors),
            orders,
            half,
        }
    }

    /// What the onset of damage on the full grid may be wrong by, relative, for matrix, fibre and
    /// interface: the change from half of the pixels, which is the error itself when the order is 1,
    /// and what peaks scatter by from grid to grid.
    ///
    /// Stresses converge more slowly than constants, and peaks between fibres that nearly touch may
    /// not have begun to on any grid at hand; then this is a guess of the right size, not a bound.
    ///
    /// # Errors
    /// As [`Effective::onset`].
    pub fn onset(
        &self,
        fine: &Onset,
        load: &Load,
        strengths: &Strengths,
    ) -> Result<[Option<f64>; 3], CompositeError> {
        let half = self.half.onset(load, strengths)?;
        let error = |fine: Option<Site>, half: Option<Site>, scatter: f64| {
            Some((half?.factor / fine?.factor - 1.0).abs() + scatter)
        };
        let [in_matrix, in_fibre, on_interface] = PIXEL_SCATTER;
        Ok([
            error(fine.matrix, half.matrix, in_matrix),
            error(fine.fibre, half.fibre, in_fibre),
            error(fine.interface, half.interface, on_interface),
        ])
    }
}

/// Error and measured order of a value on a grid, on half and on a quarter of it.
fn error([fine, half, quarter]: [f64; 3]) -> (f64, Option<f64>) {
    let (first, second) = (half - fine, quarter - half);
    let ratio = second / first;
    let order = (ratio > 0.0 && ratio.is_finite()).then(|| ratio.log2());
    let believed = order.unwrap_or(ORDERS[1]).clamp(ORDERS[0], ORDERS[1]);
    let difference = first.abs().max(0.5 * second.abs());
    let error = difference / (believed.exp2() - 1.0);
    (error.max(LEAST * fine.abs()), order)
}
