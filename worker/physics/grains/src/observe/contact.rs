//! A contact as observers see it.
//!
//! Contacts are read between the two phases of a step, where forces belong to the positions they
//! came from.
use crate::{
    contact::{
        law::Spring,
        touching::{Touching, Who},
    },
    numbers::Vector,
    step::engine::Engine,
};

/// A touching contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Bodies of the spec, a < b; walls are numbered after the bodies, planes
    /// before meshes.
    pub(crate) bodies: [u32; 2],
    /// Particles in memory; `None` for a wall.
    pub(crate) particles: (usize, Option<usize>),
    /// Numbers of the particles in the order of the spec, or that of
    /// the plane or facet.
    numbers: [u32; 2],
    /// δ [m].
    pub(crate) overlap: f64,
    /// Smaller radius [m].
    pub(crate) radius: f64,
    /// From a to b.
    pub(crate) normal: Vector,
    /// F_N on b [N].
    pub(crate) normal_force: Vector,
    /// F_T on b [N].
    pub(crate) shear_force: Vector,
    /// Tangents k_N, k_T [N/m].
    pub(crate) stiffness: [f64; 2],
    /// c_N and c_T of the dashpots [N s/m].
    pub(crate) dashpots: [f64; 2],
    /// Of springs and dashpots against rolling and twisting, on b [N m].
    pub(crate) moment: Vector,
    /// k_r and k_t [N m].
    pub(crate) turning_stiffness: [f64; 2],
    /// c_r and c_t [N m s].
    pub(crate) turning_dashpots: [f64; 2],
    /// Of the normal spring [m]; negative where a bond is stretched.
    pub(crate) compression: f64,
    /// In all springs [J].
    pub(crate) energy: f64,
    /// Whether an intact bond holds the bodies together.
    pub(crate) is_bonded: bool,
}

impl Engine {
    /// A contact as it stands now; `None` for a facet that is not reached any more.
    pub(crate) fn contact(&self, touching: &Touching<'_>) -> Option<Contact> {
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
                    ..self.along(touching, reach - distance, reach, between / distance)
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
                    ..self.along(touching, overlap, 2.0 * centre[3], normal)
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
                    ..self.along(touching, radius - near.distance, 2.0 * radius, normal)
                })
            }
        }
    }

    /// What a law does along a normal at this overlap [m]; whose contact it is remains to be said.
    fn along(&self, touching: &Touching<'_>, overlap: f64, reach: f64, normal: Vector) -> Contact {
        let spring = Spring {
            constant: touching.constant,
            shear_ratio: touching.shear_ratio,
            overlap,
            reach,
        };
        let forces = touching.law.forces(touching.lane, &spring);
        let elastic = forces.spring_force * normal;
        let sprung = Spring {
            overlap: forces.compression,
            ..spring
        };
        Contact {
            bodies: [0; 2],
            particles: (0, None),
            numbers: [0; 2],
            overlap,
            radius: 0.0,
            normal,
            normal_force: forces.force * normal,
            shear_force: forces.shear,
            stiffness: forces.stiffness,
            dashpots: forces.dashpots,
            moment: forces
                .moment
                .unwrap_or_else(|| forces.rolling + forces.twisting * normal),
            turning_stiffness: forces.turning_stiffness,
            turning_dashpots: forces.turning_dashpots,
            compression: forces.compression,
            energy: (self.law.energy)(&sprung, elastic.norm_squared()) + forces.tangential_energy(),
            is_bonded: forces.is_bonded,
        }
    }
}

/// Sorts contacts by their bodies.
pub(crate) fn put_in_order(contacts: &mut [Contact]) {
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
            moment: -self.moment,
            ..self
        }
    }
}
