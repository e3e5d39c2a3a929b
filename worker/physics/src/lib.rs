//! The mechanics of loadframe.
//!
//! A typed spec, a [`Recorder`] and perhaps a checkpoint go in; curve points and files go to the
//! recorder and a [`Report`] comes out. Nothing here knows a clock, a path, the network, the
//! environment or a global: the same spec and seed give the same bytes on any number of threads.

mod calibrate;
mod calibration;
mod checkpoint;
pub mod csv;
mod curve;
mod error;
mod granular;
mod network;
mod parallel;
mod plan;
mod recorder;
mod rng;
mod statistics;
mod vtk;
mod wide;

use std::fmt;

use loadframe_api::{JobSpec, Report};

pub use calibration::calibration_spec;
pub use checkpoint::CheckpointError;
pub use error::SimulationError;
pub use recorder::{Interrupt, InterruptSource, Recorder, Uninterrupted, Unrecorded};
pub use statistics::{Sample, Welch};

/// How a simulation ended.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one per run")]
pub enum Ending {
    /// It ran to its own end; all files are with the recorder.
    Finished(Report),
    /// It was asked to give up.
    Cancelled,
    /// It was asked to stop, and its checkpoint is with the recorder.
    Suspended,
}

/// What a run is given beside its spec.
#[derive(Clone, Copy)]
pub struct RunContext<'a> {
    /// Threads to use; the result does not depend on it.
    pub threads: usize,
    pub interrupt: &'a dyn InterruptSource,
    /// Bytes an earlier run of the same spec gave to [`Recorder::checkpoint`].
    pub checkpoint: Option<&'a [u8]>,
}

impl fmt::Debug for RunContext<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let checkpoint_bytes = self.checkpoint.map(<[u8]>::len);
        formatter
            .debug_struct("RunContext")
            .field("threads", &self.threads)
            .field("checkpoint_bytes", &checkpoint_bytes)
            .finish_non_exhaustive()
    }
}

/// Runs the simulation of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn simulate(
    spec: &JobSpec,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    match spec {
        JobSpec::NonwovenTensile(spec) => network::nonwoven::plan::run(spec, context, recorder),
        JobSpec::GranularScene(spec) => granular::run(spec, context, recorder),
        JobSpec::BallastOedometer(spec) => granular::ballast::run(spec, context, recorder),
        JobSpec::BallastBox(spec) => granular::ballast::run(spec, context, recorder),
        JobSpec::BallastRailbed(spec) => granular::ballast::run(spec, context, recorder),
        JobSpec::Calibrate(spec) => calibrate::run(spec, context, recorder),
    }
}
