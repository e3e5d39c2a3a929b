//! A run into a folder somebody keeps, without a server.
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use loadframe_api::{FileEntry, JobSpec, Outcome, Provenance};

use super::engine::Engine;
use super::execute::{Ended, RunError, execute};
use super::outcome::OUTCOME_FILE;
use super::plan::Plan;
use super::recording::{Destination, FAILURE_FILE, Progress};
use super::result_files::sha256_of_file;
use super::saved_run::{SavedRun, SavedRunError};
use super::stop::StopSwitch;

/// Holds the state of an unfinished run; gone once the run is finished.
const CHECKPOINT_FILE: &str = "checkpoint.bin";

/// How to run into a folder.
#[derive(Clone, Copy, Debug)]
pub struct DirectoryOptions<'a> {
    /// What computes.
    pub engine: Engine,
    pub threads: usize,
    /// Time between checkpoints.
    pub checkpoint_every: Duration,
    pub switch: &'a StopSwitch,
}

/// How a run into a folder ended.
#[derive(Debug)]
pub enum DirectoryEnd {
    Finished(Box<Outcome>),
    /// The folder held the result of this spec already.
    AlreadyThere(Box<Outcome>),
    /// Stopped early; the same call goes on.
    Suspended,
}

/// Why there is no result in the folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DirectoryError {
    #[error("{} holds files that are not of a run of this spec; choose another folder", .0.display())]
    Occupied(PathBuf),
    #[error("{} holds a result of this spec that cannot be given for this build's: {reason}; choose another folder, or remove it", folder.display())]
    Stale { folder: PathBuf, reason: String },
    #[error("another process is running into {}", .0.display())]
    InUse(PathBuf),
    #[error("{} cannot be used", folder.display())]
    Folder {
        folder: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error(transparent)]
    Run(#[from] RunError),
}

/// What a run reports while it runs.
#[derive(Debug)]
pub enum RunUpdate<'a> {
    Progress(Progress),
    Log(&'a str),
}

/// Runs `spec` into `folder`, or goes on with what an interrupted run of it left there.
///
/// # Errors
/// [`DirectoryError`] when there is no result, or the folder belongs to something else.
pub fn run_to_directory(
    spec: &JobSpec,
    folder: &Path,
    options: DirectoryOptions<'_>,
    report: &mut dyn FnMut(RunUpdate<'_>),
) -> Result<DirectoryEnd, DirectoryError> {
    let unusable = |source| DirectoryError::Folder {
        folder: folder.to_owned(),
        source,
    };
    std::fs::create_dir_all(folder).map_err(unusable)?;
    let lock = File::open(folder).map_err(unusable)?;
    if lock.try_lock().is_err() {
        return Err(DirectoryError::InUse(folder.to_owned()));
    }
    let spec_sha256 = spec.sha256();
    let saved = match content(folder, options.engine, &spec_sha256).map_err(unusable)? {
        Content::Result(outcome) => return Ok(DirectoryEnd::AlreadyThere(outcome)),
        Content::Stale(reason) => {
            let folder = folder.to_owned();
            return Err(DirectoryError::Stale { folder, reason });
        }
        Content::Other => return Err(DirectoryError::Occupied(folder.to_owned())),
        Content::Nothing => None,
        Content::Unfinished(Ok(saved)) => Some(saved),
        Content::Unfinished(Err(reason)) => {
            report(RunUpdate::Log(&format!(
                "{reason}; starting from the beginning"
            )));
            None
        }
    };
    let mut destination = FolderDestination { folder, report };
    if saved.is_none() {
        // marks the folder as this spec's before the first file is in it; there is nothing in it to lose
        let beginning = SavedRun::beginning(options.engine, &spec_sha256).to_bytes();
        std::fs::write(folder.join(CHECKPOINT_FILE), beginning).map_err(unusable)?;
    }
    let plan = Plan {
        engine: options.engine,
        folder,
        threads: options.threads,
        checkpoint_every: options.checkpoint_every,
        switch: options.switch,
    };
    match execute(spec, saved, plan, &mut destination)? {
        Ended::Finished { outcome, .. } => {
            std::fs::remove_file(folder.join(CHECKPOINT_FILE)).map_err(unusable)?;
            // of an earlier run that failed
            let _ = std::fs::remove_file(folder.join(FAILURE_FILE));
            Ok(DirectoryEnd::Finished(outcome))
        }
        Ended::Suspended | Ended::Cancelled => Ok(DirectoryEnd::Suspended),
    }
}

enum Content {
    Nothing,
    Unfinished(Result<SavedRun, String>),
    Result(Box<Outcome>),
    /// A result of the spec, and why it is not what this build would give.
    Stale(String),
    Other,
}

fn content(folder: &Path, engine: Engine, spec_sha256: &str) -> io::Result<Content> {
    if let Some(bytes) = read_if_there(&folder.join(CHECKPOINT_FILE))? {
        return Ok(match SavedRun::from_bytes(&bytes, engine, spec_sha256) {
            Err(SavedRunError::OtherSpec) => Content::Other,
            Err(error) => Content::Unfinished(Err(error.to_string())),
            Ok(saved) => Content::Unfinished(check_files(saved, folder)),
        });
    }
    if let Some(bytes) = read_if_there(&folder.join(OUTCOME_FILE))? {
        return Ok(match serde_json::from_slice::<Outcome>(&bytes) {
            Ok(outcome) if outcome.provenance.spec_sha256 == spec_sha256 => {
                match flaw(&outcome, engine, folder) {
                    None => Content::Result(Box::new(outcome)),
                    Some(flaw) => Content::Stale(flaw),
                }
            }
            _ => Content::Other,
        });
    }
    Ok(match std::fs::read_dir(folder)?.next() {
        None => Content::Nothing,
        Some(_) => Content::Other,
    })
}

fn read_if_there(path: &Path) -> io::Result<Option<Vec<u8>>> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Why a result is not what this build would give: another computed it, or a file is not what it was.
fn flaw(outcome: &Outcome, engine: Engine, folder: &Path) -> Option<String> {
    let Provenance {
        engine_version,
        engine_commit,
        ..
    } = &outcome.provenance;
    if (engine_version.as_str(), engine_commit.as_str()) != (engine.version, engine.commit) {
        let (this, own) = (format!("{engine_version}+{engine_commit}"), engine.build());
        return Some(format!("{this} computed it, and this is {own}"));
    }
    let damaged = damaged(&outcome.files, folder)?;
    Some(format!("{damaged} is not as outcome.json knows it"))
}

/// The files of a saved run must be as they were: the run does not write them again.
fn check_files(saved: SavedRun, folder: &Path) -> Result<SavedRun, String> {
    match damaged(saved.files(), folder) {
        Some(name) => Err(format!("{name} is not as the checkpoint knows it")),
        None => Ok(saved),
    }
}

/// Name of the first file that is not there as it was.
fn damaged<'a>(files: &'a [FileEntry], folder: &Path) -> Option<&'a str> {
    let is_whole = |entry: &&FileEntry| {
        sha256_of_file(&folder.join(&entry.name)).is_ok_and(|sha256| sha256 == entry.sha256)
    };
    let damaged = files.iter().find(|entry| !is_whole(entry));
    damaged.map(|entry| entry.name.as_str())
}

/// Keeps checkpoints beside the files, which are in the folder already.
struct FolderDestination<'a> {
    folder: &'a Path,
    report: &'a mut dyn FnMut(RunUpdate<'_>),
}

impl Destination for FolderDestination<'_> {
    fn columns(&mut self, _: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn file(&mut self, _: &FileEntry, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn progress(&mut self, progress: Progress) {
        (self.report)(RunUpdate::Progress(progress));
    }

    fn log(&mut self, message: &str) {
        (self.report)(RunUpdate::Log(message));
    }

    fn checkpoint(&mut self, saved: SavedRun) -> io::Result<()> {
        let partial = self.folder.join("checkpoint.bin.partial");
        let mut file = File::create(&partial)?;
        file.write_all(&saved.to_bytes())?;
        file.sync_all()?;
        std::fs::rename(partial, self.folder.join(CHECKPOINT_FILE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::Spent;
    use crate::stop::StopCause;
    use loadframe_api::{JobKind, Submission};

    const ENGINE: Engine = Engine {
        version: "1.2.3",
        commit: "abc",
    };

    fn spec() -> JobSpec {
        let example = JobKind::NonwovenTensile.examples()[1];
        let submission = Submission::from_slice(example.body.as_bytes());
        submission.expect("a valid example").spec
    }

    /// Runs into `folder`, throwing `switch` once the job is so far; also returns the log.
    fn run(folder: &Path, stop_at: f64) -> (Result<DirectoryEnd, DirectoryError>, Vec<String>) {
        let switch = StopSwitch::default();
        let mut log = Vec::new();
        let options = DirectoryOptions {
            engine: ENGINE,
            threads: 1,
            checkpoint_every: Duration::from_secs(3600),
            switch: &switch,
        };
        let end = run_to_directory(&spec(), folder, options, &mut |update| match update {
            RunUpdate::Progress(progress) if progress.fraction >= stop_at => {
                switch.stop(StopCause::Shutdown);
            }
            RunUpdate::Progress(_) => {}
            RunUpdate::Log(message) => log.push(message.to_owned()),
        });
        (end, log)
    }

    const NEVER: f64 = 2.0;

    fn table(folder: &Path) -> Vec<u8> {
        std::fs::read(folder.join("curve.csv")).expect("a curve")
    }

    #[test]
    fn a_stopped_run_goes_on_to_the_same_result() {
        let [alone, stopped] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        let (end, log_alone) = run(alone.path(), NEVER);
        assert!(matches!(end, Ok(DirectoryEnd::Finished(_))), "{end:?}");
        let (end, log_before) = run(stopped.path(), 0.3);
        assert!(matches!(end, Ok(DirectoryEnd::Suspended)), "{end:?}");
        let (end, log_after) = run(stopped.path(), NEVER);
        assert!(matches!(end, Ok(DirectoryEnd::Finished(_))), "{end:?}");
        assert_eq!(table(stopped.path()), table(alone.path()));
        assert_eq!([log_before, log_after].concat(), log_alone);
        let log = |folder: &Path| std::fs::read(folder.join("log.jsonl")).expect("a log");
        assert_eq!(log(stopped.path()), log(alone.path()));
        let results = |folder: &Path| {
            std::fs::read_to_string(folder.join("results.csv")).expect("the results")
        };
        assert_eq!(results(stopped.path()), results(alone.path()));
        assert!(results(alone.path()).contains("\nmax_force,"));
        assert!(!stopped.path().join(CHECKPOINT_FILE).exists());
        let (end, _) = run(stopped.path(), NEVER);
        assert!(matches!(end, Ok(DirectoryEnd::AlreadyThere(_))), "{end:?}");
    }

    #[test]
    fn a_result_of_another_build_or_with_another_file_is_not_given_for_this_ones() {
        let folder = tempfile::tempdir().expect("a folder");
        let (end, _) = run(folder.path(), NEVER);
        assert!(matches!(end, Ok(DirectoryEnd::Finished(_))), "{end:?}");
        let refused_after = |name: &str, change: &dyn Fn(String) -> String| {
            let path = folder.path().join(name);
            let text = std::fs::read_to_string(&path).expect("a file of the result");
            std::fs::write(&path, change(text.clone())).expect("written");
            let end = run(folder.path(), NEVER).0;
            std::fs::write(&path, text).expect("written");
            end.expect_err("it is another").to_string()
        };
        let refused = refused_after(OUTCOME_FILE, &|text| text.replace("1.2.3", "1.2.2"));
        assert!(
            refused.contains("1.2.2+abc computed it, and this is 1.2.3+abc"),
            "{refused}"
        );
        let refused = refused_after("curve.csv", &|text| text.replacen('1', "2", 1));
        assert!(
            refused.contains("curve.csv is not as outcome.json knows it"),
            "{refused}"
        );
        let (end, _) = run(folder.path(), NEVER);
        assert!(matches!(end, Ok(DirectoryEnd::AlreadyThere(_))), "{end:?}");
    }

    #[test]
    fn a_checkpoint_that_cannot_be_used_costs_time_not_the_result() {
        let folder = tempfile::tempdir().expect("a folder");
        let state = b"not what a simulation gave".to_vec();
        let damaged = SavedRun::new(
            ENGINE,
            &spec().sha256(),
            Spent::default(),
            vec![],
            vec![],
            state,
        );
        for bytes in [damaged.to_bytes(), b"not even a header".to_vec()] {
            let place = folder.path().join(CHECKPOINT_FILE);
            std::fs::write(place, bytes).expect("written");
            let (end, log) = run(folder.path(), NEVER);
            assert!(matches!(end, Ok(DirectoryEnd::Finished(_))), "{end:?}");
            assert!(log[0].ends_with("starting from the beginning"), "{log:?}");
        }
    }

    #[test]
    fn a_file_changed_behind_the_checkpoint_is_noticed() {
        let folder = tempfile::tempdir().expect("a folder");
        let (end, _) = run(folder.path(), 0.3);
        assert!(matches!(end, Ok(DirectoryEnd::Suspended)), "{end:?}");
        let snapshot = folder.path().join("snapshots/step_00000.vtp");
        std::fs::write(&snapshot, "something else").expect("there");
        let (end, log) = run(folder.path(), NEVER);
        assert!(matches!(end, Ok(DirectoryEnd::Finished(_))), "{end:?}");
        assert!(log[0].starts_with("snapshots/step_00000.vtp"), "{log:?}");
        assert_ne!(std::fs::read(&snapshot).expect("there"), b"something else");
    }

    #[test]
    fn files_of_something_else_are_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("thesis.tex"), "").expect("written");
        let (end, _) = run(folder.path(), NEVER);
        assert!(matches!(end, Err(DirectoryError::Occupied(_))), "{end:?}");
        assert_eq!(folder.path().read_dir().expect("a folder").count(), 1);
    }

    /// A sphere that falls under 10⁶ m/s² and becomes too fast for its step.
    fn falls_too_fast() -> JobSpec {
        let body = serde_json::json!({"kind": "granular_scene", "spec": {
            "version": 1, "gravity_m_per_s2": [0, 0, -1e6],
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8,
                                    "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
            "bodies": [{"sphere": {"radius_m": 0.01}, "material": "stone", "position_m": [0, 0, 1]}],
            "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
            "time_step_s": 1e-5,
            "stages": [{"run": {"steps": 1000}}],
            "record": {"every_steps": 1},
        }});
        let submission = Submission::from_slice(body.to_string().as_bytes());
        submission.expect("a valid scene").spec
    }

    #[test]
    fn a_run_that_fails_leaves_what_it_had_and_says_that_it_is_no_result() {
        let folder = tempfile::tempdir().expect("a folder");
        let switch = StopSwitch::default();
        let options = DirectoryOptions {
            engine: ENGINE,
            threads: 1,
            checkpoint_every: Duration::from_secs(3600),
            switch: &switch,
        };
        let end = run_to_directory(&falls_too_fast(), folder.path(), options, &mut |_| {});
        assert!(
            matches!(end, Err(DirectoryError::Run(RunError::Simulation(_)))),
            "{end:?}"
        );
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
        let curve = read("curve.csv");
        assert!(curve.starts_with("step,time_s,stage,"), "{curve}");
        let rows: Vec<&str> = curve.lines().skip(1).collect();
        // 10 m/s more with every step of 10 µs
        assert!(rows.len() > 2 && rows.len() < 1000, "{} rows", rows.len());
        assert!(
            rows[0].starts_with("0,0,") && rows[1].starts_with("1,0.00001,"),
            "{rows:?}"
        );
        assert!(read("log.jsonl").contains("failed: the simulation has no result"));
        let failure: serde_json::Value = serde_json::from_str(&read(FAILURE_FILE)).expect("JSON");
        assert_eq!(failure["status"], "failed");
        assert!(!folder.path().join(OUTCOME_FILE).exists());
    }
}
