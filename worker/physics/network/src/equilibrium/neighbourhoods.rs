//! Equilibrium of the few nodes that are far from it, while all others rest.
//!
//! Where a bond broke or buckled the net moves far, elsewhere hardly at all. Newton's method on the
//! whole needs several iterations for that place, each as dear as if everything moved. So the worst
//! nodes are brought to equilibrium together with what is a few bonds around them, part by part; the
//! step of the whole that follows is nearly linear. As the others rest, the energy of the whole
//! falls by as much as that of the parts.
//!
//! Source: nonlinear elimination, [LanzkronRoseWilkes1996].
mod pocket;
mod rows;

use loadframe_harness::Interrupt;

use super::{Search, work::Meter};
use crate::{
    assembly::Assembly,
    configuration::{Configuration, Residual},
    places::NONE,
};
use pocket::{Pocket, WAITING};

/// A node counts as far from equilibrium when its resultant is this part of the largest: what is
/// nearer is for the step of the whole.
const SHARE_OF_WORST: f64 = 0.1;
/// And when it is beyond this part of the limit: less is not worth a part, and together as much as
/// long waves may leave. At a half, six tests of PET to 10 % at A_cc 10 take a quarter fewer conjugate
/// gradient iterations and are off by up to 0.6 % instead of 0.3 % in the Poisson ratio.
const SHARE_OF_LIMIT: f64 = 0.2;
/// Root mean square of the resultants over the limit below which long waves are found: what is left
/// are single nodes, mostly soft ones, for which a step of the whole takes as many iterations as for
/// everything (wide nets 75, to move sixteen nodes of 750 000). From 0.15 to 0.3 all serve alike; at
/// 0.1 PET tests take a tenth more iterations.
const CALM: f64 = 0.15;
/// A_cc below which it is less in proportion: what is small beside such a limit is not small beside the
/// forces. At A_cc 5 the modulus of PET would be off by 1.4 % instead of 0.2 %.
const ACCURATE: f64 = 50.0;
/// When all is calm only what is beyond this part of the limit is far from equilibrium. 0.8 and
/// 0.95 serve alike; at 0.6 PET tests take a tenth more iterations.
const SHARE_OF_LIMIT_WHEN_CALM: f64 = 0.8;
/// Parts are balanced again without a step of the whole when that made the largest resultant fall to
/// this part of itself, or to the second when all else is calm.
const AGAIN: [f64; 2] = [0.5, 0.9];
/// Bonds from a node far from equilibrium to the nodes at rest: with fewer too much of its force is
/// handed on to them, with more the part costs as much as it saves. From 4 to 7 all serve alike.
const RINGS: usize = 5;
/// Parts of more than this share of the free nodes together cost as much as the whole.
const LARGEST_SHARE: f64 = 0.15;
/// More nodes far from equilibrium than this share of the free ones are hardly ever so close together
/// that their parts would be small: to list those would be in vain.
const MOST_FAR: f64 = LARGEST_SHARE / 12.0;
/// Part of the limit below which the root mean square of the resultants is calm, at this A_cc.
pub(crate) fn calm(force_accuracy: f64) -> f64 {
    CALM * (force_accuracy / ACCURATE).min(1.0)
}

/// Memory that passes use one after the other.
#[derive(Debug, Default)]
pub(super) struct Neighbourhoods {
    /// Nodes of the parts, the far ones first.
    members: Vec<u32>,
    /// Of each place: [`WAITING`] when it is among the members and in no part yet, its number in a
    /// part under construction, else [`NONE`].
    numbers: Vec<u32>,
    pocket: Pocket,
}

impl Neighbourhoods {
    /// Balances what is about the nodes farthest from equilibrium, if that is little; returns the
    /// largest resultant [N] below which that is worth doing again, `None` when nothing moved.
    ///
    /// # Errors
    /// The interrupt that ended it early.
    pub(super) fn relax(
        &mut self,
        search: &Search,
        assembly: &Assembly,
        here: &mut Configuration,
        residual: &Residual,
        meter: &mut Meter<'_>,
    ) -> Result<Option<f64>, Interrupt> {
        let is_calm = residual.mean < search.calm * search.force_limit;
        let (share, again) = if is_calm {
            (SHARE_OF_LIMIT_WHEN_CALM, AGAIN[1])
        } else {
            (SHARE_OF_LIMIT, AGAIN[0])
        };
        let far = (SHARE_OF_WORST * residual.largest).max(share * search.force_limit);
        if !self.gather(assembly, here, far) || self.members.is_empty() {
            return Ok(None);
        }
        for member in &self.members {
            if self.numbers[*member as usize] == WAITING {
                self.pocket.grow(assembly, *member, &mut self.numbers);
                self.pocket.balance(search, assembly, here, meter)?;
                here.hold_back(assembly);
            }
        }
        Ok(Some(again * residual.largest))
    }

    /// Lists the nodes whose resultant exceeds `force` [N] and those around them; returns false
    /// when they are too many.
    fn gather(&mut self, assembly: &Assembly, here: &Configuration, force: f64) -> bool {
        let [most, most_far] =
            [LARGEST_SHARE, MOST_FAR].map(|share| (share * assembly.free().len() as f64) as usize);
        self.members.clear();
        here.list_beyond(assembly, force, &mut self.members);
        // what a guide holds rests as long as only parts move
        self.members
            .retain(|member| assembly.guide_of(*member as usize).is_none());
        if self.members.len() > most_far {
            return false;
        }
        self.numbers.resize(assembly.places(), NONE);
        for member in &self.members {
            self.numbers[*member as usize] = WAITING;
        }
        let (incidence, free) = (assembly.incidence(), assembly.free());
        let mut ring = 0;
        'rings: for _ in 0..RINGS {
            let end = self.members.len();
            for index in ring..end {
                if self.members.len() > most {
                    break 'rings;
                }
                let node = self.members[index] as usize;
                for (slot, neighbour) in incidence.around(node) {
                    let number = &mut self.numbers[neighbour as usize];
                    // most were met before
                    if *number == NONE
                        && assembly.acts(slot as usize)
                        && free.contains(&(neighbour as usize))
                        && assembly.guide_of(neighbour as usize).is_none()
                    {
                        *number = WAITING;
                        self.members.push(neighbour);
                    }
                }
            }
            ring = end;
        }
        let is_little = self.members.len() <= most;
        if !is_little {
            for member in &self.members {
                self.numbers[*member as usize] = NONE;
            }
        }
        is_little
    }
}

#[cfg(test)]
mod tests;
