//! Spec of a granular scene: bodies in contact, and what is done to them, in any order.
//!
//! The discrete element method of Cundall and Strack: spheres and rigid clumps of spheres between
//! planes and surfaces of triangles, with friction, in explicit time integration. Everything is in SI
//! units, angles in radians. A body is named by its place in `bodies`, counted from 0; in tables,
//! walls are numbered after the bodies, `planes` first, then `facets`.
//!
//! The parts, each in its own file: [`Material`], what collides ([`Body`], [`Plane`],
//! [`FacetMesh`]), how
//! ([`Laws`], [`TimeStep`], [`Accuracy`]), what is done ([`Stage`]) and what is written ([`Record`]).
//! A further shape, law or stage is one more optional field or one more variant; none of the
//! names here changes for it. What the engine cannot do is not in these types, so that nothing a
//! user writes is silently left out.
mod bodies;
mod check_walls;
mod checks;
mod drive;
mod estimate;
mod facets;
pub mod hertz;
mod laws;
mod overlaps;
mod record;
mod region;
mod relax;
mod stability;
mod stages;
mod study;
mod vibrate;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Calibration, Estimate, Violation, study::Knob};

pub use bodies::{Axis, Body, Clump, DegreeOfFreedom, Member, Plane, Sphere};
pub use checks::LARGEST_WAY;
pub use drive::{BodyDrive, BodyForce, BodyVelocity, Drive, Sine, Turn, WallDrive, WallForce};
pub use facets::{FacetError, FacetMesh};
pub use laws::{
    Accuracy, AutomaticTimeStep, BondRestLength, ContactLaw, Convention, Knobs, Laws, Material,
    Preset, TimeStep,
};
pub use record::Record;
pub use region::Region;
pub use relax::Relax;
pub use stability::{CriticalStep, series_stiffness, step_with_dashpot};
pub use stages::{LoadPlane, MovePlane, Run, Settle, Stage};
pub use vibrate::Vibrate;

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
    pub materials: BTreeMap<String, Material>,
    #[serde(default)]
    #[schemars(length(max = 10_000_000))]
    pub bodies: Vec<Body>,
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
    #[serde(default)]
    pub accuracy: Accuracy,
    /// What is done, in this order.
    #[schemars(length(min = 1, max = 10_000))]
    pub stages: Vec<Stage>,
    #[serde(default)]
    pub record: Record,
}

impl GranularScene {
    /// Spheres of all bodies, members of clumps counted each.
    pub fn particles(&self) -> u64 {
        self.bodies.iter().map(Body::particles).sum()
    }
}

impl crate::kinds::Spec for GranularScene {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.accuracy.knobs());
        self.laws.local_damping = Some(self.local_damping());
        if self.laws.contact == ContactLaw::HertzMindlin {
            for material in self.materials.values_mut() {
                material.poisson_ratio = Some(material.poisson_ratio());
            }
        }
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn knobs(&self) -> Vec<Knob> {
        study::knobs(self)
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        study::turn(self, knob, value)
    }

    fn single(&mut self, seed: u64) {
        study::single(self, seed);
    }

    fn compares(result: &str) -> bool {
        study::compares(result)
    }
}

fn one() -> u64 {
    1
}

/// Standard gravity to the two digits that the examples of the field use.
fn earth() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}
