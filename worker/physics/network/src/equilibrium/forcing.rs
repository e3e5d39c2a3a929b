//! How exactly to solve for a Newton step, and how far to go where the energy curves downwards.
use super::{Search, conjugate_gradients::Stop};

/// Residual of a Newton step relative to the force it balances, when still far from equilibrium.
/// Closer to it the step is solved more exactly, see [`relative_residual`].
const LOOSEST_RESIDUAL: f64 = 0.3;
/// The last step need not be solved beyond this part of the force limit.
const SHARE_OF_LIMIT: f64 = 0.1;
/// Largest resultant over the limit below which this may be the last step: it is solved to the end,
/// because what it leaves, long waves above all, stays. At A_cc 5 the Poisson ratio of PET is 3 % off
/// so and 8 % otherwise.
pub(super) const NEAR: f64 = 50.0;
/// Farthest a node goes at once along a direction that curves downwards, in step caps: a buckle
/// turns a bond, which bends the way.
const FARTHEST_AWAY: f64 = 0.05;
/// Conjugate gradient iterations per step and free node: exact arithmetic needs three, one per
/// unknown; more means that the matrix is singular to working precision.
const ITERATIONS_PER_NODE: usize = 3;
const LEAST_ITERATIONS: usize = 100;

/// To what part of itself a residual can fall in one step of single precision, and of double.
pub(super) const SINGLE: f64 = 1e-4;
pub(super) const DOUBLE: f64 = 1e-6;

/// When the iterations for a step end, of so many free `nodes` with this summed `compliance` of theirs.
/// `norm` is the squared preconditioned norm of their resultants in units of `unit`.
pub(super) fn stop(
    search: &Search,
    relative: f64,
    unit: f64,
    norm: f64,
    compliance: f64,
    nodes: usize,
) -> Stop {
    // the norm of such a resultant at every node
    let uniform = compliance * (SHARE_OF_LIMIT * search.force_limit / unit).powi(2);
    Stop {
        relative: relative.powi(2),
        // few nodes above the limit can hide in a small norm: go on by the loosest measure
        absolute: uniform.min(LOOSEST_RESIDUAL.powi(2) * norm),
        iterations: LEAST_ITERATIONS + ITERATIONS_PER_NODE * nodes,
    }
}

/// How far to go along a direction that curves downwards and that reaches so far [mm], where `length`
/// times it would be the minimum if it curved upwards as strongly.
pub(super) fn away(search: &Search, length: f64, reach: f64) -> Option<f64> {
    let length = length.min(FARTHEST_AWAY * search.step_cap / reach);
    length.is_finite().then_some(length)
}

/// How exactly to solve a step: as the residual fell by the last step, so it is worth falling by
/// this one ([EisenstatWalker1996], choice 2). `norm` is squared.
pub(super) fn relative_residual(norm: f64, previous_norm: f64, tightest: f64) -> f64 {
    (norm / previous_norm).clamp(tightest, LOOSEST_RESIDUAL)
}
