//! How fast a machine is, and what a job will therefore take.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Measured speed of a machine, by a short run of the real solver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Calibration {
    /// Evaluations of one bond (energy, force or stiffness times vector) per second and core.
    pub bond_evaluations_per_s: f64,
}

impl Default for Calibration {
    /// Used until a worker has measured: a core of about 2020.
    fn default() -> Self {
        Self {
            bond_evaluations_per_s: 1.0e8,
        }
    }
}

/// What a job is expected to take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Wall time on one core [s]. Breaking makes this uncertain by about a factor of 2.
    pub wall_s: f64,
    /// Peak memory [MB].
    pub memory_mb: f64,
    /// Size of all result files [MB].
    pub disk_mb: f64,
    /// Whether a worker's measurement stands behind the time, or only a typical machine.
    pub calibrated: bool,
}
