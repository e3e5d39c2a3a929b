//! Tensile test of a nonwoven.
//!
//! In the order in which a run calls them: [`specimen`] builds the network from the spec, from a
//! [`lattice`], perhaps [`turned`], or as given, with drawn [`strength`]; [`experiment`] strains it
//! step by step along a [`path`] from the guess of [`predictor`] and keeps all that counts in a [`state`]; [`snapshot`],
//! [`landscape`], [`distribution`], [`tables`], [`cycles`], [`spectrum`], [`readings`] and [`report`] turn that into files and results, and
//! [`errors`] say how wrong they may be.
//! [`width`] measures lateral contraction, [`progress`] how far the test is. This file holds the
//! loop, which alone talks to the recorder. [`mod@plan`] stands above: a job of repeats or of two
//! directions is several such tests side by side ([`loadframe_harness::plan`]), their results joined.
mod calibration;
mod cycles;
mod distribution;
mod errors;
mod experiment;
mod landscape;
mod lattice;
mod path;
mod plan;
mod predictor;
mod progress;
mod readings;
mod report;
mod snapshot;
mod specimen;
mod spectrum;
mod state;
mod strength;
mod tables;
#[cfg(test)]
mod tests;
mod turned;
mod width;

use loadframe_api::spec::nonwoven_tensile::NonwovenTensile;
use loadframe_harness::{
    Ending, Halt, Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::{self, Fingerprint},
    plan::first_of,
};
use loadframe_numerics::Team;
use serde::{Deserialize, Serialize};

use crate::equilibrium::work::Meter;
pub use calibration::calibration_spec;
pub use plan::run;

use experiment::{Advance, Experiment, StopReason};
use progress::Yardstick;
use specimen::Specimen;
use state::State;

/// A state and the spec it belongs to.
#[derive(Serialize, Deserialize)]
struct Checkpoint {
    spec: Fingerprint,
    state: State,
}

/// Draws the first specimen of `spec`, in its first direction, before it is strained; returns what is shown.
///
/// # Errors
/// When there is no such specimen, or the recorder fails.
pub fn preview(
    spec: &NonwovenTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    let specimen = Specimen::new(spec)?;
    context.interrupt.heed()?;
    snapshot::take_first(&specimen, recorder)?;
    let words = "The fabric between its jaws, not strained yet.";
    Ok(first_of(words, spec.test.repeats))
}

/// Runs a single test of `spec`, in its first direction, whatever repeats it asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
fn run_one(
    spec: &NonwovenTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let fingerprint = Fingerprint::of(spec)?;
    let specimen = Specimen::new(spec)?;
    let state = match context.checkpoint {
        Some(bytes) => {
            let checkpoint: Checkpoint = checkpoint::unpack(bytes)?;
            fingerprint.check(checkpoint.spec)?;
            checkpoint.state
        }
        None => State::new(specimen.network.positions.len()),
    };
    landscape::check(spec, &specimen)?;
    let team = Team::new(context.threads)?;
    let yardstick = Yardstick::new(spec, &specimen);
    let mut meter = Meter::new(state.work, context.interrupt);
    let mut experiment = Experiment::new(spec, specimen, state, team);
    let has_width = experiment.specimen.width_gauge.is_some();
    recorder.columns(&tables::columns(spec, has_width))?;
    for point in &experiment.state.points {
        recorder.point(&tables::values(spec, point))?;
    }
    if context.checkpoint.is_none() {
        let network = &experiment.specimen.network;
        recorder.log(&format!(
            "{} nodes, {} bonds, {} mm between the jaws",
            network.positions.len(),
            network.bonds.len(),
            experiment.specimen.gauge_length
        ));
    }
    let distribution_steps = distribution::steps(spec);
    let keep = |experiment: &mut Experiment<'_>, meter: &Meter<'_>, recorder: &mut dyn Recorder| {
        experiment.state.work = meter.work;
        let checkpoint = Checkpoint {
            spec: fingerprint,
            state: experiment.state.clone(),
        };
        recorder.checkpoint(&checkpoint::pack(&checkpoint)?)?;
        Ok::<(), SimulationError>(())
    };
    let stop_reason = loop {
        let was_whole = experiment.state.events.is_empty();
        let known = experiment.state.points.len();
        let advance = experiment.advance(&mut meter);
        for point in &experiment.state.points[known..] {
            recorder.point(&tables::values(spec, point))?;
        }
        match advance {
            Ok(Advance::GoesOn) if was_whole && !experiment.state.events.is_empty() => {
                recorder.log(&format!(
                    "the first bonds break at {} strain",
                    yardstick.percent(experiment.nominal_strain())
                ));
            }
            Ok(Advance::GoesOn) => {}
            Ok(Advance::StepDone(stop)) => {
                record_step(
                    &mut experiment,
                    &distribution_steps,
                    stop.is_some(),
                    recorder,
                )?;
                if let Some(reason) = stop {
                    break reason;
                }
                experiment.next_step();
            }
            Err(Halt::Interrupted(Interrupt::Cancel)) => return Ok(Ending::Cancelled),
            Err(Halt::Interrupted(Interrupt::Suspend)) => {
                keep(&mut experiment, &meter, recorder)?;
                return Ok(Ending::Suspended);
            }
            Err(Halt::Failed(error)) => return Err(error),
        }
        let (fraction, phase) = yardstick.measure(experiment.path(), &experiment.state);
        recorder.progress(fraction, &phase);
        if recorder.checkpoint_due() {
            keep(&mut experiment, &meter, recorder)?;
        }
    };
    recorder.log(&format!(
        "{} at {} strain, {} bonds broken",
        stop_reason.name().replace('_', " "),
        yardstick.percent(experiment.nominal_strain()),
        experiment.state.events.len()
    ));
    experiment.state.work = meter.work;
    snapshot::take_peak(&experiment, recorder)?;
    tables::write(spec, &experiment.specimen, &experiment.state, recorder)?;
    recorder.progress(1.0, "finished");
    let mut report = report::report(spec, &experiment.specimen, &experiment.state, stop_reason);
    let is_torn = matches!(
        stop_reason,
        StopReason::ForceDropped | StopReason::NoLoadPath
    );
    if let Some(words) = errors::add(&mut report, spec, &experiment.specimen, is_torn) {
        recorder.log(&words);
    }
    Ok(Ending::Finished(report))
}

/// Takes the snapshot and the force distribution that are due after a step.
fn record_step(
    experiment: &mut Experiment<'_>,
    distribution_steps: &[u64],
    is_last: bool,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let every = u64::from(experiment.snapshot_every());
    let is_turn = is_last || experiment.is_turning();
    let is_due = every > 0 && (is_turn || experiment.state.step.is_multiple_of(every));
    if is_due {
        snapshot::take(experiment, recorder)?;
    }
    if let Some(asked) = experiment.landscape_due() {
        landscape::take(asked, experiment, recorder)?;
        experiment.state.has_landscape = true;
    }
    if distribution_steps.contains(&experiment.state.step) {
        distribution::take(experiment);
    }
    Ok(())
}

impl StopReason {
    /// The word for programs.
    fn name(self) -> &'static str {
        match self {
            Self::ForceDropped => "force_dropped",
            Self::NoLoadPath => "no_load_path",
            Self::MaxStrain => "max_strain",
            Self::HistoryFinished => "history_finished",
        }
    }
}
