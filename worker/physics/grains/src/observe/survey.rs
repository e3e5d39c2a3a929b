//! What is read off all contacts and bodies of a scene, when somebody looks.
//!
//! Each patch reads its own; its contacts are added up as they are read, and kept one by one only
//! where somebody asks for them. Sums are folded in the order of patches. Kinetic energy in the middle
//! of a step, where contacts are read, is the mean of those half a step before and after.
use serde::{Deserialize, Serialize};

use super::{
    contact::Contact,
    time_step::{Critical, PatchRows, Plates},
};
use crate::{
    numbers::Vector,
    scene::model::Model,
    step::{engine::Engine, patch::Patch},
};

/// What contacts add up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sums {
    pub(crate) contacts: u64,
    /// Intact bonds.
    pub(crate) bonds: u64,
    /// Ends of contacts at bodies that move.
    pub(crate) movable_ends: u64,
    /// In normal and shear springs [J].
    pub(crate) elastic: f64,
    /// Of the sizes of forces [N].
    pub(crate) force: f64,
    /// Largest compression over the smaller radius; of a bond, the change of its overlap.
    pub(crate) overlap_ratio: f64,
}

/// What bodies that move add up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BodySums {
    pub(crate) bodies: u64,
    /// Of half-step velocities [J].
    pub(crate) kinetic: f64,
    /// −m g·x from the middle of the scene at the start [J].
    pub(crate) gravitational: f64,
    /// What rounding a position may change in that [J].
    pub(crate) rounding: f64,
    /// Of the sizes of resultant forces in the last step, along what is free [N].
    pub(crate) resultant: f64,
}

/// All contacts, looked at.
#[derive(Clone, Debug)]
pub(crate) struct Survey {
    pub(crate) sums: Sums,
    /// `None` when no contact moves anything.
    pub(crate) critical: Option<Critical>,
    pub(crate) plates: Plates,
    /// In the order of patches, if they were asked for.
    pub(crate) contacts: Vec<Contact>,
}

/// What a look reads off a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reading {
    pub(crate) kinetic: f64,
    pub(crate) elastic: f64,
    pub(crate) gravitational: f64,
    /// What rounding the positions once may change in that [J].
    pub(crate) rounding: f64,
    /// That move.
    pub(crate) bodies: u64,
    pub(crate) contacts: u64,
    /// Intact bonds.
    pub(crate) bonds: u64,
    pub(crate) unbalanced: Option<f64>,
    /// Of bodies that move.
    pub(crate) coordination: Option<f64>,
}

impl Sums {
    fn add(&mut self, contact: &Contact, model: &Model) {
        let ends = contact.bodies.iter();
        let ends = ends.filter(|body| model.can_move(**body));
        self.contacts += 1;
        self.bonds += u64::from(contact.is_bonded);
        self.movable_ends += ends.count() as u64;
        self.elastic += contact.energy;
        self.force += (contact.normal_force + contact.shear_force).norm();
        let overlap_ratio = contact.compression.abs() / contact.radius;
        self.overlap_ratio = self.overlap_ratio.max(overlap_ratio);
    }

    fn join(&mut self, part: &Self) {
        self.contacts += part.contacts;
        self.bonds += part.bonds;
        self.movable_ends += part.movable_ends;
        self.elastic += part.elastic;
        self.force += part.force;
        self.overlap_ratio = self.overlap_ratio.max(part.overlap_ratio);
    }
}

impl BodySums {
    /// Kinetic and gravitational [J].
    pub(crate) fn energy(&self) -> f64 {
        self.kinetic + self.gravitational
    }

    fn join(&mut self, part: &Self) {
        self.bodies += part.bodies;
        self.kinetic += part.kinetic;
        self.gravitational += part.gravitational;
        self.rounding += part.rounding;
        self.resultant += part.resultant;
    }
}

impl Engine {
    /// Looks at all contacts that touch; to be called between the phases.
    pub(crate) fn survey(&self, keeps_contacts: bool) -> Survey {
        let work = self.state.patches.iter().zip(&self.contact_lists);
        let seen = self.team.map(work.collect(), |(patch, lists)| {
            let mut sums = Sums::default();
            let mut rows = PatchRows::new(patch, self.wall_count());
            let mut contacts = Vec::new();
            lists.see(&mut |touching| {
                let Some(contact) = self.contact(&touching) else {
                    return;
                };
                sums.add(&contact, &self.model);
                rows.add(&contact, patch, &self.model);
                if keeps_contacts {
                    contacts.push(contact);
                }
            });
            (sums, rows, contacts)
        });
        let mut sums = Sums::default();
        let mut rows = Vec::with_capacity(seen.len());
        let mut contacts = Vec::new();
        for (part, of_patch, some) in seen {
            sums.join(&part);
            rows.push(of_patch);
            contacts.extend(some);
        }
        let plates = self.plates_with(&rows);
        Survey {
            sums,
            critical: self.critical_step(rows, &plates),
            plates,
            contacts,
        }
    }

    /// Looks at all bodies that move.
    pub(crate) fn body_sums(&self) -> BodySums {
        let patches = self.state.patches.iter().collect();
        let mut sums = BodySums::default();
        for part in self.team.map(patches, |patch| self.body_sums_of(patch)) {
            sums.join(&part);
        }
        sums
    }

    fn body_sums_of(&self, patch: &Patch) -> BodySums {
        let (model, particles) = (&self.model, &self.state.particles);
        let first = patch.particles.start;
        // lists that are just made have no forces yet
        let force = |place: usize| {
            let force = patch.wrenches.forces.get(place);
            force.map_or(Vector::zeros(), |force| force.vector())
        };
        let mut sums = BodySums::default();
        let mut add = |mass: f64, centre: &Vector, motion: f64, force: Vector| {
            sums.join(&BodySums {
                bodies: 1,
                kinetic: 0.5 * motion,
                gravitational: -mass * model.gravity.dot(&(centre - model.middle)),
                rounding: mass * f64::EPSILON * model.gravity.component_mul(centre).abs().sum(),
                resultant: force.norm(),
            });
        };
        let clumps = &self.state.clumps[patch.clumps.clone()];
        for place in patch.single_spheres(clumps).flatten() {
            let particle = first + place;
            let body = particles.owners[particle] as usize;
            if model.is_movable[body] {
                let mass = model.masses[body];
                let speed = particles.velocities[particle].vector().norm_squared();
                let spin = particles.spins.get(particle);
                let turning = spin.map_or(0.0, |spin| {
                    model.sphere_inertias[body] * spin.vector().norm_squared()
                });
                let force = force(place) + mass * self.gravity;
                let fixed = particles.fixed[particle];
                let free = free_part(force, |axis| fixed >> axis & 1 == 1);
                let centre = particles.centres[particle].vector();
                add(mass, &centre, mass * speed + turning, free);
            }
        }
        for clump in clumps {
            if model.is_movable[clump.body as usize] {
                let speed = clump.velocity.norm_squared();
                let turning = clump.spin.dot(&clump.momentum_of(clump.spin));
                let own = clump.members().map(|member| force(member - first));
                // of a sphere it is among the forces
                let loads = self.loads.iter().filter(|load| load.body == clump.body);
                let loads = loads.map(|load| load.force).sum::<Vector>();
                let force = own.sum::<Vector>() + loads + clump.mass * self.gravity;
                let free = free_part(force, |axis| clump.fixed[axis]);
                add(
                    clump.mass,
                    &clump.centre,
                    clump.mass * speed + turning,
                    free,
                );
            }
        }
        sums
    }

    /// What is read off a scene after a step that began with bodies that added up to `before` and in
    /// which contacts added up to `sums`. The unbalanced force ratio is the mean resultant force over
    /// the mean contact force. Source: Yade's `unbalancedForce`.
    pub(crate) fn reading(&self, sums: &Sums, before: &BodySums) -> Reading {
        let after = self.body_sums();
        let bodies = after.bodies as f64;
        let mean_force = sums.force / sums.contacts as f64;
        Reading {
            kinetic: 0.5 * (before.kinetic + after.kinetic),
            elastic: sums.elastic,
            gravitational: before.gravitational,
            rounding: before.rounding,
            bodies: after.bodies,
            contacts: sums.contacts,
            bonds: sums.bonds,
            unbalanced: (after.bodies > 0 && mean_force > 0.0)
                .then(|| after.resultant / bodies / mean_force),
            coordination: (after.bodies > 0).then(|| sums.movable_ends as f64 / bodies),
        }
    }
}

/// What of a force moves a body.
fn free_part(mut force: Vector, is_fixed: impl Fn(usize) -> bool) -> Vector {
    for axis in (0..3).filter(|axis| is_fixed(*axis)) {
        force[axis] = 0.0;
    }
    force
}
