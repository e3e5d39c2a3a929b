//! The time step up to which motion is stable.
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::supports::Supports;

/// The stable time step of springs [s], 2/ω with the bound ω² ≤ max Σⱼ |Kᵢⱼ| / mᵢ of Gershgorin on the
/// highest frequency: never too large, on regular grids within a few per cent of the true one.
#[must_use]
pub fn critical_time_step_s(lattice: &Lattice, supports: &Supports) -> f64 {
    let u = vec![0.0; lattice.displacements()];
    let mut matrix = lattice.matrix();
    lattice.tangent(Geometry::Linear, Tangent::Exact, &u, &mut matrix);
    let sums = matrix.absolute_row_sums(|place| supports.is_held(place));
    let highest = sums
        .iter()
        .enumerate()
        .map(|(place, sum)| sum / lattice.masses_t()[place / 2])
        .fold(0.0, f64::max);
    2.0 / highest.sqrt()
}
