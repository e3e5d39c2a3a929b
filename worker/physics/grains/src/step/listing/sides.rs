//! What both sides bring to a contact. Where degrees of freedom are held, dashpots are made for what is left of
//! the others ([`freedom`](crate::contact::freedom)).
use std::borrow::Cow;

use super::Listing;
use crate::{
    contact::{
        freedom::Freedom,
        stiffness::{Resistance, Side, Springs},
    },
    motion::clump::Clump,
    numbers::Vector,
    scene::particles::Particles,
};

/// See [`Listing::held`].
pub(crate) fn held<'a>(particles: &'a Particles, clumps: &[Clump]) -> Cow<'a, [u8]> {
    let mut held = Cow::Borrowed(particles.fixed.as_slice());
    let partly = clumps.iter().filter(|clump| clump.fixed.contains(&true));
    for clump in partly {
        let bits = (0..6).map(|degree| u8::from(clump.fixed[degree]) << degree);
        held.to_mut()[clump.members()].fill(bits.sum());
    }
    held
}

impl Listing<'_> {
    /// What a particle brings to a contact.
    pub(super) fn side(&self, particle: usize) -> Side {
        let particles = self.particles;
        Side {
            surface: self.model.surfaces[usize::from(particles.surfaces[particle])],
            radius: particles.centres[particle].0[3],
            is_flat: false,
            inverse_mass: self.model.inverse_mass(particles.owners[particle] as usize),
            freedom: Freedom::WHOLE,
        }
    }

    /// What the facets of a mesh bring to a contact with a sphere.
    pub(super) fn facet_side(&self, own: &Side, mesh: usize) -> Side {
        let facets = &self.model.facets;
        let surface = self.model.surfaces[facets.meshes[mesh].surface];
        let wall = own.wall(surface, self.freedom_of(self.faces.len() + mesh));
        Side {
            radius: facets.radius_ratio * wall.radius,
            ..wall
        }
    }

    /// 1/m of a wall at a dashpot [1/kg].
    pub(super) fn freedom_of(&self, wall: usize) -> f64 {
        if self.model.is_viscous {
            self.plates[wall]
        } else {
            0.0
        }
    }

    /// With the dashpots of two sides some of whose degrees of freedom are held. (How large a step they
    /// allow is known of the sides as if they were free: these move more easily, and what they move has
    /// dashpots of the same ratio.)
    pub(super) fn held_back(
        &self,
        springs: Springs,
        sides: [Side; 2],
        held: [u8; 2],
        normal: impl FnOnce() -> Vector,
    ) -> Springs {
        let counts = |side: usize| held[side] != 0 && sides[side].inverse_mass > 0.0;
        if !(counts(0) || counts(1)) {
            return springs;
        }
        let normal = normal();
        let [own, other] = [0, 1].map(|side| sides[side].with(Freedom::left(held[side], &normal)));
        let found = (self.law.springs)(&own, &other);
        let resistance = Resistance {
            dashpots: found.resistance.dashpots,
            ..springs.resistance
        };
        Springs {
            dashpots: found.dashpots,
            resistance,
            ..springs
        }
    }

    /// Unit vector from one particle to another; where they are at one place, any.
    pub(super) fn between(&self, a: usize, b: usize) -> Vector {
        let [a, b] = [a, b].map(|particle| self.particles.centres[particle].vector());
        (b - a).try_normalize(0.0).unwrap_or_else(Vector::x)
    }
}
