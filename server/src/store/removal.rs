//! Whose turn it is with stored files: who removes some, or a backup, which needs all that its database names.
//!
//! A backup is a process of its own and may take hours, so this is a lock on a file in the data folder; the
//! system gives it back when the process ends, however.
use std::fs::{File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::disk::blocking;
use super::error::{Result, StoreError};

const FILE: &str = "removal.lock";

/// The lock, for who removes.
#[derive(Debug)]
pub(super) struct Removal {
    path: PathBuf,
    file: File,
}

/// While it lives, no backup begins.
#[derive(Debug)]
pub(super) struct Removing<'a>(&'a File);

impl Drop for Removing<'_> {
    fn drop(&mut self) {
        // it fails for a lock that is not held, and this one is
        let _ = self.0.unlock();
    }
}

impl Removal {
    /// The lock of the data folder `data`, which may be somebody else's to write.
    pub(super) fn of(data: &Path) -> Result<Self> {
        let path = data.join(FILE);
        let opened = match File::open(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                OpenOptions::new().append(true).create(true).open(&path)
            }
            opened => opened,
        };
        let file = opened.map_err(StoreError::file(&path))?;
        Ok(Self { path, file })
    }

    /// The turn, unless a backup has it.
    pub(super) fn begin(&self) -> Result<Option<Removing<'_>>> {
        match self.file.try_lock() {
            Ok(()) => Ok(Some(Removing(&self.file))),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(StoreError::file(&self.path)(error)),
        }
    }
}

/// Has nothing removed from the store in `data` until what is returned is dropped: waits for who is removing
/// something just now. There is nothing to hold where no server has ever had one.
pub(super) async fn remove_none(data: &Path) -> Result<Option<File>> {
    let path = data.join(FILE);
    let place = path.clone();
    blocking(&place, move || match File::open(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
        Ok(file) => {
            file.lock_shared()?;
            Ok(Some(file))
        }
    })
    .await
}
