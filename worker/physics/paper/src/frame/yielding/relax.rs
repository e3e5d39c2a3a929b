//! Rest at one elongation after a part is gone.
//!
//! What the part bore goes to the others at once: no path is known, and every segment goes straight from
//! where it was to where it is. So the rest is the least of a convex energy, elastic and lost, and
//! unique [SimoHughes1998]. Newton's steps with the slopes of the laws find it, halved where the energy
//! would rise.
use super::super::equilibrium::{BALANCED, Equilibrium, ROUND_OFF, UNBALANCED};
use super::super::error::FrameError;
use super::strained::Strained;

/// Iterations before giving up; 3 to 10 are usual.
const ITERATIONS: usize = 200;
const HALVINGS: usize = 30;
/// Round-off of an energy.
const ENERGY_ROUND_OFF: f64 = 1e-13;

/// Brings what is strained to rest; `slopes` has the stiffness of what flows, without what is gone. Gives the largest unbalanced
/// force over the largest force of an element.
pub(super) fn relax(
    strained: &mut Strained<'_>,
    slopes: &mut Equilibrium<'_>,
    largest_mn: f64,
) -> Result<f64, FrameError> {
    let before = strained.plastic.clone();
    strained.flow(slopes.active(), &before);
    let mut energy = strained.forces.energy + strained.dissipated_nj();
    let mut last = f64::INFINITY;
    for iteration in 0..ITERATIONS {
        let mut right = slopes.unbalanced(&strained.forces);
        let worst = slopes.worst_force(&right);
        let residual = worst / strained.forces.scale.max(largest_mn);
        let is_round_off = worst <= ROUND_OFF * strained.forces.round_off;
        let is_stuck = iteration > 3 && residual <= UNBALANCED && residual > 0.3 * last;
        if residual <= BALANCED || is_round_off || is_stuck {
            return Ok(residual);
        }
        last = residual;
        let changed = changes(strained, slopes);
        slopes.change(&changed)?;
        slopes.solve(&mut right);
        let from = strained.motion.clone();
        let flowed = strained.plastic.clone();
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            slopes.add_to(&mut strained.motion, &right, share);
            strained.flow(slopes.active(), &before);
            let there = strained.forces.energy + strained.dissipated_nj();
            if there <= energy + ENERGY_ROUND_OFF * energy.abs() {
                energy = there;
                break;
            }
            strained.motion.nodes.clone_from(&from.nodes);
            strained.plastic.clone_from(&flowed);
            share *= 0.5;
        }
    }
    Err(FrameError::Unbalanced {
        residual: last,
        allowed: UNBALANCED,
        iterations: ITERATIONS,
    })
}

/// What must change for the slopes to be those of what flows.
pub(super) fn changes(strained: &Strained<'_>, slopes: &Equilibrium<'_>) -> Vec<(usize, f64)> {
    let segments = strained.laws.iter().zip(&strained.plastic).enumerate();
    segments
        .filter_map(|(segment, (law, plastic))| {
            let law = law.as_ref()?;
            let wanted = if plastic.flows {
                law.softened
            } else {
                law.stiffness
            };
            let is_other = slopes.axial(segment).to_bits() != wanted.to_bits();
            is_other.then_some((segment, wanted))
        })
        .collect()
}
