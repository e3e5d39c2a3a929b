//! Equilibrium on the periodic grid by conjugate gradients, preconditioned with the uniform body.
//!
//! The number of iterations grows with the root of the contrast of the phases and not with the number
//! of pixels.
use loadframe_numerics::Team;
use loadframe_numerics::equilibrium::{Ended, Enough, Gradients, Preconditioned};

use super::cells::Cells;
use super::spectrum::Spectrum;
use super::torus::{Field, Torus, dot};
use crate::error::CompositeError;

/// Residual over the load at which displacements are found, in the norm of the uniform body's
/// energy. Effective constants are wrong by its square times the contrast, fields by itself.
const TOLERANCE: f64 = 1e-8;

/// A load this small against that of uniform strain is round-off: a uniform cell has none.
const NO_LOAD: f64 = 1e-14;

/// Enough for a contrast of about 10⁵.
const MOST_ITERATIONS: usize = 4_000;

/// Displacements in equilibrium.
#[derive(Debug, Clone)]
pub(super) struct Balanced {
    pub(super) field: Field,
    pub(super) iterations: u64,
    /// Last residual over the load.
    pub(super) residual: f64,
}

/// Finds the displacements under forces, all per volume of a pixel; `energy` is that of uniform
/// strain over all pixels, against which a load may be round-off.
///
/// # Errors
/// When the residual stays above its limit.
pub(super) fn balance(
    torus: &Torus,
    cells: &impl Cells,
    kinds: &[u32],
    spectrum: &mut Spectrum,
    forces: &Field,
    energy: f64,
) -> Result<Balanced, CompositeError> {
    let mut field = vec![[0.0; 2]; torus.nodes()];
    let mut vectors = Gradients::new(torus.nodes());
    vectors.residual.copy_from_slice(forces);
    let mut periodic = Periodic {
        torus,
        cells,
        kinds,
        spectrum,
    };
    let no_load = NO_LOAD * NO_LOAD * energy;
    let enough = Enough::Product {
        share: TOLERANCE * TOLERANCE,
        least: no_load,
    };
    let found = vectors.solve(
        &mut periodic,
        &Team::alone(),
        &mut field,
        enough,
        MOST_ITERATIONS,
    );
    let iterations = found.iterations as u64;
    let [first, last] = found.products;
    let load = first.max(no_load);
    let residual = (last.max(0.0) / load).sqrt();
    match found.ended {
        Ended::Near => Ok(Balanced {
            field,
            iterations,
            residual,
        }),
        Ended::Spent(_) | Ended::CurvesDown(_) if last.is_finite() => {
            Err(CompositeError::CellNotConverged {
                iterations,
                residual,
            })
        }
        Ended::Spent(_) | Ended::CurvesDown(_) => Err(CompositeError::NotFinite {
            quantity: "the residual of a unit cell",
            step: iterations,
        }),
    }
}

/// The periodic grid's equations, preconditioned with the uniform body.
struct Periodic<'a, C> {
    torus: &'a Torus,
    cells: &'a C,
    kinds: &'a [u32],
    spectrum: &'a mut Spectrum,
}

impl<C: Cells> Preconditioned<2> for Periodic<'_, C> {
    fn apply(&mut self, motion: &[[f64; 2]], forces: &mut [[f64; 2]]) -> f64 {
        self.torus.forces(self.cells, self.kinds, motion, forces);
        dot(motion, forces)
    }

    fn precondition(&mut self, residual: &[[f64; 2]], corrected: &mut [[f64; 2]]) -> f64 {
        self.spectrum.solve(residual, corrected);
        dot(residual, corrected)
    }
}
