//! Spec of a nonwoven tensile test: a fabric of bonds, pulled along y until it parts.
//!
//! The model is a three-dimensional network of straight bonds in equilibrium at every strain step
//! ([Jirsak1993], [Zilka2022]). Lengths are in mm, forces in N, strain is dimensionless; y is the
//! pulling direction, x the width, z the thickness. A test along x is one of the same fabric turned.
mod accuracy;
mod checks;
mod estimate;
mod fabric;
mod history;
mod job_kind;
mod results;
mod study;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use accuracy::{Accuracy, DescentGradient, Knobs, Solver};
pub use fabric::{Fabric, Jaw, Jaws, Lattice, Network, NetworkBond};
pub use history::{Block, Leg, Target};

/// Columns of the curve; the last two only where the width can be measured.
pub const CURVE_COLUMNS: [&str; 9] = [
    "nominal_strain",
    "force_n",
    "force_bottom_jaw_n",
    "broken_bonds",
    "residual_ratio",
    "rounds",
    "stored_energy_n_mm",
    "width_strain",
    "poisson_ratio",
];

/// Columns that stand after the force where the test has a history: the cycle, counted from 1, and
/// whether the jaw comes back (1) or pulls (0).
pub const HISTORY_COLUMNS: [&str; 2] = ["cycle", "unloading"];

/// A virtual tensile test of a nonwoven fabric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NonwovenTensile {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream of the test: irregularity, bond strength. Repeats count on from
    /// it, to at most 2⁵³ − 1.
    #[serde(default = "default_seed")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    pub fabric: Fabric,
    #[serde(default)]
    pub bond: Bond,
    #[serde(default)]
    pub test: Test,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub output: Output,
}

/// Bond law and strength. T = e u + f_r u² in tension, T = r_c u in compression, with bond strain
/// u = (l − l₀)/l₀ ([Zilka2022] eq. 1-2).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Bond {
    /// e, force per unit bond strain in tension. May be left out when every bond of an explicit
    /// network gives its own.
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "N"))]
    pub modulus_n: Option<f64>,
    /// f_r, coefficient of the squared bond strain in tension.
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub friction_modulus_n: f64,
    /// r_c, force per unit bond strain in compression; 0 makes bonds buckle freely.
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub compression_stiffness_n: f64,
    /// s_bave, scale of the strength that is drawn, see `strength_draw`. Of `log_normal` it is, despite
    /// its name, the median before factors above 2 are drawn again; the mean of what is drawn is
    /// exp(σ²/2) Φ(c − σ)/Φ(c) times it with c = ln 2/σ, 1.032 times at σ = 0.365, and comes back as
    /// `mean_bond_strength`. Of `normal` it is the mean. Needed unless nothing breaks or every bond of
    /// an explicit network gives its own.
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub mean_strength_n: Option<f64>,
    /// σ of the logarithm of strength, or of strength over its mean, by `strength_draw`.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub strength_sigma: f64,
    /// Distribution that strengths are drawn from.
    #[serde(skip_serializing_if = "StrengthDraw::is_log_normal")]
    pub strength_draw: StrengthDraw,
}

/// How the strength of a bond is drawn: the two readings of [Zilka2022] section 1.2.3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StrengthDraw {
    /// s_bave exp(σ N(0,1)), factors above 2 drawn again.
    #[default]
    LogNormal,
    /// s_bave (1 + σ N(0,1)), factors below 0 and above 2 drawn again.
    Normal,
}

impl StrengthDraw {
    fn is_log_normal(&self) -> bool {
        *self == Self::LogNormal
    }
}

/// What is done to the specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Test {
    /// Nominal strain added per step.
    #[schemars(range(min = 1e-8, max = 1.0), extend("x-unit" = "1"))]
    pub strain_step: f64,
    /// Nominal strain at which the test ends at the latest.
    #[schemars(range(min = 1e-8, max = 100.0), extend("x-unit" = "1"))]
    pub max_strain: f64,
    /// The test ends once bonds broke and the force is below this fraction of its maximum.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub stop_force_fraction: f64,
    pub breaking: Breaking,
    /// Jaw speed that turns jaw displacement into the time column of the testing-machine curve;
    /// it does not change the (quasi-static) result. 100 mm/min is the rate of ISO 9073-3.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm/min"))]
    pub speed_mm_per_min: f64,
    /// Tests of specimens drawn with the seeds `seed`, `seed` + 1, ...: results become means with
    /// standard deviation and 95 % confidence interval. Curve and tables are those of the first.
    #[schemars(range(min = 1, max = 1000))]
    pub repeats: u32,
    /// The axes along which the specimen is pulled, each time from the start: `["y", "x"]` tests
    /// the same nodes and bonds in both directions and relates the two. Curve and tables are those
    /// of the first; results of the second end in `_along_x` (or `_along_y`).
    #[schemars(length(min = 1, max = 2), extend("uniqueItems" = true))]
    pub directions: Vec<Direction>,
    /// Loading and unloading in blocks of cycles, one after the other; the test ends with the last of
    /// them, or when the specimen parts. Empty: the specimen is pulled to `max_strain`. Bonds that live
    /// unload the way they came; what a cycle takes is what breaks in it.
    #[schemars(length(max = 1000))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub history: Vec<Block>,
}

/// An axis along which a specimen is pulled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Along the columns of a lattice, by the jaws it is given with.
    #[default]
    Y,
    /// Along the rows of a lattice: its jaws are taken off, and the first and last node of each row
    /// are held instead.
    X,
}

/// Which bonds break in a round of breaking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Breaking {
    /// Every bond whose tension exceeds its strength.
    #[default]
    AllOverStrength,
    /// Only the bond with the largest tension over strength.
    WeakestFirst,
    /// Bonds never break.
    None,
}

/// What is written beside the curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// A snapshot (`.vtp`) and a force histogram every so many strain steps; 0 writes none. Whatever the
    /// interval, there are snapshots of the largest force (`peak.vtp`) and of the end.
    #[schemars(range(min = 0, max = 1_000_000_000))]
    pub snapshot_every_steps: u32,
    /// Bins of the bond force histograms, and of those of breaking events.
    #[schemars(range(min = 1, max = 10_000))]
    pub histogram_bins: u32,
    /// Nominal strains at which the distribution of bond forces is written, each at the nearest
    /// strain step; besides those of the snapshots.
    #[schemars(
        length(max = 1000),
        inner(range(min = 0.0, max = 100.0)),
        extend("x-unit" = "1")
    )]
    pub force_distribution_strains: Vec<f64>,
    /// Nominal strains of the first pull at which secant stiffness and lateral contraction are read, besides
    /// 0.1: 0.025 gives `modulus_at_2_5_percent`, `secant_stiffness_at_2_5_percent` and
    /// `poisson_ratio_at_2_5_percent`. A specimen that parts before has none, and a reason.
    #[schemars(
        length(max = 20),
        inner(range(min = 1e-6, max = 100.0)),
        extend("x-unit" = "1", "uniqueItems" = true)
    )]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reading_strains: Vec<f64>,
    /// Writes the force landscape of one node and the law of the bonds: `force_landscape.csv`,
    /// `force_landscape_lines.csv` and `bond_law.csv`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_landscape: Option<ForceLandscape>,
}

/// The magnitude of a node's resultant around its place, the other nodes at theirs ([Zilka2022] graph 2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForceLandscape {
    /// Taken after the first strain step that reaches this nominal strain.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1"))]
    pub strain: f64,
    /// Number of the node, as in snapshots; left out, the free node nearest to the middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<u32>,
    /// How far the node is moved to each side along x, y and z, in mean rest lengths of bonds.
    #[serde(default = "half_a_bond")]
    #[schemars(range(min = 1e-9, max = 10.0), extend("x-unit" = "1"))]
    pub half_width: f64,
    /// Values along each axis; the next odd number, so that one is at the place itself.
    #[serde(default = "forty_one")]
    #[schemars(range(min = 3, max = 401))]
    pub points: u32,
}

fn half_a_bond() -> f64 {
    0.5
}

fn forty_one() -> u32 {
    41
}

fn default_seed() -> u64 {
    1
}

impl Default for Test {
    fn default() -> Self {
        Self {
            strain_step: 0.01,
            max_strain: 3.0,
            stop_force_fraction: 0.1,
            breaking: Breaking::default(),
            speed_mm_per_min: 100.0,
            repeats: 1,
            directions: vec![Direction::Y],
            history: Vec::new(),
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self {
            snapshot_every_steps: 10,
            histogram_bins: 40,
            force_distribution_strains: Vec::new(),
            reading_strains: Vec::new(),
            force_landscape: None,
        }
    }
}

impl Direction {
    /// Name of the axis.
    pub fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::X => "x",
        }
    }
}

/// More strain steps than this are refused.
const MOST_STEPS: u64 = 10_000_000;

impl Test {
    /// Strain steps until `max_strain`; the last one is shorter where they do not come out even.
    pub fn steps(&self) -> u64 {
        // a ratio a hair above a whole number is that number: 0.3/0.1 must give 3, not 4
        let ratio = self.max_strain / self.strain_step;
        (ratio * (1.0 - 1e-12)).ceil().max(1.0) as u64
    }
}
