//! Folders for files on their way to the server.
use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use tempfile::TempDir;

const PREFIX: &str = "loadframe-worker-";
const LOCK: &str = "lock";

/// The scratch folder of a worker process, gone when dropped.
///
/// A killed process cannot clean up, so each holds a lock in its folder, which dies with it: the
/// next worker on the same machine removes every folder whose lock is free.
#[derive(Debug)]
pub(crate) struct Scratch {
    folder: TempDir,
    lock: Mutex<File>,
}

impl Scratch {
    /// Opens a fresh folder under `parent` and removes those that died workers left there.
    pub(crate) fn open(parent: &Path) -> io::Result<Self> {
        std::fs::create_dir_all(parent)?;
        remove_abandoned(parent);
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(parent)?;
        let lock = Mutex::new(lock(folder.path())?);
        Ok(Self { folder, lock })
    }

    /// Room for files in it [MB]; `None` where the system does not say.
    pub(crate) fn free_mb(&self) -> Option<f64> {
        loadframe_run::free_disk_mb(self.folder.path())
    }

    /// A fresh folder for one attempt. Where somebody has tidied away the whole, it is made anew.
    pub(crate) fn attempt(&self) -> io::Result<TempDir> {
        match tempfile::tempdir_in(self.folder.path()) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                std::fs::create_dir_all(self.folder.path())?;
                let lock = lock(self.folder.path())?;
                *self.lock.lock().unwrap_or_else(PoisonError::into_inner) = lock;
                tempfile::tempdir_in(self.folder.path())
            }
            folder => folder,
        }
    }
}

/// Locks a scratch folder before the lock has its name: another worker that starts now must not find it
/// free.
fn lock(folder: &Path) -> io::Result<File> {
    let unnamed = folder.join("lock.new");
    let lock = File::create(&unnamed)?;
    lock.lock()?;
    std::fs::rename(unnamed, folder.join(LOCK))?;
    Ok(lock)
}

/// Cleaning is a courtesy: what cannot be read or removed is left alone.
fn remove_abandoned(parent: &Path) {
    let Ok(entries) = std::fs::read_dir(parent) else {
        return;
    };
    for entry in entries.flatten() {
        let is_ours = entry.file_name().to_string_lossy().starts_with(PREFIX);
        // no lock file: its worker is just starting
        if is_ours && let Ok(lock) = File::open(entry.path().join(LOCK)) {
            match lock.try_lock() {
                Ok(()) => {
                    let _ = std::fs::remove_dir_all(entry.path());
                }
                Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workers_that_start_together_leave_each_other_their_folders() {
        let parent = tempfile::tempdir().expect("a temporary folder");
        let start = || {
            let opened = (0..50).map(|_| Scratch::open(parent.path()).expect("a scratch folder"));
            opened.collect::<Vec<Scratch>>()
        };
        let all: Vec<Scratch> = std::thread::scope(|scope| {
            let workers: Vec<_> = (0..8).map(|_| scope.spawn(start)).collect();
            let opened = workers.into_iter().map(|worker| worker.join());
            opened
                .flat_map(|opened| opened.expect("no panic"))
                .collect()
        });
        for scratch in &all {
            scratch.attempt().expect("an attempt's folder");
        }
    }

    #[test]
    fn a_folder_that_was_tidied_away_is_made_anew() {
        let parent = tempfile::tempdir().expect("a temporary folder");
        let scratch = Scratch::open(parent.path()).expect("a scratch folder");
        std::fs::remove_dir_all(scratch.folder.path()).expect("removed");
        let attempt = scratch.attempt().expect("an attempt's folder");
        let _other = Scratch::open(parent.path()).expect("a second scratch folder");
        assert!(attempt.path().exists(), "it is locked again");
    }

    #[test]
    fn only_folders_of_dead_workers_are_removed() {
        let parent = tempfile::tempdir().expect("a temporary folder");
        let living = Scratch::open(parent.path()).expect("a scratch folder");
        let dead = parent.path().join("loadframe-worker-dead");
        std::fs::create_dir(&dead).expect("a folder");
        std::fs::write(dead.join(LOCK), "").expect("a lock file nobody holds");
        let foreign = parent.path().join("somebody-else");
        std::fs::create_dir(&foreign).expect("a folder");
        let other = Scratch::open(parent.path()).expect("a second scratch folder");
        assert!(!dead.exists());
        assert!(foreign.exists() && living.folder.path().exists());
        drop(living);
        assert!(
            other
                .attempt()
                .expect("an attempt's folder")
                .path()
                .exists()
        );
    }
}
