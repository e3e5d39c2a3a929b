//! The slowest motion that a load excites: what says how long a motion takes to come to rest, and which drag
//! lets it do so soonest.
use crate::error::CompositeError;
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::matrix::dot;
use crate::solve::{Equations, Method, told};
use crate::supports::Supports;

/// Part of ω to which it is found, and inverse iterations after which what is found is taken: Rayleigh's
/// quotient never lies below the lowest frequency.
const NEAR: f64 = 1e-3;
const ITERATIONS: usize = 40;

/// Lowest frequency ω [1/s] of the vibrations, in small displacements, that a load [N] or what is moved
/// excites, by inverse iteration from the rest that it has; `None` where nothing is excited or the lattice has
/// no single rest.
///
/// # Errors
/// When the equations do not fit into memory.
pub fn lowest_frequency_per_s(
    lattice: &Lattice,
    supports: &Supports,
    load_n: &[f64],
) -> Result<Option<f64>, CompositeError> {
    let told = |failure| told(failure, lattice.grid());
    let held = supports.displacements();
    let mut matrix = lattice.matrix();
    lattice.tangent(Geometry::Linear, Tangent::Exact, &held, &mut matrix);
    let mut equations =
        Equations::new(Method::Automatic, &matrix, lattice.grid(), supports).map_err(told)?;
    if equations.prepare(&matrix).is_err() {
        return Ok(None);
    }
    let free = |values: &mut [f64]| {
        for (place, value) in values.iter_mut().enumerate() {
            if supports.is_held(place) {
                *value = 0.0;
            }
        }
    };
    // what is moved pulls at its neighbours
    let mut right = vec![0.0; held.len()];
    matrix.multiply(&held, &mut right);
    for (right, load) in right.iter_mut().zip(load_n) {
        *right = load - *right;
    }
    free(&mut right);
    let mut shape = vec![0.0; held.len()];
    let mut last = f64::INFINITY;
    for _ in 0..ITERATIONS {
        if equations.solve(&matrix, &right, &mut shape).is_err() {
            return Ok(None);
        }
        // uᵀ K u over uᵀ M u
        let stiff = dot(&shape, &right);
        for (place, (right, u)) in right.iter_mut().zip(&shape).enumerate() {
            *right = lattice.masses_t()[place / 2] * u;
        }
        let heavy = dot(&shape, &right);
        let lowest = (stiff / heavy).sqrt();
        if !lowest.is_normal() {
            return Ok(None);
        }
        if (last - lowest).abs() <= NEAR * lowest {
            return Ok(Some(lowest));
        }
        last = lowest;
        free(&mut right);
        let size = heavy.sqrt();
        right.iter_mut().for_each(|right| *right /= size);
    }
    Ok(Some(last))
}
