//! Runs a simulation from a saved state to its end, and catches what may come of it.
use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;

use loadframe_api::{FileEntry, JobSpec, Outcome};
use loadframe_physics::{Ending, RunContext, SimulationError, simulate};

use super::engine::Engine;
use super::recording::{Destination, Recording};
use super::saved_run::SavedRun;
use super::stop::StopSwitch;

/// How a run is to be carried out.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// What computes.
    pub engine: Engine,
    /// Where result files are written.
    pub folder: &'a Path,
    pub threads: usize,
    /// Time between checkpoints.
    pub checkpoint_every: Duration,
    pub switch: &'a StopSwitch,
}

/// How a run ended.
#[derive(Debug)]
pub enum Ended {
    /// All files are written, `outcome.json` among them.
    Finished {
        outcome: Box<Outcome>,
        files: Vec<FileEntry>,
    },
    Cancelled,
    /// Its checkpoint is with the destination.
    Suspended,
}

/// Why a run has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    #[error("the simulation has no result")]
    Simulation(#[source] SimulationError),
    /// Not the job's fault: a disk, the way to the server.
    #[error("the results could not be kept")]
    Results(#[source] io::Error),
    /// Not the job's fault either.
    #[error("this machine could not carry out the simulation")]
    Machine(#[source] SimulationError),
    #[error(
        "the simulation stopped in a way it never should: {0}. This is a bug in loadframe; please report it with the job's spec"
    )]
    Bug(String),
}

/// Runs `spec`, going on from `saved` where that is possible and from the start where it is not.
///
/// # Errors
/// [`RunError`] when there is no result.
pub fn execute<D: Destination>(
    spec: &JobSpec,
    saved: Option<SavedRun>,
    plan: Plan<'_>,
    destination: &mut D,
) -> Result<Ended, RunError> {
    if let Some(saved) = saved {
        match execute_from(spec, &saved, plan, destination) {
            Err(RunError::Simulation(SimulationError::Checkpoint(error))) => {
                // what is lost is time, not the job
                destination.log(&format!(
                    "the checkpoint cannot be used: {error}; starting from the beginning"
                ));
            }
            end => return end,
        }
    }
    execute_from(
        spec,
        &SavedRun::beginning(plan.engine, &spec.sha256()),
        plan,
        destination,
    )
}

fn execute_from<D: Destination>(
    spec: &JobSpec,
    saved: &SavedRun,
    plan: Plan<'_>,
    destination: &mut D,
) -> Result<Ended, RunError> {
    let mut recording = Recording::start(
        plan.engine,
        saved,
        plan.folder,
        plan.checkpoint_every,
        destination,
    );
    let context = RunContext {
        threads: plan.threads,
        interrupt: plan.switch,
        checkpoint: saved.state(),
    };
    // a panic is one of physics, between its calls of the recording
    let call = AssertUnwindSafe(|| simulate(spec, context, &mut recording));
    let ending = match catch_unwind(call) {
        Ok(ending) => ending,
        Err(panic) => {
            let error = RunError::Bug(message(panic.as_ref()));
            return Err(failed(recording, spec, error));
        }
    };
    match ending {
        Ok(Ending::Finished(report)) => {
            let finished = recording.finish(spec, plan.threads, report);
            let (outcome, files) = finished.map_err(RunError::Results)?;
            Ok(Ended::Finished {
                outcome: Box::new(outcome),
                files,
            })
        }
        Ok(Ending::Cancelled) => Ok(Ended::Cancelled),
        Ok(Ending::Suspended) => Ok(Ended::Suspended),
        Err(SimulationError::Recorder(error)) => Err(RunError::Results(error)),
        Err(error @ SimulationError::Threads { .. }) => Err(RunError::Machine(error)),
        // the run begins anew
        Err(error @ SimulationError::Checkpoint(_)) => Err(RunError::Simulation(error)),
        Err(error) => Err(failed(recording, spec, RunError::Simulation(error))),
    }
}

/// Keeps what a failed run had.
fn failed<D: Destination>(
    recording: Recording<'_, D>,
    spec: &JobSpec,
    error: RunError,
) -> RunError {
    let chain = std::iter::successors(Some(&error as &dyn std::error::Error), |error| {
        error.source()
    });
    let reason: Vec<String> = chain.map(ToString::to_string).collect();
    // why the run failed matters more than what cannot be kept of it
    let _ = recording.fail(spec, &reason.join(": "));
    error
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("panic without a message")
        .to_owned()
}
