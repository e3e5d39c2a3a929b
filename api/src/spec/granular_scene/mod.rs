//! Spec of a granular scene: bodies in contact, and what is done to them, in any order.
//!
//! The discrete element method of Cundall and Strack: spheres and rigid clumps of spheres between
//! planes and surfaces of triangles, with friction, in explicit time integration. Everything is in SI
//! units, angles in radians. A body is named by its number, counted from 0: those of `bodies` first,
//! then those of `import`, then those of `generate`, then those that stages `insert`; each sphere of
//! a breakable body has its own number. In tables, walls are numbered after the bodies, `planes`
//! first, then `facets`.
//!
//! The parts, each in its own file: [`Material`], what collides ([`Body`], [`Plane`],
//! [`FacetMesh`]), where bodies come from besides ([`Import`], [`Generate`] and the shapes that
//! [`Filled`] fills), how it collides
//! ([`Laws`], [`TimeStep`], [`Accuracy`]), what is done ([`Stage`]) and what is written ([`Record`]).
//! A further shape, law or stage is one more optional field or one more variant; none of the
//! names here changes for it. What the engine cannot do is not in these types, so that nothing a
//! user writes is silently left out.
mod accuracy;
mod bodies;
mod check_walls;
mod checks;
mod curve;
mod drive;
mod estimate;
mod facets;
mod generate;
mod grains;
pub mod hertz;
mod import;
mod insert;
mod job_kind;
mod laws;
mod overlaps;
mod packing;
mod parallel_bond;
mod part_checks;
mod place;
mod rate;
mod record;
mod region;
mod relax;
mod replace;
mod replacements;
pub(crate) mod results;
mod rolling;
mod speeds;
mod sphere_tree;
mod stability;
mod staged;
mod stages;
mod stiffen;
mod study;
mod supply_checks;
mod touching;
mod vibrate;
mod voids;
mod whole;

use std::{borrow::Cow, collections::BTreeMap};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use accuracy::{Accuracy, Knobs};
pub use bodies::{Axis, Body, Clump, DegreeOfFreedom, Member, Plane, Sphere};
pub use drive::{
    BodyDrive, BodyForce, BodyVelocity, Drive, Servo, Sine, Turn, Until, WallDrive, WallForce,
};
pub use facets::{FacetError, FacetMesh};
pub use generate::{Arrangement, Generate, Grain, SieveFraction, Sizes, Volume};
pub(crate) use grains::MOST_MEMBERS;
pub use grains::{Filled, Lattice, Shape};
pub use import::{Import, ImportError, ImportFormat};
pub use insert::{Cut, Insert};
pub use laws::{
    AutomaticTimeStep, BondRestLength, ContactFriction, ContactLaw, Convention, Laws, Material,
    RaisedCohesion, TimeStep,
};
pub use parallel_bond::ParallelBond;
pub use place::Place;
pub use record::Record;
pub use region::Region;
pub use relax::Relax;
pub use replace::{Equal, Replace};
pub use rolling::RollingResistance;
pub use speeds::LARGEST_WAY;
pub use stability::{CriticalStep, series_stiffness, step_with_dashpot};
pub use stages::{LoadPlane, MovePlane, Run, Settle, Stage};
pub use stiffen::Stiffen;
pub(crate) use supply_checks::check_grain;
pub use touching::Touching;
pub use vibrate::Vibrate;
pub use voids::VoidMap;
pub(in crate::spec) use whole::Whole;

/// A scene of bodies in contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GranularScene {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream of the scene.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    #[serde(default = "earth")]
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "m/s2"))]
    pub gravity_m_per_s2: [f64; 3],
    /// Materials by name.
    #[schemars(extend("maxProperties" = 1000))]
    pub materials: BTreeMap<String, Material>,
    #[serde(default)]
    #[schemars(length(max = 10_000_000))]
    pub bodies: Vec<Body>,
    /// Files of other programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub import: Vec<Import>,
    /// Bodies to be made.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub generate: Vec<Generate>,
    #[serde(default)]
    #[schemars(length(max = 1000))]
    pub planes: Vec<Plane>,
    /// Walls of triangles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub facets: Vec<FacetMesh>,
    #[serde(default)]
    pub laws: Laws,
    /// A number of seconds, or "auto": the part of the stable step that `accuracy` asks for.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s"))]
    pub time_step_s: TimeStep,
    /// Lets a given time step be larger than the stable one.
    #[serde(default)]
    pub allow_unstable: bool,
    /// Ends the run with an error when a body's centre gets behind a plane: the plane is too soft for
    /// what presses on it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stop_when_pushed_through: bool,
    /// Largest overlap over the smaller radius that bodies may begin with, unless the first stage is
    /// `relax`: more is a mistake, and would throw them apart. Soft grains that another program or another
    /// scene brought to rest lie deeper in each other and in soft walls.
    #[serde(default = "small_overlap", skip_serializing_if = "is_small_overlap")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub largest_overlap_at_start: f64,
    #[serde(default)]
    pub accuracy: Accuracy,
    /// What is done, in this order.
    #[schemars(length(min = 1, max = 10_000))]
    pub stages: Vec<Stage>,
    #[serde(default)]
    pub record: Record,
}

impl GranularScene {
    /// Nothing without gravity, for a test that writes its scene: forces by `contact` and λ_D, steps of
    /// this fraction of the critical one.
    pub(crate) fn of_test(
        seed: u64,
        contact: ContactLaw,
        local_damping: f64,
        critical_step_fraction: f64,
    ) -> Self {
        Self {
            version: 1,
            seed,
            gravity_m_per_s2: [0.0; 3],
            materials: BTreeMap::new(),
            bodies: Vec::new(),
            import: Vec::new(),
            generate: Vec::new(),
            planes: Vec::new(),
            facets: Vec::new(),
            laws: Laws {
                contact,
                local_damping: Some(local_damping),
                convention: Convention::Loadframe,
                bond_rest_length: BondRestLength::Initial,
                contact_friction: ContactFriction::Renewed,
                raised_cohesion: None,
            },
            time_step_s: TimeStep::default(),
            allow_unstable: false,
            stop_when_pushed_through: true,
            largest_overlap_at_start: small_overlap(),
            accuracy: Accuracy::Knobs(Knobs {
                critical_step_fraction,
            }),
            stages: Vec::new(),
            record: Record::default(),
        }
    }

    /// Spheres of all bodies, members of clumps counted each; those to be made as far as they can be
    /// foreseen. Those that are replaced count beside what replaces them.
    pub fn particles(&self) -> u64 {
        let given = self.given_bodies();
        let given = given.iter().map(Body::particles);
        let made = self.generators().map(|(_, generator)| {
            let density = self.density_of(&generator.material);
            generator.expected_particles(density)
        });
        let replaced = self.replacements().map(|(stage, replace)| {
            let spheres = self.expected_replaced(stage, replace) as u64;
            spheres.saturating_mul(replace.clump.expected_members())
        });
        given
            .chain(made)
            .chain(replaced)
            .fold(0, u64::saturating_add)
    }

    /// Bodies of `bodies` and of `import`; files that cannot be read have none.
    pub fn given_bodies(&self) -> Cow<'_, [Body]> {
        if self.import.is_empty() {
            return Cow::Borrowed(&self.bodies);
        }
        let read = |import: &Import| import.bodies(self.density_of(&import.material));
        let imported = self
            .import
            .iter()
            .flat_map(|import| read(import).unwrap_or_default());
        Cow::Owned(self.bodies.iter().cloned().chain(imported).collect())
    }

    /// Whether a body is or will be a rigid clump.
    pub fn has_clumps(&self) -> bool {
        let is_clump = |generator: &Generate| matches!(generator.grain, Grain::Clump(_));
        self.given_bodies().iter().any(|body| body.clump.is_some())
            || self.generators().any(|(_, generator)| is_clump(generator))
            || self.replacements().next().is_some()
    }

    /// Everything that makes bodies, with its JSON pointer: those of the start, then stages.
    pub fn generators(&self) -> impl Iterator<Item = (String, &Generate)> {
        let first = self.generate.iter().enumerate();
        let first = first.map(|(index, generator)| (format!("/generate/{index}"), generator));
        let stages = self.stages.iter().enumerate();
        first.chain(stages.filter_map(|(index, stage)| match stage {
            Stage::Insert(insert) => {
                Some((format!("/stages/{index}/insert/bodies"), &insert.bodies))
            }
            _ => None,
        }))
    }

    /// The bodies that are given, and samples of those that will be made.
    fn samples(&self) -> Cow<'_, [Body]> {
        let given = self.given_bodies();
        let mut made = self
            .generators()
            .flat_map(|(_, generator)| generator.extremes())
            .peekable();
        if made.peek().is_none() {
            return given;
        }
        Cow::Owned(given.iter().cloned().chain(made).collect())
    }

    /// [kg/m³]; not a number for a material that does not exist.
    fn density_of(&self, material: &str) -> f64 {
        let material = self.materials.get(material);
        material.map_or(f64::NAN, |material| material.density_kg_per_m3)
    }
}

fn one() -> u64 {
    1
}

fn small_overlap() -> f64 {
    0.05
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_small_overlap(ratio: &f64) -> bool {
    ratio.to_bits() == small_overlap().to_bits()
}

/// Standard gravity to the two digits that the examples of the field use.
fn earth() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}
