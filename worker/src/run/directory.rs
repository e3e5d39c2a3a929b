//! A run into a folder somebody keeps, without a server.
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use loadframe_api::{FileEntry, JobSpec, Outcome};

use super::execute::{Ended, Plan, RunError, execute};
use super::outcome::OUTCOME_FILE;
use super::recording::{Destination, Progress};
use super::result_files::sha256_of_file;
use super::saved_run::{SavedRun, SavedRunError};
use crate::StopSwitch;

/// Holds the state of an unfinished run; gone once the run is finished.
const CHECKPOINT_FILE: &str = "checkpoint.bin";

/// How to run into a folder.
#[derive(Clone, Copy, Debug)]
pub struct DirectoryOptions<'a> {
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

/// What a run tells while it runs.
#[derive(Debug)]
pub enum News<'a> {
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
    tell: &mut dyn FnMut(News<'_>),
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
    let saved = match content(folder, &spec_sha256).map_err(unusable)? {
        Content::Result(outcome) => return Ok(DirectoryEnd::AlreadyThere(outcome)),
        Content::Other => return Err(DirectoryError::Occupied(folder.to_owned())),
        Content::Nothing => None,
        Content::Unfinished(Ok(saved)) => Some(saved),
        Content::Unfinished(Err(reason)) => {
            tell(News::Log(&format!("{reason}; starting from the beginning")));
            None
        }
    };
    let mut keeper = Keeper { folder, tell };
    if saved.is_none() {
        // marks the folder as this spec's before the first file is in it
        let beginning = SavedRun::beginning(&spec_sha256);
        keeper.checkpoint(beginning).map_err(unusable)?;
    }
    let plan = Plan {
        folder,
        threads: options.threads,
        checkpoint_every: options.checkpoint_every,
        switch: options.switch,
    };
    match execute(spec, saved, plan, &mut keeper)? {
        Ended::Finished { outcome, .. } => {
            std::fs::remove_file(folder.join(CHECKPOINT_FILE)).map_err(unusable)?;
            Ok(DirectoryEnd::Finished(outcome))
        }
        Ended::Suspended | Ended::Cancelled => Ok(DirectoryEnd::Suspended),
    }
}

enum Content {
    Nothing,
    Unfinished(Result<SavedRun, String>),
    Result(Box<Outcome>),
    Other,
}

fn content(folder: &Path, spec_sha256: &str) -> io::Result<Content> {
    if let Some(bytes) = read_if_there(&folder.join(CHECKPOINT_FILE))? {
        return Ok(match SavedRun::from_bytes(&bytes, spec_sha256) {
            Err(SavedRunError::OtherSpec) => Content::Other,
            Err(error) => Content::Unfinished(Err(error.to_string())),
            Ok(saved) => Content::Unfinished(check_files(saved, folder)),
        });
    }
    if let Some(bytes) = read_if_there(&folder.join(OUTCOME_FILE))? {
        return Ok(match serde_json::from_slice::<Outcome>(&bytes) {
            Ok(outcome) if outcome.provenance.spec_sha256 == spec_sha256 => {
                Content::Result(Box::new(outcome))
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

/// The files of a saved run must be as they were: the run does not write them again.
fn check_files(saved: SavedRun, folder: &Path) -> Result<SavedRun, String> {
    let is_whole = |entry: &&FileEntry| {
        sha256_of_file(&folder.join(&entry.name)).is_ok_and(|sha256| sha256 == entry.sha256)
    };
    let damaged = saved.files().iter().find(|entry| !is_whole(entry));
    match damaged.map(|entry| entry.name.clone()) {
        Some(name) => Err(format!("{name} is not as the checkpoint knows it")),
        None => Ok(saved),
    }
}

/// Keeps checkpoints beside the files, which are in the folder already.
struct Keeper<'a> {
    folder: &'a Path,
    tell: &'a mut dyn FnMut(News<'_>),
}

impl Destination for Keeper<'_> {
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
        (self.tell)(News::Progress(progress));
    }

    fn log(&mut self, message: &str) {
        (self.tell)(News::Log(message));
    }

    fn checkpoint(&mut self, saved: SavedRun) -> io::Result<()> {
        let partial = self.folder.join("checkpoint.bin.partial");
        let mut file = File::create(&partial)?;
        file.write_all(&saved.to_bytes())?;
        file.sync_all()?;
        std::fs::rename(partial, self.folder.join(CHECKPOINT_FILE))
    }
}
