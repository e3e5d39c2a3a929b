//! Rest at one elongation after a part is gone.
//!
//! What the part bore goes to the others at once: no path is known, and every segment goes straight from
//! where it was to where it is. So the rest is the least of a convex energy, elastic and lost, and
//! unique [SimoHughes1998]. Newton's steps with the slopes of the laws find it, halved where the energy
//! would rise.
use loadframe_numerics::equilibrium::{Newton, Settled, Unbalanced, halved, settle};

use super::super::balance::Motion;
use super::super::equilibrium::{BALANCED, Equilibrium, ROUND_OFF, UNBALANCED};
use super::super::error::FrameError;
use super::law::Plastic;
use super::strained::Strained;

/// Iterations before giving up; 3 to 10 are usual.
const ITERATIONS: u32 = 200;
const HALVINGS: u32 = 29;
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
    let mut way = Way {
        energy: strained.forces.energy + strained.dissipated_nj(),
        from: strained.motion.clone(),
        flowed: before.clone(),
        before,
        strained,
        slopes,
        largest_mn,
        right: Vec::new(),
        residual: f64::INFINITY,
    };
    match settle(&mut way, ITERATIONS)? {
        Settled::AtRest(_) => Ok(way.residual),
        Settled::Stuck(_) | Settled::Slow => Err(FrameError::Unbalanced {
            residual: way.residual,
            allowed: UNBALANCED,
            iterations: ITERATIONS as usize,
        }),
    }
}

/// The way of what is strained to its rest.
struct Way<'w, 'n, 's> {
    strained: &'w mut Strained<'n>,
    slopes: &'w mut Equilibrium<'s>,
    largest_mn: f64,
    /// What segments were longer when their part was gone: all go on from there.
    before: Vec<Plastic>,
    energy: f64,
    right: Vec<f64>,
    residual: f64,
    /// Where the last step began.
    from: Motion,
    flowed: Vec<Plastic>,
}

impl Newton for Way<'_, '_, '_> {
    type Failure = FrameError;

    fn is_at_rest(&mut self, steps: u32) -> Result<bool, FrameError> {
        let forces = &self.strained.forces;
        self.right = self.slopes.unbalanced(forces);
        let left = Unbalanced {
            largest: self.slopes.worst_force(&self.right),
            scale: forces.scale.max(self.largest_mn),
            round_off: ROUND_OFF * forces.round_off,
        };
        let last = std::mem::replace(&mut self.residual, left.share());
        let is_stuck = steps > 3 && self.residual <= UNBALANCED && self.residual > 0.3 * last;
        Ok(left.is_within(BALANCED) || is_stuck)
    }

    fn advance(&mut self) -> Result<bool, FrameError> {
        let changed = changes(self.strained, self.slopes);
        self.slopes.change(&changed)?;
        self.slopes.solve(&mut self.right);
        self.from.nodes.clone_from(&self.strained.motion.nodes);
        self.flowed.clone_from(&self.strained.plastic);
        let (strained, slopes) = (&mut *self.strained, &*self.slopes);
        halved(1.0, HALVINGS, |share, _| {
            slopes.add_to(&mut strained.motion, &self.right, share);
            strained.flow(slopes.active(), &self.before);
            let there = strained.forces.energy + strained.dissipated_nj();
            if there <= self.energy + ENERGY_ROUND_OFF * self.energy.abs() {
                self.energy = there;
                return Ok(true);
            }
            strained.motion.nodes.clone_from(&self.from.nodes);
            strained.plastic.clone_from(&self.flowed);
            Ok(false)
        })
        // where no share of it lowers the energy, what is left may still be round-off
        .map(|_| true)
    }
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
