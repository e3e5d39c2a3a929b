//! Runs that are not done again.
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use loadframe_api::{JobSpec, Report};

use crate::run;

/// The report of a job, `None` where it has none. It is kept, and the same executable does not run the
/// job again: of fabrics that take hours, a measurement that was stopped goes on.
pub(crate) fn report(job: &JobSpec) -> Option<Report> {
    let place = place(job).ok();
    let kept = place.as_ref().and_then(|place| fs::read(place).ok());
    if let Some(found) = kept.and_then(|kept| serde_json::from_slice(&kept).ok()) {
        return found;
    }
    let found = run::report(job);
    if let Some(Err(error)) = place.map(|place| keep(&place, &found)) {
        eprintln!("a run is not kept: {error}");
    }
    found
}

/// Beside the executable, by what it is asked and when it was built.
fn place(job: &JobSpec) -> io::Result<PathBuf> {
    let executable = env::current_exe()?;
    let mut key = DefaultHasher::new();
    format!("{job:?}").hash(&mut key);
    executable.metadata()?.modified()?.hash(&mut key);
    let folder = executable.with_extension("runs");
    fs::create_dir_all(&folder)?;
    Ok(folder.join(format!("{:016x}.json", key.finish())))
}

/// Whole or not at all, whenever it is stopped.
fn keep(place: &Path, found: &Option<Report>) -> io::Result<()> {
    let part = place.with_extension("part");
    fs::write(&part, serde_json::to_vec(found)?)?;
    fs::rename(part, place)
}
