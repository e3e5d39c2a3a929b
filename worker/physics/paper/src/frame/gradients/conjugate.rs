//! Conjugate gradients, and how far they are from the solution.
use loadframe_numerics::Team;

use super::cycle::Cycle;
use super::operator::{Nodal, Operator};

/// Iterations that an estimate of the error looks back: with steps αⱼ and products ρⱼ = rⱼ·M⁻¹rⱼ the
/// squared error in energy before step k is Σ αⱼ ρⱼ over all steps from k on, and most of it is in the
/// first few [HestenesStiefel1952], [StrakosTichy2002]. The error is told of the motion that many
/// iterations ago, so that what is left now is smaller.
const LOOK_BACK: usize = 6;

/// Iterations before giving up. Some 100 are usual.
const ITERATIONS: usize = 20_000;

/// Nodes of a pass over vectors alone.
const NODES_OF_PIECE: usize = 2048;

/// The vectors of an iteration.
#[derive(Debug)]
pub(super) struct Vectors<const M: usize> {
    pub(super) residual: Nodal<M>,
    corrected: Nodal<M>,
    direction: Nodal<M>,
    forces: Nodal<M>,
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Iterated {
    pub(super) iterations: usize,
    /// Estimate of √(eᵀKe) of the error e that is left [√nJ·√2].
    pub(super) error: f64,
    pub(super) is_found: bool,
}

impl<const M: usize> Vectors<M> {
    pub(super) fn new(nodes: usize) -> Self {
        let none = || vec![[0.0; M]; nodes];
        Self {
            residual: none(),
            corrected: none(),
            direction: none(),
            forces: none(),
        }
    }

    /// Moves the nodes until the estimate of the error is at most `wanted`; the residual is that of the
    /// motion as it is.
    pub(super) fn iterate(
        &mut self,
        (operator, cycle): (&mut Operator<'_, M>, &mut Cycle<M>),
        team: &Team,
        motion: &mut Nodal<M>,
        wanted: f64,
    ) -> Iterated {
        let mut drops: Vec<f64> = Vec::new();
        let mut product = 0.0;
        for iteration in 0..ITERATIONS {
            let Self {
                residual,
                corrected,
                direction,
                forces,
            } = self;
            let next = cycle.solve(operator, team, residual, corrected);
            if next <= 0.0 {
                // nothing is left
                return Iterated {
                    iterations: iteration,
                    error: 0.0,
                    is_found: next == 0.0,
                };
            }
            let keep = if iteration == 0 { 0.0 } else { next / product };
            product = next;
            both(team, direction, corrected, |direction, corrected| {
                *direction = corrected + keep * *direction;
            });
            let curvature = operator.apply(team, direction, forces);
            if curvature.is_nan() || curvature <= 0.0 {
                return Iterated {
                    iterations: iteration,
                    error: f64::INFINITY,
                    is_found: false,
                };
            }
            let step = product / curvature;
            both(team, motion, direction, |motion, direction| {
                *motion += step * direction;
            });
            both(team, residual, forces, |residual, force| {
                *residual -= step * force;
            });
            drops.push(step * product);
            let recent = &drops[drops.len().saturating_sub(LOOK_BACK)..];
            let error = recent.iter().sum::<f64>().sqrt();
            if error <= wanted && drops.len() >= LOOK_BACK {
                return Iterated {
                    iterations: iteration + 1,
                    error,
                    is_found: true,
                };
            }
        }
        Iterated {
            iterations: ITERATIONS,
            error: f64::INFINITY,
            is_found: false,
        }
    }
}

/// Works on the motions of two vectors in pieces.
fn both<const M: usize>(
    team: &Team,
    first: &mut [[f64; M]],
    second: &[[f64; M]],
    work: impl Fn(&mut f64, f64) + Sync,
) {
    let pieces = first
        .chunks_mut(NODES_OF_PIECE)
        .zip(second.chunks(NODES_OF_PIECE));
    team.map(pieces.collect(), |(first, second)| {
        let pairs = first.as_flattened_mut().iter_mut();
        for (first, second) in pairs.zip(second.as_flattened()) {
            work(first, *second);
        }
    });
}
