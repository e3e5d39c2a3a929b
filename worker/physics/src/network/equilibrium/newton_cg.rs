//! Newton's method on the energy, each step solved by conjugate gradients.
//!
//! The energy is C¹ with kinks in its slope, and not convex where bonds are compressed. A step
//! follows the true Hessian as long as it curves upwards along all search directions; otherwise it
//! is solved again without the transverse stiffness of compressed bonds, which leaves a positive
//! matrix ([NocedalWright2006] chapter 7 truncates there instead; on networks after the force
//! maximum this gives steps too short to be of use). Steps are capped, and kept only when the
//! energy falls.
use super::{
    Search, Settled,
    block_jacobi::BlockJacobi,
    conjugate_gradients::{Stop, newton_step},
    line_search::Line,
    work::Meter,
};
use crate::{
    Interrupt,
    network::{
        Vector,
        assembly::Assembly,
        configuration::{Configuration, Verdict},
    },
    parallel::Team,
};

/// Keeps every transverse stiffness as it is.
const TRUE_HESSIAN: f64 = f64::NEG_INFINITY;
/// Drops the transverse stiffness of compressed bonds.
const POSITIVE_HESSIAN: f64 = 0.0;
/// Residual of a Newton step relative to the force it balances, when still far from equilibrium.
/// Closer to it the step is solved more exactly, see [`relative_residual`].
const LOOSEST_RESIDUAL: f64 = 0.1;
const TIGHTEST_RESIDUAL: f64 = 1e-6;
/// The last step need not be solved beyond this part of the force limit.
const SHARE_OF_LIMIT: f64 = 0.1;
/// Conjugate gradient iterations per step and free node: exact arithmetic needs three, one per
/// unknown; more means that the matrix is singular to working precision.
const ITERATIONS_PER_NODE: usize = 3;
const LEAST_ITERATIONS: usize = 100;

/// See [`Search::run`].
pub(super) fn solve(
    search: &Search,
    assembly: &Assembly,
    displacements: Vec<Vector>,
    team: &Team,
    meter: &mut Meter<'_>,
) -> Result<Settled, Interrupt> {
    meter.spend(assembly.bonds.len())?;
    let mut here = Configuration::new(assembly, displacements, team);
    let mut there = here.clone();
    let mut previous_norm = f64::INFINITY;
    let mut iterations = 0;
    loop {
        let residual = here.residual(assembly, search.force_limit);
        if residual.verdict != Verdict::Unbalanced || iterations == search.iteration_limit {
            return Ok(Settled {
                configuration: here,
                residual,
            });
        }
        iterations += 1;
        meter.work.newton_iterations += 1;
        let preconditioner = BlockJacobi::new(assembly, &here);
        let norm = preconditioner.norm(&here.resultants[..assembly.free()]);
        let stop = Stop {
            relative: relative_residual(norm, previous_norm).powi(2),
            // few nodes above the limit can hide in a small norm: go on by the loosest measure
            absolute: preconditioner
                .uniform_norm(SHARE_OF_LIMIT * search.force_limit)
                .min(LOOSEST_RESIDUAL.powi(2) * norm),
            iterations: LEAST_ITERATIONS + ITERATIONS_PER_NODE * assembly.free(),
        };
        previous_norm = norm;
        let mut accepted = false;
        for least_transverse in [TRUE_HESSIAN, POSITIVE_HESSIAN] {
            let step = newton_step(
                assembly,
                &here,
                &preconditioner,
                least_transverse,
                stop,
                team,
                meter,
            )?;
            if step.curves_down && least_transverse == TRUE_HESSIAN {
                continue;
            }
            let line = Line {
                assembly,
                start: &here,
                direction: &step.direction,
                longest: search.step_cap / farthest(&step.direction),
            };
            if line.descend(&mut there, team, meter)? {
                accepted = true;
                break;
            }
        }
        if !accepted {
            // neither Hessian leads down: this is as far as the arithmetic goes
            return Ok(Settled {
                configuration: here,
                residual,
            });
        }
        std::mem::swap(&mut here, &mut there);
    }
}

/// How exactly to solve a step: as the residual fell by the last step, so it is worth falling by
/// this one ([EisenstatWalker1996], choice 2). `norm` is squared.
fn relative_residual(norm: f64, previous_norm: f64) -> f64 {
    (norm / previous_norm).clamp(TIGHTEST_RESIDUAL, LOOSEST_RESIDUAL)
}

/// Longest displacement of a node in a step [mm].
fn farthest(step: &[Vector]) -> f64 {
    let squares = step.iter().map(Vector::norm_squared);
    squares.fold(0.0, f64::max).sqrt()
}
