//! What bonds still hold together.
//!
//! Bodies are joined by their intact bonds; a fragment is named by its lowest body.
use loadframe_api::DisjointSets;

use super::survey::Reading;
use crate::{contact::touching::Who, step::engine::Engine};

/// The fragment of each body.
#[derive(Clone, Debug)]
pub(crate) struct Fragments(Vec<u32>);

impl Fragments {
    /// As the bonds of the last step hold.
    pub(crate) fn of(engine: &Engine) -> Self {
        Self::joined(engine.model.masses.len(), &engine.bonded_bodies())
    }

    /// Of so many bodies, joined by these pairs.
    pub(crate) fn joined(bodies: usize, pairs: &[[u32; 2]]) -> Self {
        let mut sets = DisjointSets::new(bodies);
        for [a, b] in pairs {
            sets.join(*a, *b);
        }
        Self(sets.into_roots())
    }

    /// The lowest body of the fragment that a body is part of.
    pub(crate) fn of_body(&self, body: u32) -> u32 {
        self.0[body as usize]
    }
}

impl Engine {
    /// Pairs of bodies that an intact bond holds together.
    pub(crate) fn bonded_bodies(&self) -> Vec<[u32; 2]> {
        let owners = &self.state.particles.owners;
        let mut bonded = Vec::new();
        for lists in &self.contact_lists {
            lists.see(&mut |touching| {
                if let Who::Pair(pair) = touching.who
                    && touching.law.past(touching.lane).bond.is_intact
                {
                    bonded.push(pair.map(|particle| owners[particle as usize]));
                }
            });
        }
        bonded
    }

    /// Bonds that broke, as far as they are in the scene.
    pub(crate) fn broken_bonds(&self, reading: &Reading) -> u64 {
        let state = &self.state;
        state.bonds_made - state.bonds_removed - reading.bonds
    }

    pub(crate) fn intact_bonds(&self) -> u64 {
        self.bonded_bodies().len() as u64
    }
}
