//! Equilibrium on the periodic grid by conjugate gradients, preconditioned with the uniform body.
//!
//! The number of iterations grows with the root of the contrast of the phases and not with the number
//! of pixels.
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
const MOST_ITERATIONS: u64 = 4_000;

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
    let mut rest = forces.clone();
    let mut lifted = field.clone();
    let mut answer = field.clone();
    spectrum.solve(&rest, &mut lifted);
    let mut product = dot(&rest, &lifted);
    let load = product.max(NO_LOAD * NO_LOAD * energy);
    let limit = TOLERANCE * TOLERANCE * load;
    let mut way = lifted.clone();
    let mut iterations = 0;
    while product > limit.max(NO_LOAD * NO_LOAD * energy) {
        if iterations == MOST_ITERATIONS {
            return Err(CompositeError::CellNotConverged {
                iterations,
                residual: (product / load).sqrt(),
            });
        }
        torus.forces(cells, kinds, &way, &mut answer);
        let step = product / dot(&way, &answer);
        for node in 0..field.len() {
            for unknown in 0..2 {
                field[node][unknown] += step * way[node][unknown];
                rest[node][unknown] -= step * answer[node][unknown];
            }
        }
        spectrum.solve(&rest, &mut lifted);
        let next = dot(&rest, &lifted);
        let turn = next / product;
        for (way, lifted) in way.iter_mut().zip(&lifted) {
            for unknown in 0..2 {
                way[unknown] = lifted[unknown] + turn * way[unknown];
            }
        }
        product = next;
        iterations += 1;
        if !product.is_finite() {
            return Err(CompositeError::NotFinite {
                quantity: "the residual of a unit cell",
                step: iterations,
            });
        }
    }
    Ok(Balanced {
        field,
        iterations,
        residual: (product.max(0.0) / load).sqrt(),
    })
}
