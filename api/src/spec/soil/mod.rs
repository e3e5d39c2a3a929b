//! Specs of tests of soil in the words of geotechnics: the triaxial test and the direct shear test.
//!
//! The two have one form, [`Soil`]: grains, what they are made of, how the specimen is prepared, and
//! the test. They differ in what they do, [`Triaxial`] and [`DirectShear`]. A spec becomes a
//! [`GranularScene`](super::granular_scene::GranularScene) with stages ([`Soil::script`]), so that everything a scene can do
//! is done by the same engine; the [`Script`] says where the readings of the test begin.
//!
//! SI units, angles in radians; z is up. There is no gravity: stresses are those of the walls.
mod accuracy;
mod direct_shear;
mod job_kind;
mod results;
mod script;
mod study;
mod triaxial;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::granular_scene::{ContactLaw, Grain, Material, Sizes};
use super::repeats::{is_one_repeat, one_repeat};

pub use accuracy::{Accuracy, Knobs};
pub use direct_shear::DirectShear;
pub use script::{Pace, SAMPLE, Script, Shearing};
pub use triaxial::Triaxial;

/// The triaxial test: a box of six smooth walls, pressed on all sides and then from above.
pub type SoilTriaxial = Soil<Triaxial>;
/// The direct shear test: a box in two halves that are moved past each other under a normal stress.
pub type SoilDirectShear = Soil<DirectShear>;

/// A test of soil. z is up, SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    bound(deserialize = "T: Shearing + DeserializeOwned")
)]
#[schemars(bound = "T: Shearing + JsonSchema")]
pub struct Soil<T> {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream: sizes, places and rotations of grains.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    /// Specimens of this spec that are tested, with the seeds `seed`, `seed` + 1, ...: results become means
    /// with standard deviation, 95 % confidence interval and the error that so few specimens leave. Curve
    /// and tables are those of the first.
    #[serde(default = "one_repeat", skip_serializing_if = "is_one_repeat")]
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub repeats: u32,
    pub grains: Grains,
    /// What grains are made of, and rough walls.
    pub soil: Material,
    #[serde(default)]
    pub preparation: Preparation,
    pub test: T,
    #[serde(default)]
    pub laws: Laws,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub output: Output,
}

/// Shape and sizes of grains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grains {
    /// A sphere, a rigid clump, or a breakable one of a soil with cohesion.
    #[serde(default)]
    pub shape: Grain,
    /// Sizes; a clump is scaled to the volume of a sphere of the size drawn. Spheres need them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sizes: Option<Sizes>,
}

/// How grains that are placed at random become a specimen under the stress at which it is tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Preparation {
    /// What tan φ is multiplied with while the walls move in: near 0 the specimen becomes dense, at 1
    /// loose. Afterwards it comes to rest with its whole friction.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub friction_factor: f64,
}

/// The laws of contact and damping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Laws {
    pub contact: ContactLaw,
    /// λ_D of Cundall's local damping.
    #[schemars(range(min = 0.0, max = 0.99), extend("x-unit" = "1"))]
    pub local_damping: f64,
}

/// What is written beside curve and tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Rows of the curve, about.
    #[schemars(range(min = 10, max = 100_000))]
    pub rows: u32,
    /// Snapshots for ParaView, about; 0 writes none.
    #[schemars(range(max = 100_000))]
    pub snapshots: u32,
}

impl Default for Preparation {
    fn default() -> Self {
        Self {
            friction_factor: 0.3,
        }
    }
}

impl Default for Laws {
    fn default() -> Self {
        Self {
            contact: ContactLaw::Linear,
            local_damping: 0.2,
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self {
            rows: 200,
            snapshots: 0,
        }
    }
}

fn one() -> u64 {
    1
}
