//! Tests of ballast: a scene, read in the terms of its test.
//!
//! The spec's [`Script`] is a scene with stages; the engine runs it like any other. Between the
//! engine and the job's recorder sits a [`Tester`]: it reads force and way of the loading wall and
//! the state of the bed from the points of the scene's curve ([`heard`], each at its [`place`] in the cycles), and makes the test's own curve of
//! them. When the engine is done, [`cycles`] finds peaks, residuals and stiffnesses, [`blocks`] those of each load, [`oedometer`] void ratio and
//! modulus, [`moments`] what the journal
//! says of grains that broke, [`voids`] where the bed became loose, [`report`] the summary, [`errors`] how wrong it may be, [`tables`] the files. A resumed run hears the whole curve again,
//! so that nothing here needs to be kept in a checkpoint.
mod blocks;
mod cycles;
mod errors;
mod heard;
mod moments;
mod oedometer;
mod place;
mod report;
mod tables;
mod tester;
#[cfg(test)]
mod tests;
mod voids;

use loadframe_api::spec::ballast::{Apparatus, Ballast};
use loadframe_harness::{Ending, Halt, Recorder, RunContext, SimulationError, plan::first_of};
use serde::Serialize;

use crate::output::warnings::Fields;
use crate::repeats::{self, Repeated};
use crate::stages;
use tester::Tester;

pub use errors::Tabled;

/// Shown of the specimen: a bed is the result of its preparation, which is part of the simulation.
const SHOWN: &str = "What there is before the first grain falls: walls, and the grains of the first layer \
     where they are let go. Pouring and compacting the bed takes simulated time and comes with the job.";

/// Draws the scene of `spec` as it is before its first step; returns what is shown.
///
/// # Errors
/// When there is no such scene, or the recorder fails.
pub fn preview<A: Apparatus>(
    spec: &Ballast<A>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    stages::run::preview(&spec.script().scene, context, recorder)?;
    Ok(first_of(SHOWN, spec.repeats))
}

/// Runs the test of `spec`, of as many beds as it asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run<A: Tabled + Serialize + Sync>(
    spec: &Ballast<A>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    repeats::run(spec, context, recorder)
}

impl<A: Tabled + Serialize + Sync> Repeated for Ballast<A> {
    const SEVERAL: &'static str = "beds";
    // time, force and displacement
    const KEPT_COLUMNS: usize = 3;
    const TOLD: &'static str = "peak_displacement";

    fn repeats(&self) -> u32 {
        self.repeats
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn first_alone(&mut self) {
        self.repeats = 1;
    }

    fn run_one(
        &self,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        run_one(self, context, recorder)
    }
}

fn run_one<A: Tabled>(
    spec: &Ballast<A>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let script = spec.script();
    let mut tester = Tester::new(&script, recorder);
    let run = stages::run::run(&script.scene, Fields::Ballast, context, &mut tester);
    let (ending, journal) = run.inspect_err(|_| tester.keep())?;
    Ok(match ending {
        Ending::Finished(report) => {
            let mut report = tester.conclude(report, &journal)?;
            if let Some(words) = errors::add(&mut report, spec) {
                tester.log(&words);
            }
            Ending::Finished(report)
        }
        ending => ending,
    })
}
