//! Runs a simulation from a saved state to its end, and catches what may come of it.
use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use loadframe_api::{FileEntry, JobSpec, Outcome};
use loadframe_physics::{
    Ending, Interrupt, InterruptSource, RunContext, SimulationError, simulate,
};

use super::plan::Plan;
use super::recording::{Destination, Recording};
use super::saved_run::SavedRun;

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
    let mut recording = Recording::start(plan, saved, destination);
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
            // a file that was not wanted any more says that it could not be written
            if plan.switch.interrupt() == Some(Interrupt::Cancel) {
                return Ok(Ended::Cancelled);
            }
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

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::thread;
    use std::time::{Duration, Instant};

    use super::*;
    use crate::{Engine, Progress, StopCause, StopSwitch};
    use loadframe_api::Submission;
    use serde_json::{Value, json};

    /// Time for the look at the switch, on a busy machine.
    const SOON: Duration = Duration::from_millis(1500);

    /// Names of the files that came.
    #[derive(Default)]
    struct Names(Vec<String>);

    impl Destination for Names {
        fn columns(&mut self, _: &[&str]) -> io::Result<()> {
            Ok(())
        }
        fn point(&mut self, _: &[f64]) -> io::Result<()> {
            Ok(())
        }
        fn file(&mut self, entry: &FileEntry, _: &Path) -> io::Result<()> {
            self.0.push(entry.name.clone());
            Ok(())
        }
        fn progress(&mut self, _: Progress) {}
        fn log(&mut self, _: &str) {}
        fn checkpoint(&mut self, _: SavedRun) -> io::Result<()> {
            Ok(())
        }
    }

    fn scene(rest: Value) -> JobSpec {
        let mut spec = json!({
            "version": 1,
            "materials": {"stone": {
                "density_kg_per_m3": 2500, "youngs_modulus_pa": 5e7, "friction_angle_rad": 0,
            }},
            "time_step_s": 1e-5,
        });
        for (name, value) in rest.as_object().expect("fields") {
            spec[name] = value.clone();
        }
        let body = json!({"kind": "granular_scene", "spec": spec}).to_string();
        Submission::from_slice(body.as_bytes())
            .expect("a valid scene")
            .spec
    }

    /// Runs `spec`, and cancels once `is_time` says so in the folder of its files; what came of it, and how
    /// long after the cancel.
    fn cancelled_when(
        spec: &JobSpec,
        is_time: impl Fn(&Path) -> bool + Sync,
    ) -> (Ended, Vec<String>, Duration) {
        let folder = tempfile::tempdir().expect("a folder");
        let switch = StopSwitch::default();
        let plan = Plan {
            engine: Engine {
                version: "1",
                commit: "1",
            },
            folder: folder.path(),
            threads: 1,
            checkpoint_every: Duration::from_secs(3600),
            switch: &switch,
        };
        thread::scope(|scope| {
            let cancelled = scope.spawn(|| {
                while !is_time(folder.path()) {
                    thread::sleep(Duration::from_millis(2));
                }
                switch.stop(StopCause::Cancel);
                Instant::now()
            });
            let mut names = Names::default();
            let ended = execute(spec, None, plan, &mut names).expect("no error");
            let end = Instant::now();
            let cancelled = cancelled.join().expect("no panic");
            (ended, names.0, end.saturating_duration_since(cancelled))
        })
    }

    #[test]
    fn a_cancel_while_a_large_table_is_written_is_heard_before_it_is_whole() {
        let sphere = |number: u32| {
            json!({
                "sphere": {"radius_m": 0.001}, "material": "stone",
                "position_m": [0.01 * f64::from(number), 0, 0], "velocity_m_per_s": [0.1, 0.2, 0.3],
            })
        };
        let spheres: Vec<_> = (0..300).map(sphere).collect();
        let spec = scene(json!({
            "bodies": spheres,
            "stages": [{"run": {"steps": 1000}}],
            "record": {"every_steps": 1},
        }));
        let is_written = |folder: &Path| folder.join("bodies.csv.partial").exists();
        let (ended, names, took) = cancelled_when(&spec, is_written);
        assert!(matches!(ended, Ended::Cancelled), "{ended:?}");
        // 300 000 rows would come otherwise
        assert!(!names.iter().any(|name| name == "bodies.csv"), "{names:?}");
        assert!(took < SOON, "{took:?}");
    }

    #[test]
    fn a_cancel_while_many_bodies_are_placed_is_heard_before_they_are() {
        let spec = scene(json!({
            "generate": [{
                "count": 400_000, "material": "stone", "sizes": {"radius_m": 0.001},
                "region": {"box": {"lower_m": [0, 0, 0], "upper_m": [0.18, 0.18, 0.18]}},
            }],
            "stages": [{"run": {"steps": 1000}}],
        }));
        let begin = Instant::now();
        let is_time = move |_: &Path| begin.elapsed() > Duration::from_millis(300);
        let (ended, names, took) = cancelled_when(&spec, is_time);
        assert!(matches!(ended, Ended::Cancelled), "{ended:?}");
        assert_eq!(names, [""; 0]);
        assert!(took < SOON, "{took:?}");
    }
}
