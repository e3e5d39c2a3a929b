//! By which road a sheet comes to equilibrium: what the engine goes by, and what is told of it before.

/// Unknowns up to which a factor is made where bonds have nodes. It holds some 100 numbers for each, and as
/// many are read for every break: fewer than some 20 iterations read, which start at every break from
/// a motion that is nearly right.
pub const DIRECT: usize = 1_000_000;

/// Unknowns of a truss up to which iterations have a factor of all of it, unless they have
/// [rigid groups](has_rigid_groups): bars are hinged everywhere, and groups know nothing of how they fold.
pub const FACTORED_TRUSS: usize = 100_000;

/// Strain from which on bars of a truss are taut enough for rigid groups.
pub const LEAST_TAUT: f64 = 1e-5;

/// `break_precision` from which on a truss has rigid groups: rests that must be more exact take
/// thousands of iterations with them.
pub const LEAST_PRECISION: f64 = 5e-3;

/// Whether iterations on a truss go by rigid groups however small it is.
pub fn has_rigid_groups(taut_strain: f64, break_precision: f64) -> bool {
    taut_strain >= LEAST_TAUT && break_precision >= LEAST_PRECISION
}
