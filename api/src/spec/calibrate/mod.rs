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
mod measured;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Calibration, Estimate, Violation, study::Knob};

pub use inner::{InnerJob, SpecText, Template};
pub use measured::{Measured, MeasuredCurve, MeasuredResult};

/// Megabytes a trial leaves in memory and files, besides its results.
const TRIAL_MB: f64 = 1e-3;
/// Megabytes of a number that is kept.
const NUMBER_MB: f64 = 8e-6;
/// Realisations tried in a study; the last is the reference.
const REALISATIONS: [&str; 5] = ["1", "2", "4", "8", "16"];

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

impl crate::kinds::Spec for Calibrate {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        if let Ok(template) = Template::new(&self.job) {
            self.job.spec = template.text();
            for free in &mut self.free {
                free.start = free.start.or_else(|| template.number(&free.parameter));
            }
        }
        self.measured.normalise();
    }

    /// An upper bound: all trials, of which most searches need a part.
    fn estimate(&self, calibration: &Calibration) -> Estimate {
        let inner = self.job.read().ok();
        let inner = inner.map(|job| job.realisation(self.seed).estimate(calibration));
        let trials = f64::from(self.max_trials);
        let tests = trials * f64::from(self.realisations);
        let kept = tests * self.measured.count() as f64 * NUMBER_MB + trials * TRIAL_MB;
        Estimate {
            wall_s: tests * inner.map_or(0.0, |inner| inner.wall_s),
            memory_mb: inner.map_or(0.0, |inner| inner.memory_mb) + kept,
            disk_mb: 1.0 + kept,
            calibrated: false,
        }
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn knobs(&self) -> Vec<Knob> {
        let (most, grid) = REALISATIONS.split_last().unwrap_or((&"", &[]));
        vec![Knob {
            name: "realisations",
            description: "specimens tested at every trial, a whole number from 1 to 1000",
            present: self.realisations.to_string(),
            grid: grid.iter().map(|count| (*count).to_owned()).collect(),
            reference: vec![("realisations", (*most).to_owned())],
            keeps_specimen: true,
        }]
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        if knob != "realisations" {
            return None;
        }
        self.realisations = value.parse().ok()?;
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
    }

    fn compares(result: &str) -> bool {
        // counts of work say nothing of what was found
        !["trials", "tests"].contains(&result)
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
