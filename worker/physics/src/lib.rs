//! The mechanics of loadframe.
//!
//! A typed spec, a [`Recorder`] and perhaps a checkpoint go in; curve points and files go to the
//! recorder and a [`Report`] comes out. Nothing here knows a clock, a path, the network, the
//! environment or a global: the same spec and seed give the same bytes on any number of threads.
//!
//! [`job_of`] is the one place where kinds meet their engines.
mod calibrate;

use loadframe_api::JobSpec;
use loadframe_composite::{bending, cell};
use loadframe_grains as grains;
use loadframe_harness::{Preview, Run};
use loadframe_network::nonwoven;
use loadframe_paper::tensile;

pub use grains::WATCHES;
pub use loadframe_harness::{
    CheckpointError, Decorator, Ending, Halt, Interrupt, InterruptSource, Recorder, RunContext,
    Sample, SimulationError, Uninterrupted, Unrecorded, Wanted, Welch, csv,
};
pub use nonwoven::calibration_spec;

/// Runs the simulation of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn simulate(
    spec: &JobSpec,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let interrupt = context.interrupt;
    let ending = job_of(spec).run(context, recorder);
    // what fails once nothing is wanted any more, such as a file that is given up, is no failure of the test
    match (ending, interrupt.interrupt()) {
        (Err(_), Some(Interrupt::Cancel)) => Ok(Ending::Cancelled),
        (ending, _) => ending,
    }
}

/// Gives the recorder pictures of the specimen of `spec` before its test, as its generator makes it and its
/// snapshots draw it; of several specimens, of the first. Returns what they show, in a sentence or two.
/// How much there is to draw tells [`JobSpec::extent`] beforehand.
///
/// # Errors
/// When there is no such specimen, or the recorder fails; or an interrupt.
pub fn preview(
    spec: &JobSpec,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    let interrupt = context.interrupt;
    let shows = job_of(spec).preview(context, recorder);
    // as above; and of what looks for none while it is made
    match (shows, interrupt.interrupt()) {
        (_, Some(interrupt)) => Err(interrupt.into()),
        (shows, None) => shows,
    }
}

/// The spec with what its kind is computed by: its engine's run and its engine's preview.
fn job_of(spec: &JobSpec) -> Box<dyn Job + '_> {
    match spec {
        JobSpec::NonwovenTensile(spec) => job(spec, nonwoven::run, nonwoven::preview),
        JobSpec::GranularScene(spec) => job(spec, grains::run, grains::preview),
        JobSpec::Triaxial(spec) => job(spec, grains::soil::run, grains::soil::preview),
        JobSpec::DirectShear(spec) => job(spec, grains::soil::run, grains::soil::preview),
        JobSpec::BallastOedometer(spec) => {
            job(spec, grains::ballast::run, grains::ballast::preview)
        }
        JobSpec::BallastBox(spec) => job(spec, grains::ballast::run, grains::ballast::preview),
        JobSpec::BallastRailbed(spec) => job(spec, grains::ballast::run, grains::ballast::preview),
        JobSpec::CompositeBending(spec) => job(spec, bending::run, bending::preview),
        JobSpec::CompositeCell(spec) => job(spec, cell::run, cell::preview),
        JobSpec::PaperTensile(spec) => job(spec, tensile::run, tensile::preview),
        // of jobs of any kind, which it is told how to run
        JobSpec::Calibrate(spec) => job(
            spec,
            |spec, context, recorder| calibrate::run(spec, simulate, context, recorder),
            |spec, context, recorder| calibrate::preview(spec, preview, context, recorder),
        ),
    }
}

/// What can be done with a spec whose kind is forgotten.
trait Job {
    fn run(
        &self,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError>;

    fn preview(&self, context: RunContext<'_>, recorder: &mut dyn Recorder)
    -> Result<String, Halt>;
}

struct Known<'a, S> {
    spec: &'a S,
    run: Run<S>,
    preview: Preview<S>,
}

#[expect(
    clippy::borrowed_box,
    reason = "that is how a spec of any kind holds it"
)]
fn job<'a, S>(spec: &'a Box<S>, run: Run<S>, preview: Preview<S>) -> Box<dyn Job + 'a> {
    Box::new(Known::<S> { spec, run, preview })
}

impl<S> Job for Known<'_, S> {
    fn run(
        &self,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        (self.run)(self.spec, context, recorder)
    }

    fn preview(
        &self,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<String, Halt> {
        (self.preview)(self.spec, context, recorder)
    }
}
