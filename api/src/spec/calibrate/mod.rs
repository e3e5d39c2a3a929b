//! Spec of a calibration: parameters of another job are found from what was measured.
//!
//! The free parameters θ of the inner job minimise ½ Σ rᵢ(θ)², where a residual rᵢ is the difference
//! between simulation and measurement, in units of the measured value or of its deviation. The
//! simulated value is the mean over realisations: tests of specimens drawn with the same seeds at
//! every θ, so that their scatter does not hide what a parameter does.
//!
//! [`InnerJob`] holds the other job, [`Template`] puts parameters into it, [`Measured`] says what it
//! is held against.
mod checks;
mod inner;
mod job_kind;
mod measured;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use inner::{InnerJob, SpecText, Template};
pub use measured::{CurveReading, Measured, MeasuredCurve, MeasuredResult, TableColumn};

/// Parameters of a job, fitted to measured results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Calibrate {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of the first realisation; the others count on from it, to at most 2⁵³ − 1. They take the
    /// place of the inner job's own seed.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    /// The job whose parameters are sought.
    pub job: InnerJob,
    /// The parameters that are free; all others stay as the job has them.
    #[schemars(length(min = 1, max = 12))]
    pub free: Vec<FreeParameter>,
    pub measured: Measured,
    /// Specimens tested at every trial, whose mean is held against what was measured. More scatter
    /// less: the intervals shrink with the square root.
    #[serde(default = "four")]
    #[schemars(range(min = 1, max = 1000))]
    pub realisations: u32,
    /// Trials at most. Each is a set of parameters, tested on all realisations.
    #[serde(default = "two_hundred")]
    #[schemars(range(min = 1, max = 100_000))]
    pub max_trials: u32,
    /// The search ends when the root mean square of the residuals is at most this.
    #[serde(default = "tolerance")]
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub tolerance: f64,
    /// Change of a parameter from which derivatives are taken, as part of its value (of its range on
    /// a linear scale). Bonds that break sooner or later make results jump: much smaller changes
    /// show the jumps instead of the slope.
    #[serde(default = "difference_step")]
    #[schemars(range(min = 1e-6, max = 0.2), extend("x-unit" = "1"))]
    pub difference_step: f64,
}

/// A parameter that is sought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FreeParameter {
    /// JSON pointer (RFC 6901) to a number in the job's `spec`: `/bond/mean_strength_n`.
    #[schemars(length(min = 1, max = 200))]
    pub parameter: String,
    /// Smallest value allowed, in the unit of the parameter.
    pub min: f64,
    /// Largest value allowed, in the unit of the parameter.
    pub max: f64,
    /// Value the search starts from; left out, the one in the job.
    pub start: Option<f64>,
    #[serde(default)]
    pub scale: Scale,
}

/// How a parameter is stepped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// By factors: for what is positive, such as moduli and strengths. `min` must be above 0.
    #[default]
    Log,
    /// By differences.
    Linear,
}

impl Calibrate {
    /// Fewest trials that leave room for a search: the start, a step with its derivatives, and the
    /// derivatives to both sides that the intervals are told from.
    pub fn fewest_trials(&self) -> u32 {
        2 + 3 * u32::try_from(self.free.len()).unwrap_or(u32::MAX / 4)
    }
}

fn one() -> u64 {
    1
}

fn four() -> u32 {
    4
}

fn two_hundred() -> u32 {
    200
}

/// A tenth of what specimens and testing machines agree to.
fn tolerance() -> f64 {
    0.002
}

fn difference_step() -> f64 {
    0.02
}
