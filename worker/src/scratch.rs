//! Folders for files on their way to the server.
use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;

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
    _lock: File,
}

impl Scratch {
    /// Opens a fresh folder under `parent` and removes those that died workers left there.
    pub(crate) fn open(parent: &Path) -> io::Result<Self> {
        std::fs::create_dir_all(parent)?;
        remove_abandoned(parent);
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(parent)?;
        // locked before it has its name: another worker that starts now must not find it free
        let unnamed = folder.path().join("lock.new");
        let lock = File::create(&unnamed)?;
        lock.lock()?;
        std::fs::rename(unnamed, folder.path().join(LOCK))?;
        Ok(Self {
            folder,
            _lock: lock,
        })
    }

    /// A fresh folder for one attempt.
    pub(crate) fn attempt(&self) -> io::Result<TempDir> {
        tempfile::tempdir_in(self.folder.path())
    }
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
