//! From spec to model: what a scene is made of, resolved and in SI, and the state it starts from.
use loadframe_api::spec::granular_scene::{
    Body, BondRestLength, ContactFriction, Convention, GranularScene, Material, Plane, Touching,
};
use loadframe_harness::{Interrupt, InterruptSource};
use nalgebra::UnitQuaternion;

use super::{particles::Particles, specimen::Specimen};
use crate::{
    contact::stiffness::Surface,
    geometry::{
        sphere::Sphere,
        union::{mass_properties, principal_axes},
    },
    motion::clump::{Clump, Rotation},
    numbers::{Vector, rows::Row},
    walls::{Face, facets::Facets, motion::WallMotion},
};

/// Number of the grain of a body that is in none.
pub(crate) const NO_GRAIN: u32 = u32::MAX;
/// Bodies between two looks for interrupts.
const BODIES_PER_LOOK: usize = 4096;

/// What stays as it is during a run.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    /// By number of material, in the order of names, then those of planes with a stiffness of their own.
    pub(crate) surfaces: Vec<Surface>,
    /// The same as the spec has them.
    pub(crate) first_surfaces: Vec<Surface>,
    /// Whether anything has friction, cohesion or resistance to rolling.
    pub(crate) is_rough: bool,
    /// Whether contacts have dashpots, or may have them beside what resists rolling.
    pub(crate) is_viscous: bool,
    /// Whether a bond rests where it is made, and not where its spheres just touch.
    pub(crate) bonds_rest_as_made: bool,
    /// What cohesions are multiplied with now.
    pub(crate) cohesion_factor: f64,
    /// Whether contacts keep the friction that they began with.
    pub(crate) keeps_friction: bool,
    pub(crate) gravity: Vector,
    pub(crate) damping: f64,
    pub(crate) rotation: Rotation,
    pub(crate) planes: Vec<PlaneModel>,
    pub(crate) facets: Facets,
    /// Mass of each body by its number, also of those that wait [kg].
    pub(crate) masses: Vec<f64>,
    /// Whether forces move each body.
    pub(crate) is_movable: Vec<bool>,
    /// Which bodies and walls have contacts with each other.
    pub(crate) touching: Touching,
    /// Inertia of each sphere body about its centre [kg m²]; 0 for clumps, which know their own.
    pub(crate) sphere_inertias: Vec<f64>,
    /// Whether a body is driven by a stage, or moved at a velocity of its own along a fixed degree of
    /// freedom, so that work is done on the scene that is not measured.
    pub(crate) has_driven_bodies: bool,
    /// Bodies that some stage drives.
    pub(crate) driven: Vec<DrivenBody>,
    /// Box of all bodies and walls at the start [m].
    pub(crate) first_box: (Vector, Vector),
    /// Its middle, from which potential energy is measured [m].
    pub(crate) middle: Vector,
    /// Orientation of each clump's principal axes at the start; none for spheres.
    pub(crate) orientations: Vec<UnitQuaternion<f64>>,
    /// Spin that each body starts with [rad/s].
    pub(crate) spins: Vec<Vector>,
    /// First body of the breakable grain that each body is part of, or [`NO_GRAIN`]; empty when
    /// nothing is breakable.
    pub(crate) grains: Vec<u32>,
}

/// A plane of the spec.
#[derive(Clone, Debug)]
pub(crate) struct PlaneModel {
    pub(crate) name: String,
    pub(crate) surface: usize,
    pub(crate) face: Face,
}

/// What a driven body comes back to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrivenBody {
    pub(crate) body: u32,
    /// Centre of mass at the start [m].
    pub(crate) start: Vector,
    /// Whether its spec fixes x, y, z.
    pub(crate) fixed: [bool; 3],
    /// Velocity of its spec [m/s].
    pub(crate) velocity: [f64; 3],
}

/// I/(m r²) of a solid sphere.
const SPHERE_INERTIA: f64 = 0.4;

impl Model {
    pub(crate) fn new(spec: &GranularScene, specimen: &Specimen<'_>) -> Self {
        let names: Vec<&String> = spec.materials.keys().collect();
        let number = |name: &String| names.binary_search(&name).unwrap_or_default();
        let mut surfaces: Vec<Surface> = spec.materials.values().map(Surface::new).collect();
        let mut surface_of = |plane: &Plane| {
            let material = number(&plane.material);
            let Some(stiffness) = plane.contact_stiffness_n_per_m else {
                return material;
            };
            surfaces.push(surfaces[material].of_stiffness(stiffness));
            surfaces.len() - 1
        };
        let planes = spec.planes.iter().map(|plane| PlaneModel {
            name: plane.name.clone(),
            surface: surface_of(plane),
            face: Face {
                axis: plane.axis.index(),
                facing: f64::from(plane.facing),
                position: plane.position_m,
                motion: WallMotion::default(),
            },
        });
        let rough = |material: &Material| {
            material.friction_angle() > 0.0
                || material.is_cohesive()
                || material.rolling().is_felt()
        };
        let planes = planes.collect();
        let first_box = first_box(spec, specimen);
        Self {
            surfaces: surfaces.clone(),
            first_surfaces: surfaces,
            is_rough: spec.materials.values().any(rough),
            is_viscous: spec.is_viscous().contains(&true) || spec.resists_rolling(),
            keeps_friction: spec.laws.contact_friction == ContactFriction::Kept,
            cohesion_factor: spec.cohesion_factor(0),
            bonds_rest_as_made: spec.laws.bond_rest_length == BondRestLength::Initial,
            gravity: Vector::from(spec.gravity_m_per_s2),
            damping: spec.local_damping(),
            rotation: match spec.laws.convention {
                Convention::Loadframe => Rotation::Splitting,
                Convention::Yade => Rotation::Fincham,
            },
            planes,
            facets: Facets::new(spec),
            masses: Vec::new(),
            is_movable: Vec::new(),
            touching: spec.touching(&specimen.bodies),
            sphere_inertias: Vec::new(),
            has_driven_bodies: specimen.bodies.iter().any(is_driven)
                || !spec.driven_bodies().is_empty(),
            driven: Vec::new(),
            middle: middle(first_box),
            first_box,
            orientations: Vec::new(),
            spins: Vec::new(),
            grains: Vec::new(),
        }
    }

    /// Makes every modulus `factor` times that of the spec.
    pub(crate) fn stiffen(&mut self, factor: f64) {
        let surfaces = self.first_surfaces.iter();
        self.surfaces = surfaces.map(|surface| surface.stiffened(factor)).collect();
    }

    /// Whether a contact may move what is at its end; walls have numbers beyond those of bodies.
    pub(crate) fn can_move(&self, body: u32) -> bool {
        self.is_movable.get(body as usize) == Some(&true)
    }

    /// Of a body at a dashpot [1/kg]: 0 for one that cannot move, and where there are none.
    pub(crate) fn inverse_mass(&self, body: usize) -> f64 {
        if self.is_viscous && self.is_movable[body] {
            1.0 / self.masses[body]
        } else {
            0.0
        }
    }
}

/// The model of a scene, and the particles and clumps of all its bodies in the order of their
/// numbers.
///
/// # Errors
/// The interrupt that ended it early: clumps of many members take their time.
pub(crate) fn build(
    spec: &GranularScene,
    specimen: &Specimen<'_>,
    interrupt: &dyn InterruptSource,
) -> Result<(Model, Particles, Vec<Clump>), Interrupt> {
    let mut builder = Builder {
        model: Model::new(spec, specimen),
        particles: Particles::default(),
        clumps: Vec::new(),
    };
    let names: Vec<&String> = spec.materials.keys().collect();
    for (number, body) in specimen.bodies.iter().enumerate() {
        if (number + 1).is_multiple_of(BODIES_PER_LOOK) {
            interrupt.heed()?;
        }
        let material = names.binary_search(&&body.material).unwrap_or_default();
        let density = spec.materials[&body.material].density_kg_per_m3;
        let shape: Vec<Sphere> = body
            .spheres()
            .map(|(centre, radius)| Sphere::new(Vector::from(centre), radius))
            .collect();
        if body.clump.is_some() {
            builder.add_clump(body, &shape, material, density);
        } else if body.breakable.is_some() {
            builder.add_grain(body, &shape, material, density);
        } else {
            let velocity = Vector::from(body.velocity_m_per_s);
            builder.add_sphere(body, &shape[0], velocity, material, density);
        }
    }
    let Builder {
        mut model,
        mut particles,
        clumps,
    } = builder;
    model.driven = driven(spec, specimen, &particles, &clumps);
    if !model.grains.is_empty() {
        model.grains.resize(model.masses.len(), NO_GRAIN);
    }
    particles.numbers = (0..particles.centres.len() as u32).collect();
    Ok((model, particles, clumps))
}

/// Bodies that stages drive, in the order of their numbers.
fn driven(
    spec: &GranularScene,
    specimen: &Specimen<'_>,
    particles: &Particles,
    clumps: &[Clump],
) -> Vec<DrivenBody> {
    let mut owners = Vec::with_capacity(particles.len());
    for body in specimen.bodies.iter() {
        owners.extend(std::iter::repeat_n(body, body.numbers()));
    }
    let driven = spec.driven_bodies().into_iter();
    driven
        .filter_map(|number| {
            let body = owners.get(number as usize)?;
            let clump = clumps.iter().find(|clump| clump.body == number);
            let sphere = particles.owners.iter().position(|owner| *owner == number)?;
            let [x, y, z, ..] = fixed(body);
            Some(DrivenBody {
                body: number,
                start: clump.map_or(particles.centres[sphere].vector(), |clump| clump.centre),
                fixed: [x, y, z],
                velocity: body.velocity_m_per_s,
            })
        })
        .collect()
}

/// A scene in the making.
struct Builder {
    model: Model,
    particles: Particles,
    clumps: Vec<Clump>,
}

impl Builder {
    /// The next number.
    fn number(&self) -> u32 {
        self.model.masses.len() as u32
    }

    fn add_sphere(
        &mut self,
        body: &Body,
        sphere: &Sphere,
        velocity: Vector,
        material: usize,
        density: f64,
    ) {
        let mass = density * sphere.volume();
        let inertia = SPHERE_INERTIA * mass * sphere.radius.powi(2);
        let fixed = fixed_bits(body);
        let inverse = |value: f64, bits: u8| if bits == 0b111 { 0.0 } else { 1.0 / value };
        let inverses = [inverse(mass, fixed & 0b111), inverse(inertia, fixed >> 3)];
        self.add_particle(body, sphere, velocity, material, inverses, fixed);
        self.add_body(body, mass, inertia, UnitQuaternion::identity());
    }

    fn add_clump(&mut self, body: &Body, shape: &[Sphere], material: usize, density: f64) {
        let first = self.particles.centres.len() as u32;
        let clump = clump(self.number(), body, shape, density, first);
        for sphere in shape {
            // what a clump's members do follows from the clump
            let velocity = Vector::from(body.velocity_m_per_s);
            self.add_particle(body, sphere, velocity, material, [0.0; 2], 0);
        }
        self.add_body(body, clump.mass, 0.0, clump.orientation);
        self.clumps.push(clump);
    }

    /// The spheres of a breakable grain, which moves as one at first.
    fn add_grain(&mut self, body: &Body, shape: &[Sphere], material: usize, density: f64) {
        let first = self.number();
        self.model.grains.resize(first as usize, NO_GRAIN);
        self.model
            .grains
            .resize(first as usize + shape.len(), first);
        let volume: f64 = shape.iter().map(Sphere::volume).sum();
        let weighted = shape.iter().map(|sphere| sphere.centre * sphere.volume());
        let centre = weighted.sum::<Vector>() / volume;
        let spin = Vector::from(body.angular_velocity_rad_per_s);
        for sphere in shape {
            let velocity =
                Vector::from(body.velocity_m_per_s) + spin.cross(&(sphere.centre - centre));
            self.add_sphere(body, sphere, velocity, material, density);
        }
    }

    /// A particle of the body that has the next number; inverses of mass and inertia, and bits of
    /// what is fixed.
    fn add_particle(
        &mut self,
        body: &Body,
        sphere: &Sphere,
        velocity: Vector,
        material: usize,
        inverses: [f64; 2],
        fixed: u8,
    ) {
        let owner = self.number();
        let particles = &mut self.particles;
        particles
            .centres
            .push(Row::new(sphere.centre, sphere.radius));
        particles.velocities.push(Row::new(velocity, inverses[0]));
        particles.fixed.push(fixed);
        particles.owners.push(owner);
        particles.surfaces.push(material as u16);
        if self.model.is_rough {
            let spin = Vector::from(body.angular_velocity_rad_per_s);
            particles.spins.push(Row::new(spin, inverses[1]));
        }
    }

    fn add_body(
        &mut self,
        body: &Body,
        mass: f64,
        sphere_inertia: f64,
        orientation: UnitQuaternion<f64>,
    ) {
        let model = &mut self.model;
        model.masses.push(mass);
        model.sphere_inertias.push(sphere_inertia);
        model.orientations.push(orientation);
        let number = model.is_movable.len();
        model.is_movable.push(model.touching.is_free(number));
        let spin = Vector::from(body.angular_velocity_rad_per_s);
        model.spins.push(spin);
    }
}

fn clump(number: u32, body: &Body, shape: &[Sphere], density: f64, first: u32) -> Clump {
    let properties = mass_properties(shape);
    let axes = principal_axes(&properties.inertia);
    let orientation = UnitQuaternion::from_rotation_matrix(&axes.rotation);
    let centre = properties.centroid;
    let offsets = shape
        .iter()
        .map(|sphere| orientation.inverse_transform_vector(&(sphere.centre - centre)));
    let spin = Vector::from(body.angular_velocity_rad_per_s);
    let mut clump = Clump {
        body: number,
        first,
        offsets: offsets.collect(),
        mass: density * properties.volume,
        inertia: density * axes.moments,
        centre,
        velocity: Vector::from(body.velocity_m_per_s),
        orientation,
        angular_momentum: Vector::zeros(),
        spin,
        fixed: fixed(body),
    };
    clump.angular_momentum = clump.momentum_of(spin);
    clump
}

/// Whether a fixed degree of freedom has a velocity.
fn is_driven(body: &Body) -> bool {
    let velocities = body
        .velocity_m_per_s
        .iter()
        .chain(&body.angular_velocity_rad_per_s);
    let mut pairs = fixed(body).into_iter().zip(velocities);
    pairs.any(|(fixed, velocity)| fixed && *velocity != 0.0)
}

/// Of a box [m]; the origin where it is none.
fn middle((low, high): (Vector, Vector)) -> Vector {
    let middle = 0.5 * (low + high);
    if middle.iter().all(|part| part.is_finite()) {
        middle
    } else {
        Vector::zeros()
    }
}

fn first_box(spec: &GranularScene, specimen: &Specimen<'_>) -> (Vector, Vector) {
    let mut low = Vector::repeat(f64::INFINITY);
    let mut high = Vector::repeat(f64::NEG_INFINITY);
    for (centre, radius) in specimen.bodies[..specimen.present]
        .iter()
        .flat_map(Body::spheres)
    {
        low = low.inf(&Vector::from(centre).add_scalar(-radius));
        high = high.sup(&Vector::from(centre).add_scalar(radius));
    }
    for (_, generator) in spec.generators() {
        let [lower, upper] = generator.region.bounds();
        low = low.inf(&Vector::from(lower));
        high = high.sup(&Vector::from(upper));
    }
    for plane in &spec.planes {
        let axis = plane.axis.index();
        low[axis] = low[axis].min(plane.position_m);
        high[axis] = high[axis].max(plane.position_m);
    }
    let facets = spec.facets.iter();
    let triangles = facets.flat_map(|mesh| mesh.triangles().unwrap_or_default());
    for corner in triangles.flatten() {
        low = low.inf(&Vector::from(corner));
        high = high.sup(&Vector::from(corner));
    }
    (low, high)
}

fn fixed(body: &Body) -> [bool; 6] {
    let mut fixed = [false; 6];
    for degree in &body.fixed {
        fixed[degree.index()] = true;
    }
    fixed
}

/// Bit by degree of freedom.
fn fixed_bits(body: &Body) -> u8 {
    let degrees = body.fixed.iter();
    degrees.fold(0, |bits, degree| bits | 1 << degree.index())
}
