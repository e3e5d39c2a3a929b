//! Laws of contact: what springs, friction and bonds make of overlap and slip.
//!
//! A law is a type of its own, one file each, chosen once for a scene: [`Frictionless`] remembers
//! nothing and turns nothing, [`Coulomb`] remembers its shear force, [`Bonded`] holds together
//! until it breaks.
mod bonded;
mod coulomb;
mod frictionless;

use std::fmt::Debug;

use pulp::Simd;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{Push, Slip, Touch};
use crate::granular::Vector;

pub(in crate::granular) use bonded::Bonded;
pub(in crate::granular) use coulomb::Coulomb;
pub(in crate::granular) use frictionless::Frictionless;

/// What a contact is told once, and its past.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct Past {
    /// k_T [N/m].
    pub(in crate::granular) stiffness: f64,
    /// tan φ.
    pub(in crate::granular) friction: f64,
    /// n₀, from a to b.
    pub(in crate::granular) normal: Vector,
    /// F_T on b [N].
    pub(in crate::granular) shear: Vector,
    /// The bond between the bodies, also after it broke.
    pub(in crate::granular) bond: Bond,
}

/// A bond and what is left of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct Bond {
    pub(in crate::granular) is_intact: bool,
    /// a_N and a_T [N].
    pub(in crate::granular) strength: [f64; 2],
    /// Overlap without force [m].
    pub(in crate::granular) rest: f64,
}

/// A law for the contacts of a block.
pub(in crate::granular) trait Law:
    Clone + Debug + Default + Send + Sync + Serialize + DeserializeOwned + 'static
{
    /// Whether there are shear forces.
    const IS_ROUGH: bool;

    /// Lanes in which something may act, given those that touch.
    #[inline(always)]
    fn acting<S: Simd>(&self, _simd: S, _part: usize, touching: S::m64s) -> S::m64s {
        touching
    }

    /// Forces of a contact in this step; of no meaning where it does not act.
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Push<S>;

    /// Nothing acts in this part of the block.
    fn forget<S: Simd>(&mut self, simd: S, part: usize);

    fn past(&self, lane: usize) -> Past;

    fn set_past(&mut self, lane: usize, past: &Past);
}

impl Past {
    /// F_N from the spring constant [N/m] and the overlap [m].
    pub(in crate::granular) fn normal_force(&self, stiffness: f64, overlap: f64) -> f64 {
        let force = stiffness * (overlap - self.bond.rest);
        if self.bond.is_intact {
            force
        } else {
            force.max(0.0)
        }
    }

    /// The same contact with its bodies in the other order.
    pub(in crate::granular) fn seen_from_b(&self) -> Self {
        Self {
            normal: -self.normal,
            shear: -self.shear,
            ..*self
        }
    }
}
