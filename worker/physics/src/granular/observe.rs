//! What is read off a scene in the middle of a step, when something is due.
//!
//! Contacts are read between the two phases of a step, where forces belong to the positions they
//! came from. Kinetic energy at that time is the mean of those half a step before and after.
use std::collections::BTreeMap;

use super::{
    Vector,
    contact::{
        law::Spring,
        lists::{Touching, Who},
    },
    engine::Engine,
    journal::Reading,
    motion::clump::Clump,
    survey::Sums,
};

/// A touching contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    /// Bodies of the spec, a < b; walls are numbered after the bodies, planes
    /// before meshes.
    pub(super) bodies: [u32; 2],
    /// Particles in memory; `None` for a wall.
    pub(super) particles: (usize, Option<usize>),
    /// Numbers of the particles in the order of the spec, or that of
    /// the plane or facet.
    numbers: [u32; 2],
    /// δ [m].
    pub(super) overlap: f64,
    /// Smaller radius [m].
    pub(super) radius: f64,
    /// From a to b.
    pub(super) normal: Vector,
    /// F_N on b [N].
    pub(super) normal_force: Vector,
    /// F_T on b [N].
    pub(super) shear_force: Vector,
    /// Tangents k_N, k_T [N/m].
    pub(super) stiffness: [f64; 2],
    /// c_N and c_T of the dashpots [N s/m].
    pub(super) dashpots: [f64; 2],
    /// Of the normal spring [m]; negative where a bond is stretched.
    pub(super) compression: f64,
    /// In both springs [J].
    pub(super) energy: f64,
    /// Whether an intact bond holds the bodies together.
    pub(super) is_bonded: bool,
}

impl Engine {
    /// A contact as it stands now; `None` for a facet that is not reached any more.
    pub(super) fn contact(&self, touching: &Touching<'_>) -> Option<Contact> {
        let particles = &self.state.particles;
        let centre = |particle: u32| &particles.centres[particle as usize].0;
        let bodies = self.model.masses.len() as u32;
        match touching.who {
            Who::Pair(pair) => {
                let [a, b] = pair.map(|particle| particle as usize);
                let between = particles.centres[b].vector() - particles.centres[a].vector();
                let [own, other] = pair.map(|particle| centre(particle)[3]);
                let distance = between.norm();
                let reach = own + other;
                let contact = Contact {
                    bodies: [particles.owners[a], particles.owners[b]],
                    particles: (a, Some(b)),
                    numbers: [particles.numbers[a], particles.numbers[b]],
                    radius: own.min(other),
                    ..self.held(touching, reach - distance, reach, between / distance)
                };
                Some(contact.in_order())
            }
            Who::Plane([particle, plane]) => {
                let face = &self.state.faces[plane as usize];
                let centre = centre(particle);
                let overlap = centre[3] - face.height(centre);
                let normal = Vector::from(face.normal());
                Some(Contact {
                    bodies: [particles.owners[particle as usize], bodies + plane],
                    particles: (particle as usize, None),
                    numbers: [particles.numbers[particle as usize], plane],
                    radius: centre[3],
                    ..self.held(touching, overlap, 2.0 * centre[3], normal)
                })
            }
            Who::Facet([particle, facet]) => {
                let facets = &self.model.facets;
                let sphere = &particles.centres[particle as usize];
                let near = facets.reach(&self.state.poses, sphere, 0, facet)?;
                let mesh = facets.facets[facet as usize].mesh;
                let wall = bodies + self.state.faces.len() as u32 + mesh;
                let (radius, normal) = (sphere.0[3], Vector::from(near.normal));
                Some(Contact {
                    bodies: [particles.owners[particle as usize], wall],
                    particles: (particle as usize, None),
                    numbers: [particles.numbers[particle as usize], facet],
                    radius,
                    ..self.held(touching, radius - near.distance, 2.0 * radius, normal)
                })
            }
        }
    }

    /// What a law holds along a normal at this overlap [m]; whose contact it is remains to be said.
    fn held(&self, touching: &Touching<'_>, overlap: f64, reach: f64, normal: Vector) -> Contact {
        let spring = Spring {
            constant: touching.constant,
            shear_ratio: touching.shear_ratio,
            overlap,
            reach,
        };
        let held = touching.law.held(touching.lane, &spring);
        let elastic = held.spring_force * normal;
        let sprung = Spring {
            overlap: held.compression,
            ..spring
        };
        Contact {
            bodies: [0; 2],
            particles: (0, None),
            numbers: [0; 2],
            overlap,
            radius: 0.0,
            normal,
            normal_force: held.force * normal,
            shear_force: held.shear,
            stiffness: held.stiffness,
            dashpots: held.dashpots,
            compression: held.compression,
            energy: (self.law.energy)(&sprung, elastic.norm_squared()) + held.shear_energy(),
            is_bonded: held.is_bonded,
        }
    }

    /// Kinetic energy of the half-step velocities [J]; bodies with nothing free are left out.
    pub(super) fn kinetic_energy(&self) -> f64 {
        let particles = &self.state.particles;
        let mut energy = 0.0;
        for particle in 0..particles.len() {
            let body = particles.owners[particle] as usize;
            let inertia = self.model.sphere_inertias[body];
            if inertia == 0.0 || !self.model.is_movable[body] {
                continue;
            }
            let speed = particles.velocities[particle].vector().norm_squared();
            energy += 0.5 * self.model.masses[body] * speed;
            if let Some(spin) = particles.spins.get(particle) {
                energy += 0.5 * inertia * spin.vector().norm_squared();
            }
        }
        for clump in &self.state.clumps {
            if self.model.is_movable[clump.body as usize] {
                let turning = clump.spin.dot(&clump.momentum_of(clump.spin));
                energy += 0.5 * (clump.mass * clump.velocity.norm_squared() + turning);
            }
        }
        energy
    }

    /// −m g·x summed over movable bodies [J].
    pub(super) fn gravitational_energy(&self) -> f64 {
        let particles = &self.state.particles;
        let gravity = self.model.gravity;
        let mut energy = 0.0;
        for particle in 0..particles.len() {
            let body = particles.owners[particle] as usize;
            if self.model.sphere_inertias[body] > 0.0 && self.model.is_movable[body] {
                energy -=
                    self.model.masses[body] * gravity.dot(&particles.centres[particle].vector());
            }
        }
        for clump in &self.state.clumps {
            if self.model.is_movable[clump.body as usize] {
                energy -= clump.mass * gravity.dot(&clump.centre);
            }
        }
        energy
    }

    /// Kinetic and gravitational energy [J].
    pub(super) fn energies(&self) -> [f64; 2] {
        let (kinetic, gravitational) =
            (self.team).both(|| self.kinetic_energy(), || self.gravitational_energy());
        [kinetic, gravitational]
    }

    /// What is read off the bodies after a step that began with the energies `before`
    /// ([`Engine::energies`]) and in which contacts added up to `sums`.
    pub(super) fn reading(&self, sums: &Sums, before: [f64; 2]) -> Reading {
        let mean_force = sums.force / sums.contacts as f64;
        let (kinetic, unbalanced) = (self.team).both(
            || self.kinetic_energy(),
            || self.unbalanced_force_ratio(mean_force),
        );
        let is_movable = &self.model.is_movable;
        let movable = self.present_bodies();
        let movable = movable.filter(|(body, ..)| is_movable[*body as usize]);
        let movable = movable.count();
        let coordination = sums.movable_ends as f64 / movable as f64;
        Reading {
            kinetic: 0.5 * (before[0] + kinetic),
            elastic: sums.elastic,
            gravitational: before[1],
            contacts: sums.contacts,
            bonds: sums.bonds,
            unbalanced,
            coordination: (movable > 0).then_some(coordination),
        }
    }

    /// Mean resultant force on movable bodies over the mean contact force [N], after a step.
    /// `None` without contacts. Source: Yade's `unbalancedForce`.
    fn unbalanced_force_ratio(&self, mean: f64) -> Option<f64> {
        if mean.is_nan() || mean <= 0.0 {
            return None;
        }
        let mut resultants: BTreeMap<u32, Vector> = BTreeMap::new();
        let mut sum = 0.0;
        let mut count = 0.0;
        for patch in &self.state.patches {
            for (particle, force) in patch.particles.clone().zip(&patch.wrenches.forces) {
                let body = self.state.particles.owners[particle];
                let place = body as usize;
                if !self.model.is_movable[place] {
                    continue;
                }
                if self.model.sphere_inertias[place] > 0.0 {
                    let weight = self.model.masses[place] * self.gravity;
                    let fixed = self.state.particles.fixed[particle];
                    let is_fixed = |axis: usize| fixed >> axis & 1 == 1;
                    sum += free_part(force.vector() + weight, is_fixed).norm();
                    count += 1.0;
                } else {
                    *resultants.entry(body).or_default() += force.vector();
                }
            }
        }
        for load in &self.loads {
            // of a sphere it is among the forces
            if let Some(force) = resultants.get_mut(&load.body) {
                *force += load.force;
            }
        }
        let mut clumps: Vec<&Clump> = self.state.clumps.iter().collect();
        // summed in the order of numbers
        clumps.sort_unstable_by_key(|clump| clump.body);
        for clump in clumps {
            if let Some(force) = resultants.get(&clump.body) {
                let weight = self.model.masses[clump.body as usize] * self.gravity;
                sum += free_part(force + weight, |axis| clump.fixed[axis]).norm();
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum / count / mean)
    }
}

/// What of a force moves a body.
fn free_part(mut force: Vector, is_fixed: impl Fn(usize) -> bool) -> Vector {
    for axis in (0..3).filter(|axis| is_fixed(*axis)) {
        force[axis] = 0.0;
    }
    force
}

/// Sorts contacts by their bodies.
pub(super) fn put_in_order(contacts: &mut [Contact]) {
    contacts.sort_by_key(|contact| (contact.bodies, contact.numbers));
}

impl Contact {
    /// With the lower body first.
    fn in_order(self) -> Self {
        if self.bodies[0] < self.bodies[1] {
            return self;
        }
        let [a, b] = self.bodies;
        let [first, second] = self.numbers;
        Self {
            bodies: [b, a],
            numbers: [second, first],
            particles: match self.particles {
                (first, Some(second)) => (second, Some(first)),
                alone => alone,
            },
            normal: -self.normal,
            normal_force: -self.normal_force,
            shear_force: -self.shear_force,
            ..self
        }
    }
}
