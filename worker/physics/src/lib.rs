//! The mechanics of loadframe.
//!
//! A typed spec, a [`Recorder`] and perhaps a checkpoint go in; curve points and files go to the
//! recorder and a [`Report`] comes out. Nothing here knows a clock, a path, the network, the
//! environment or a global: the same spec and seed give the same bytes on any number of threads.

mod calibrate;
mod preview;

use loadframe_api::JobSpec;
use loadframe_composite::{bending, cell};
use loadframe_grains as grains;
use loadframe_network::nonwoven;
use loadframe_paper::tensile;

pub use loadframe_harness::{
    CheckpointError, Ending, Interrupt, InterruptSource, Recorder, RunContext, Sample,
    SimulationError, Uninterrupted, Unrecorded, Wanted, Welch, csv,
};
pub use nonwoven::calibration_spec;
pub use preview::preview;

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
        JobSpec::NonwovenTensile(spec) => nonwoven::run(spec, context, recorder),
        JobSpec::GranularScene(spec) => grains::run(spec, context, recorder),
        JobSpec::Triaxial(spec) => grains::soil::run(spec, context, recorder),
        JobSpec::DirectShear(spec) => grains::soil::run(spec, context, recorder),
        JobSpec::BallastOedometer(spec) => grains::ballast::run(spec, context, recorder),
        JobSpec::BallastBox(spec) => grains::ballast::run(spec, context, recorder),
        JobSpec::BallastRailbed(spec) => grains::ballast::run(spec, context, recorder),
        JobSpec::CompositeBending(spec) => bending::run(spec, context, recorder),
        JobSpec::CompositeCell(spec) => cell::run(spec, context, recorder),
        JobSpec::PaperTensile(spec) => tensile::run(spec, context, recorder),
        JobSpec::Calibrate(spec) => calibrate::run(spec, context, recorder),
    }
}
