//! What a scene is made of, body by body: those the spec gives, and those it asks to be made.
//!
//! Everything random comes from the named streams of the seed, one for each generator, so that what
//! one generator draws does not depend on the others. Bodies that a stage puts in are drawn here as
//! well, so that their numbers, sizes and masses are known before the run; only their places wait.
use std::{borrow::Cow, collections::BTreeMap, f64::consts::PI, ops::Range};

use loadframe_api::{
    filling::Arrangement as LatticeArrangement,
    spec::granular_scene::{
        Arrangement, Body, Clump, Generate, Grain, GranularScene, Member, Sphere as SphereShape,
        Stage,
    },
};
use loadframe_harness::{
    Halt, Interrupt, InterruptSource, SimulationError,
    rng::{Purpose, Streams},
};
use nalgebra::UnitQuaternion;
use rand::seq::SliceRandom as _;

use super::replacing::{self, about_centre};
use crate::{
    generate::{Amount, Region, Sizes, bounding_radius, insert, place_regularly, random_rotation},
    geometry::sphere::Sphere,
    numbers::Vector,
    walls::facets::{Facets, Pose, search::Search},
};

/// Every body of a scene, members one by one.
#[derive(Clone, Debug)]
pub(crate) struct Specimen<'a> {
    /// First those that are there at the start.
    pub(crate) bodies: Cow<'a, [Body]>,
    pub(crate) present: usize,
    /// Those that wait for a stage to put them in, about the origin, by number of the stage.
    pub(crate) waiting: BTreeMap<usize, Range<usize>>,
    /// Numbers of the spheres whose places those of a stage take, in their order, by number of the stage.
    pub(crate) replaced: BTreeMap<usize, Vec<u32>>,
}

/// Streams of generators in stages begin here, so that a further generator at the start changes none.
const FIRST_STAGE_STREAM: usize = 1 << 32;
/// Places of a lattice between two looks for interrupts: each is held against all bodies before.
const PLACES_PER_LOOK: usize = 512;
/// Bodies that are filled with spheres between two looks.
const FILLED_PER_LOOK: usize = 64;

impl<'a> Specimen<'a> {
    /// # Errors
    /// An interrupt; [`SimulationError::Unbuildable`] with what does not fit, and what to change.
    pub(crate) fn new(
        spec: &'a GranularScene,
        interrupt: &dyn InterruptSource,
    ) -> Result<Self, Halt> {
        let mut bodies = spec.given_bodies();
        if bodies.iter().any(Body::is_filled) {
            for (index, body) in bodies.to_mut().iter_mut().enumerate() {
                if (index + 1).is_multiple_of(FILLED_PER_LOOK) {
                    interrupt.heed()?;
                }
                for shape in [&mut body.clump, &mut body.breakable].into_iter().flatten() {
                    *shape = shape
                        .resolved()
                        .map_err(|error| wrong(&format!("/bodies/{index}"), error))?;
                }
            }
        }
        let mut walls = Walls::new(spec);
        for (index, generator) in spec.generate.iter().enumerate() {
            let pointer = format!("/generate/{index}");
            let maker =
                Maker::new(spec, generator, index).map_err(|error| wrong(&pointer, error))?;
            let made = maker.placed(&bodies, &mut walls, interrupt)?;
            let made = made.map_err(|error| wrong(&pointer, error))?;
            bodies.to_mut().extend(made);
        }
        let present = bodies.len();
        let is_made = !spec.generate.is_empty() || spec.bodies.iter().any(Body::is_filled);
        let mut waiting = BTreeMap::new();
        let mut replaced = BTreeMap::new();
        for (number, stage) in spec.stages.iter().enumerate() {
            let stream = FIRST_STAGE_STREAM + number;
            let coming = match stage {
                Stage::Insert(insert) => {
                    let maker = Maker::new(spec, &insert.bodies, stream).map_err(|error| {
                        wrong(&format!("/stages/{number}/insert/bodies"), error)
                    })?;
                    maker.waiting()
                }
                Stage::Replace(replace) => {
                    interrupt.heed()?;
                    let mut before: Vec<u32> = replaced.values().flatten().copied().collect();
                    before.sort_unstable();
                    let (spheres, clumps) = replacing::clumps(
                        spec, replace, stream, &bodies, &before,
                    )
                    .map_err(|error| wrong(&format!("/stages/{number}/replace/clump"), error))?;
                    replaced.insert(number, spheres);
                    clumps
                }
                _ => continue,
            };
            let first = bodies.len();
            bodies.to_mut().extend(coming);
            waiting.insert(number, first..bodies.len());
        }
        let specimen = Self {
            bodies,
            present,
            waiting,
            replaced,
        };
        if specimen.bodies.len() >= PLACES_PER_LOOK {
            interrupt.heed()?;
        }
        if is_made || !specimen.waiting.is_empty() {
            let violations = spec.check_start(&specimen.bodies[..present], specimen.numbers());
            if let Some(first) = violations.first() {
                let allowed = first.allowed.as_deref().unwrap_or("something else");
                let text = format!("{}: {}, allowed: {allowed}", first.pointer, first.detail);
                return Err(SimulationError::Unbuildable(text).into());
            }
        }
        Ok(specimen)
    }

    /// Numbers that the bodies take.
    pub(crate) fn numbers(&self) -> usize {
        self.bodies.iter().map(Body::numbers).sum()
    }
}

fn wrong(pointer: &str, error: impl std::fmt::Display) -> SimulationError {
    SimulationError::Unbuildable(format!("{pointer}: {error}"))
}

/// Facets as they stand at the start.
struct Walls {
    facets: Facets,
    poses: Vec<Pose>,
    search: Search,
}

impl Walls {
    fn new(spec: &GranularScene) -> Self {
        let facets = Facets::new(spec);
        Self {
            poses: vec![Pose::default(); facets.meshes.len()],
            facets,
            search: Search::default(),
        }
    }

    /// Whether nothing of them reaches into a sphere, which is no larger than those prepared for.
    fn are_clear(&self, sphere: &Sphere) -> bool {
        self.search.is_clear(&self.facets, &self.poses, sphere)
    }
}

/// A generator at work.
struct Maker<'a> {
    generator: &'a Generate,
    region: Region,
    seed: u64,
    /// Number of its streams.
    stream: usize,
    /// Members about their common centre of mass, turned and scaled for each grain.
    template: Option<Vec<Sphere>>,
    /// Radius of the sphere of each grain's volume [m].
    radii: Vec<f64>,
    /// Radius of that sphere for the template [m].
    own_radius: f64,
    /// Bounding radius of the template over `own_radius`; 1 for spheres.
    reach: f64,
}

impl<'a> Maker<'a> {
    fn new(spec: &GranularScene, generator: &'a Generate, stream: usize) -> Result<Self, String> {
        let template = generator.grain.template().map(Clump::resolved).transpose();
        let template = template.map_err(|error| error.to_string())?;
        let is_rigid = matches!(generator.grain, Grain::Clump(_));
        let template = template.map(|clump| about_centre(&clump, is_rigid));
        let (own_radius, reach) = match &template {
            Some((members, volume)) => {
                let radius = (volume / (4.0 / 3.0 * PI)).cbrt();
                (radius, bounding_radius(members, &Vector::zeros()) / radius)
            }
            None => (1.0, 1.0),
        };
        let region = Region::from(generator.region);
        let density = spec.materials[&generator.material].density_kg_per_m3;
        let by_mass = generator.mass_kg.map(|mass| mass / density);
        let by_porosity = generator
            .porosity
            .map(|porosity| (1.0 - porosity) * region.volume());
        let amount = match generator.count {
            Some(count) => Amount::Count(count as usize),
            None => Amount::Volume(by_mass.or(by_porosity).unwrap_or(0.0)),
        };
        let sizes = generator
            .sizes
            .as_ref()
            .map_or(Sizes::Single(own_radius), Sizes::from);
        let random = &mut Streams::new(spec.seed, Purpose::GrainSizes).of(stream);
        let mut radii = sizes.draw(amount, random);
        // fractions were drawn one after the other, and pour as a mixture
        radii.shuffle(random);
        Ok(Self {
            generator,
            region,
            seed: spec.seed,
            stream,
            template: template.map(|(members, _)| members),
            radii,
            own_radius,
            reach,
        })
    }

    /// Bodies in the region, clear of `others` and of facets.
    ///
    /// # Errors
    /// The interrupt that ended it early; within, why there is no room for them.
    fn placed(
        &self,
        others: &[Body],
        walls: &mut Walls,
        interrupt: &dyn InterruptSource,
    ) -> Result<Result<Vec<Body>, String>, Interrupt> {
        let random = &mut Streams::new(self.seed, Purpose::GrainPlaces).of(self.stream);
        let rooms: Vec<f64> = self
            .radii
            .iter()
            .map(|radius| self.reach * radius)
            .collect();
        let obstacles = obstacles(others, &self.region);
        let largest = rooms.iter().copied().fold(0.0, f64::max);
        walls.search.prepare(&walls.facets, largest);
        let lattice = match self.generator.arrangement {
            Arrangement::Random => {
                let centres = insert(
                    &self.region,
                    &rooms,
                    &obstacles,
                    |place| walls.are_clear(place),
                    random,
                    interrupt,
                )?;
                return Ok(match centres {
                    Ok(centres) => Ok(self.bodies(&centres)),
                    Err(error) => Err(error.to_string()),
                });
            }
            Arrangement::Grid => LatticeArrangement::SimpleCubic,
            Arrangement::Hexagonal => LatticeArrangement::Hexagonal,
        };
        let places = place_regularly(&self.region, lattice, 2.0 * largest, largest, 0.0, random);
        let mut centres = Vec::with_capacity(rooms.len().min(places.len()));
        for (number, centre) in places.into_iter().enumerate() {
            if (number + 1).is_multiple_of(PLACES_PER_LOOK) {
                interrupt.heed()?;
            }
            let is_free = obstacles
                .iter()
                .all(|obstacle| (obstacle.centre - centre).norm() >= obstacle.radius + largest);
            if is_free && walls.are_clear(&Sphere::new(centre, largest)) {
                centres.push(centre);
            }
        }
        if centres.len() < rooms.len() {
            return Ok(Err(format!(
                "the lattice of the largest grain, radius {largest:.6} m with all its members, has \
                 {} free places for {} grains: use a larger region or fewer or smaller grains",
                centres.len(),
                rooms.len()
            )));
        }
        centres.truncate(rooms.len());
        Ok(Ok(self.bodies(&centres)))
    }

    /// Bodies about the origin.
    fn waiting(&self) -> Vec<Body> {
        self.bodies(&vec![Vector::zeros(); self.radii.len()])
    }

    fn bodies(&self, centres: &[Vector]) -> Vec<Body> {
        let random = &mut Streams::new(self.seed, Purpose::GrainRotations).of(self.stream);
        let grains = self.radii.iter().zip(centres);
        let body = |(radius, centre): (&f64, &Vector)| {
            let mut body = Body {
                velocity_m_per_s: self.generator.velocity_m_per_s,
                ..Body::at((*centre).into(), &self.generator.material)
            };
            let Some(template) = &self.template else {
                body.sphere = Some(SphereShape { radius_m: *radius });
                return body;
            };
            let rotation = if self.generator.turned {
                random_rotation(random)
            } else {
                UnitQuaternion::identity()
            };
            let scale = radius / self.own_radius;
            let members = template.iter().map(|member| Member {
                offset_m: (rotation * member.centre * scale).into(),
                radius_m: member.radius * scale,
            });
            let clump = Clump {
                members: members.collect(),
                filled: None,
            };
            match self.generator.grain {
                Grain::Breakable(_) => body.breakable = Some(clump),
                _ => body.clump = Some(clump),
            }
            body
        };
        grains.map(body).collect()
    }
}

/// Spheres of bodies that reach into a region's box.
fn obstacles(bodies: &[Body], region: &Region) -> Vec<Sphere> {
    let [lower, upper] = region.bounds();
    let spheres = bodies.iter().flat_map(Body::spheres);
    let spheres = spheres.map(|(centre, radius)| Sphere::new(centre.into(), radius));
    let reaches = |sphere: &Sphere| {
        let outside = (lower - sphere.centre).sup(&(sphere.centre - upper));
        outside.max() < sphere.radius
    };
    spheres.filter(reaches).collect()
}
