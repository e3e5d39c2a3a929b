//! What is measured in a box: stress, porosity, coordination, inertial number.
//!
//! The stress is that of Love and Weber, compression positive,
//!
//!   σ = 1/V Σ_c w F_b ⊗ l (G.21)
//!
//! with the force F_b on the contact's second body, the branch l between the bodies' centres of mass
//! (at a wall: to the contact point), and the part w of the branch that lies in the box; of the
//! tensor the symmetric part. The inertial number is I = γ̇ d √(ρ/p) (G.22) with the pressure
//! p = tr σ/3, mean density ρ and mean diameter d of the bodies (of spheres of their volume), and the
//! shear rate γ̇ = √(2 D:D) of the affine motion that fits the velocities of their centres best.
//! Below 10⁻³ flow is quasi-static.
//!
//! Solid volume is that of spheres cut by the box; of a clump that is cut, the members' share is
//! scaled to the volume of their union. What touching bodies share is counted twice.
//!
//! Source: [Love1927], [Weber1966]; [GdrMidi2004].
use nalgebra::Matrix3;

use super::contact::Contact;
use crate::{
    geometry::{
        solid_share::{Cuboid, sphere_volume_within},
        sphere,
    },
    motion::clump::Clump,
    numbers::Vector,
    step::engine::Engine,
};

/// Parts of the largest principal spread below which centres have none in that direction.
const FLAT: f64 = 1e-12;

/// The bodies whose centres are in a box, as a continuum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Measure {
    /// V of the box [m³].
    volume: f64,
    /// σ [Pa], compression positive.
    stress: Matrix3<f64>,
    /// Contacts per movable body in it.
    coordination: Option<f64>,
    /// γ̇ [1/s].
    shear_rate: f64,
    /// d √ρ of the bodies in it [√(kg/m)].
    inertia: f64,
}

/// A body as a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    centre: Vector,
    velocity: Vector,
    mass: f64,
    volume: f64,
    /// Of a sphere of its volume [m].
    diameter: f64,
    /// Number of its material.
    surface: usize,
}

/// Every body of the state, by number; none where it has no place there.
pub(crate) type Points = [Option<Point>];

impl Measure {
    /// p [Pa].
    pub(crate) fn pressure(&self) -> f64 {
        self.stress.trace() / 3.0
    }

    /// I; `None` where nothing presses.
    pub(crate) fn inertial_number(&self) -> Option<f64> {
        let pressure = self.pressure();
        (pressure > 0.0).then(|| self.shear_rate * self.inertia / pressure.sqrt())
    }

    /// The numbers of a region's columns in the curve, given the solid volume in the box [m³]; unknown ones are left at 0.
    pub(crate) fn row(&self, solid: f64) -> [f64; 10] {
        let stress = &self.stress;
        let porosity = if self.volume > 0.0 {
            1.0 - solid / self.volume
        } else {
            0.0
        };
        [
            porosity,
            self.coordination.unwrap_or(0.0),
            self.inertial_number().unwrap_or(0.0),
            self.pressure(),
            stress[(0, 0)],
            stress[(1, 1)],
            stress[(2, 2)],
            stress[(0, 1)],
            stress[(0, 2)],
            stress[(1, 2)],
        ]
    }
}

impl Engine {
    /// A box between two corners: where one is left out, that of the bodies within the planes.
    pub(crate) fn cuboid(&self, corners: [Option<[f64; 3]>; 2]) -> Cuboid {
        let (mut low, mut high) = (
            Vector::repeat(f64::INFINITY),
            Vector::repeat(f64::NEG_INFINITY),
        );
        for centre in &self.state.particles.centres {
            low = low.inf(&centre.vector().add_scalar(-centre.0[3]));
            high = high.sup(&centre.vector().add_scalar(centre.0[3]));
        }
        // between planes the box reaches from one to the other, whatever the bodies fill
        for axis in 0..3 {
            let across = |facing: f64| {
                let faces = self.state.faces.iter();
                let faces =
                    faces.filter(move |face| face.axis == axis && face.facing * facing > 0.0);
                faces.map(|face| face.position)
            };
            low[axis] = across(1.0).reduce(f64::max).unwrap_or(low[axis]);
            high[axis] = across(-1.0).reduce(f64::min).unwrap_or(high[axis]);
        }
        Cuboid {
            low: corners[0].map_or(low, Vector::from),
            high: corners[1].map_or(high, Vector::from),
        }
    }

    /// Measures a box, between the phases of a step or after it: all bodies, or those of one surface;
    /// the others are walls to them.
    pub(crate) fn measure(
        &self,
        cuboid: &Cuboid,
        only: Option<usize>,
        points: &Points,
        contacts: &[Contact],
    ) -> Measure {
        let volume = cuboid.volume();
        if volume <= 0.0 || !volume.is_finite() {
            return Measure::default();
        }
        let is_counted = |point: &Point| only.is_none_or(|only| only == point.surface);
        let of = |body: u32| {
            let point = points.get(body as usize).and_then(Option::as_ref);
            point.filter(|point| is_counted(point))
        };
        let contains = |point: &Point| is_counted(point) && cuboid.contains(&point.centre);
        let is_within: Vec<bool> = (points.iter())
            .map(|point| point.as_ref().is_some_and(contains))
            .collect();
        let within = points.iter().zip(&is_within);
        let within: Vec<&Point> = within
            .filter(|(_, is_within)| **is_within)
            .filter_map(|(point, _)| point.as_ref())
            .collect();
        let count = within.len() as f64;
        let sum = |of: fn(&Point) -> f64| within.iter().map(|point| of(point)).sum::<f64>();
        let diameter = sum(|point| point.diameter) / count.max(1.0);
        let density = sum(|point| point.mass) / sum(|point| point.volume);
        Measure {
            volume,
            stress: self.love_weber(cuboid, contacts, of) / volume,
            coordination: self.coordination(&is_within, contacts),
            shear_rate: shear_rate(&within),
            inertia: if count > 0.0 {
                diameter * density.sqrt()
            } else {
                0.0
            },
        }
    }

    /// The bodies as points.
    pub(crate) fn points(&self) -> Vec<Option<Point>> {
        let particles = &self.state.particles;
        let mut points: Vec<Option<Point>> = vec![None; self.model.masses.len()];
        let mut put = |body: u32, centre: Vector, velocity: Vector, particle: usize| {
            let mass = self.model.masses[body as usize];
            let volume = mass / self.density(particle);
            points[body as usize] = Some(Point {
                centre,
                velocity,
                mass,
                volume,
                diameter: (6.0 / std::f64::consts::PI * volume).cbrt(),
                surface: usize::from(particles.surfaces[particle]),
            });
        };
        for (particle, body) in particles.owners.iter().enumerate() {
            if self.model.sphere_inertias[*body as usize] > 0.0 {
                let [centre, velocity] =
                    [&particles.centres, &particles.velocities].map(|rows| rows[particle].vector());
                put(*body, centre, velocity, particle);
            }
        }
        for clump in &self.state.clumps {
            let member = clump.first as usize;
            put(clump.body, clump.centre, clump.velocity, member);
        }
        points
    }

    fn density(&self, particle: usize) -> f64 {
        self.model.surfaces[usize::from(self.state.particles.surfaces[particle])].density
    }

    /// Whether a particle is of this surface, if only that counts.
    fn is_of(&self, only: Option<usize>, particle: usize) -> bool {
        let surface = usize::from(self.state.particles.surfaces[particle]);
        only.is_none_or(|only| only == surface)
    }

    /// Solid volume in a box [m³], of all bodies or those of one surface.
    pub(crate) fn solid(&self, cuboid: &Cuboid, only: Option<usize>) -> f64 {
        let particles = &self.state.particles;
        let share = |particle: usize| {
            let centre = &particles.centres[particle];
            sphere_volume_within(cuboid, &centre.vector(), centre.0[3])
        };
        let spheres = (0..particles.len()).filter(|particle| {
            self.model.sphere_inertias[particles.owners[*particle] as usize] > 0.0
                && self.is_of(only, *particle)
        });
        let spheres: f64 = spheres.map(share).sum();
        let clumps = self.state.clumps.iter();
        let clumps = clumps.filter(|clump| self.is_of(only, clump.first as usize));
        let clumps = clumps.map(|clump| {
            let [union, whole] = self.union_and_members(clump);
            clump.members().map(share).sum::<f64>() * union / whole
        });
        spheres + clumps.sum::<f64>()
    }

    /// Volume of a clump's union and of its members together [m³].
    fn union_and_members(&self, clump: &Clump) -> [f64; 2] {
        let radii = (clump.members()).map(|member| self.state.particles.centres[member].0[3]);
        let whole: f64 = radii.map(sphere::volume).sum();
        [clump.mass / self.density(clump.first as usize), whole]
    }

    /// Every particle that counts as solid, of all bodies or those of one surface, with the part of its
    /// volume that does: of a clump's member its share of the union.
    pub(crate) fn solid_spheres(&self, only: Option<usize>, see: &mut dyn FnMut(usize, f64)) {
        let particles = &self.state.particles;
        for (particle, owner) in particles.owners.iter().enumerate() {
            if self.model.sphere_inertias[*owner as usize] > 0.0 && self.is_of(only, particle) {
                see(particle, 1.0);
            }
        }
        for clump in &self.state.clumps {
            if self.is_of(only, clump.first as usize) {
                let [union, whole] = self.union_and_members(clump);
                clump
                    .members()
                    .for_each(|member| see(member, union / whole));
            }
        }
    }

    /// Σ w F ⊗ l [J], its symmetric part.
    fn love_weber<'p>(
        &self,
        cuboid: &Cuboid,
        contacts: &[Contact],
        of: impl Fn(u32) -> Option<&'p Point>,
    ) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for contact in contacts {
            let ends = contact.bodies.map(&of);
            if ends.iter().all(Option::is_none) {
                continue;
            }
            // a branch that begins or ends at a wall does so where it touches: in its face, or in the
            // middle of the overlap with a sphere
            let touch = || {
                let first = &self.state.particles.centres[contact.particles.0];
                let depth = match contact.particles.1 {
                    Some(_) => 0.5 * contact.overlap,
                    None => contact.overlap,
                };
                first.vector() + contact.normal * (first.0[3] - depth)
            };
            let [start, end] = ends.map(|point| point.map_or_else(touch, |point| point.centre));
            let branch = end - start;
            let part = cuboid.part_of_segment(&start, &branch);
            if part > 0.0 {
                let force = contact.normal_force + contact.shear_force;
                sum += part * force * branch.transpose();
            }
        }
        0.5 * (sum + sum.transpose())
    }

    /// Contacts per movable body, of those `is_within`.
    fn coordination(&self, is_within: &[bool], contacts: &[Contact]) -> Option<f64> {
        let is_counted =
            |body: &u32| is_within.get(*body as usize) == Some(&true) && self.model.can_move(*body);
        let bodies = (0..is_within.len() as u32).filter(is_counted).count();
        let ends = contacts.iter().flat_map(|contact| contact.bodies);
        let ends = ends.filter(is_counted).count();
        (bodies > 0).then(|| ends as f64 / bodies as f64)
    }
}

/// γ̇ of the affine motion v = v₀ + L (x − x₀) that fits best [1/s]: L = Σ v xᵀ (Σ x xᵀ)⁻¹ from the
/// means; directions without extent are left out.
fn shear_rate(points: &[&Point]) -> f64 {
    let count = (points.len() as f64).max(1.0);
    let mean =
        |of: fn(&Point) -> Vector| points.iter().map(|point| of(point)).sum::<Vector>() / count;
    let (centre, velocity) = (mean(|point| point.centre), mean(|point| point.velocity));
    let (mut moments, mut spread) = (Matrix3::zeros(), Matrix3::zeros());
    for point in points {
        let away = point.centre - centre;
        moments += (point.velocity - velocity) * away.transpose();
        spread += away * away.transpose();
    }
    let axes = spread.symmetric_eigen();
    let least = FLAT * axes.eigenvalues.max();
    let inverse = axes
        .eigenvalues
        .map(|value| if value > least { 1.0 / value } else { 0.0 });
    let gradient = moments
        * axes.eigenvectors
        * Matrix3::from_diagonal(&inverse)
        * axes.eigenvectors.transpose();
    let rate = 0.5 * (gradient + gradient.transpose());
    (2.0 * rate.dot(&rate)).sqrt()
}
