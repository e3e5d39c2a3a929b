//! Specs of tests of railway ballast: the oedometer, the box test, the rail bed.
//!
//! The three have one form, [`Ballast`]: grains, materials, an apparatus with its dimensions, how the
//! bed is prepared, what is done to it. Apparatus differ in what they bring: [`Oedometer`],
//! [`BoxTest`], [`Railbed`]. A spec becomes a [`GranularScene`](super::granular_scene::GranularScene) with stages
//! ([`Ballast::script`]), so that everything a scene can do is done by the same engine; the
//! [`Script`] says which stage is what, and where the readings of the test are.
//!
//! SI units, angles in radians; z is up. Dimensions, materials and loads that are left out are those
//! of the source, [Dubina2014] tables 4.1, 5.1 and 6.1, after the experiments of [Lim2004].
mod accuracy;
mod apparatus;
mod box_test;
mod checks;
mod estimate;
mod grains;
mod job_kind;
mod loading;
mod materials;
mod oedometer;
mod output;
mod preparation;
mod railbed;
mod results;
mod script;
mod shapes;
mod study;
mod walls;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::granular_scene::{BondRestLength, ContactFriction, ContactLaw};
use super::repeats::{is_one_repeat, one_repeat};

pub use accuracy::{Accuracy, Knobs};
pub use apparatus::{Apparatus, Tilting};
pub use box_test::{BoxTest, Sleeper};
pub use grains::Grains;
pub use loading::{Block, Loading};
pub use materials::{Mat, Materials};
pub use oedometer::{Oedometer, Section};
pub use output::Output;
pub use preparation::{Compaction, PouredAsSpheres, Preparation, Tamper, Tamping};
pub use railbed::Railbed;
pub use script::{BED, Course, Layer, Load, Phase, Script, Slice};
pub use walls::Walls;

/// The oedometer: a cylinder, pressed by a plate.
pub type BallastOedometer = Ballast<Oedometer>;
/// The box test: a box on rubber, pressed by a sleeper.
pub type BallastBox = Ballast<BoxTest>;
/// The rail bed: half a cross-section of a track, pressed by its sleeper.
pub type BallastRailbed = Ballast<Railbed>;

/// A test of railway ballast. z is up, SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    bound(deserialize = "A: Apparatus + DeserializeOwned")
)]
#[schemars(bound = "A: Apparatus + JsonSchema")]
pub struct Ballast<A> {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream: sizes, places and rotations of grains.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    /// Beds of this spec that are tested, with the seeds `seed`, `seed` + 1, ...: results become means with
    /// standard deviation, 95 % confidence interval and the error that so few beds leave. Curve and tables
    /// are those of the first.
    #[serde(default = "one_repeat", skip_serializing_if = "is_one_repeat")]
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub repeats: u32,
    #[serde(default)]
    pub grains: Grains,
    pub materials: Materials,
    #[serde(default)]
    pub apparatus: A,
    #[serde(default)]
    pub preparation: Preparation,
    #[serde(default = "A::loading")]
    pub test: Loading,
    #[serde(default)]
    pub laws: Laws,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub output: Output,
}

/// The laws of contact and damping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Laws {
    /// `linear`, or `logarithmic` for pressures at which grains would pass through each other.
    pub contact: ContactLaw,
    /// λ_D of Cundall's local damping.
    #[schemars(range(min = 0.0, max = 0.99), extend("x-unit" = "1"))]
    pub local_damping: f64,
    /// Whether contacts get the friction of the test when compaction ends, or keep that with which
    /// they began, as contacts of Yade do.
    #[serde(skip_serializing_if = "ContactFriction::is_renewed")]
    pub contact_friction: ContactFriction,
    /// Of the bonds of breakable grains.
    #[serde(skip_serializing_if = "BondRestLength::is_initial")]
    pub bond_rest_length: BondRestLength,
    /// What cohesions are multiplied with until the last grains have been poured, as the source does so
    /// that bonds which rest where spheres just touch are not torn by the overlaps they are made with.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0, max = 1e9), extend("x-unit" = "1"))]
    pub raised_cohesion: Option<f64>,
}

impl Default for Laws {
    fn default() -> Self {
        Self {
            contact: ContactLaw::Linear,
            local_damping: 0.3,
            contact_friction: ContactFriction::Renewed,
            bond_rest_length: BondRestLength::Initial,
            raised_cohesion: None,
        }
    }
}

/// Columns of the curve.
fn curve_columns(tilts: bool, is_breakable: bool) -> Vec<&'static str> {
    let mut columns = vec![
        "time_s",
        "force_kn",
        "displacement_mm",
        "cycle",
        "unloading",
        "inertial_number",
        "unbalanced_force_ratio",
        "coordination_number",
        "bed_mean_stress_kpa",
        "step_over_critical",
        "displacement_in_cycle_mm",
        "rebound_mm",
        "bed_porosity",
        "bed_stress_xx_kpa",
        "bed_stress_yy_kpa",
        "bed_stress_zz_kpa",
        "bed_stress_xy_kpa",
        "bed_stress_xz_kpa",
        "bed_stress_yz_kpa",
        "lateral_stress_ratio",
        "displacement_from_set_down_mm",
        "base_force_kn",
        "side_vertical_force_kn",
        "side_normal_force_kn",
    ];
    if tilts {
        columns.extend(["tilt_rad", "turn_about_x_rad", "turn_about_y_rad"]);
    }
    if is_breakable {
        columns.push("broken_bonds");
    }
    columns
}

fn one() -> u64 {
    1
}
