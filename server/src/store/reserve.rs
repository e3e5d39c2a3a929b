//! A full disk: a reserve of bytes that is given up, so that cancels and heartbeats can still be written.
//!
//! While the reserve is there, everything is written. When the disk is full it is removed, and only what
//! frees or saves something is written on its room; the rest is refused until the reserve could be laid
//! in again, which is tried every few seconds.
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::database;
use super::error::{Result, StoreError};

/// Size of the reserve [bytes]: the write-ahead log is begun anew after 4 MB, and pages change meanwhile.
const BYTES: usize = 16 << 20;
/// Bytes written at a time.
const CHUNK: usize = 1 << 20;
/// How often a full disk is looked at.
const LOOK_EVERY: Duration = Duration::from_secs(2);

/// The reserve of a data folder.
#[derive(Debug)]
pub(super) struct Reserve {
    place: PathBuf,
    /// Why the disk is taken for full.
    full: Mutex<Option<String>>,
}

impl Reserve {
    /// Lays in the reserve in `data`, if there is room for it; beside a server (for commands) it is the
    /// server's.
    pub(super) fn open(data: &Path, is_server: bool) -> Self {
        let reserve = Self {
            place: data.join("reserve"),
            full: Mutex::default(),
        };
        if is_server && let Err(error) = reserve.lay_in() {
            reserve.give_up(&error.to_string());
        }
        reserve
    }

    /// Gives up the reserve of `data` before anything else is opened; tells whether there was one.
    pub(super) fn release(data: &Path) -> bool {
        std::fs::remove_file(data.join("reserve")).is_ok()
    }

    /// Why the disk is taken for full, if it is.
    pub(super) fn full(&self) -> Option<String> {
        self.lock().clone()
    }

    /// Looks at an error, and gives up the reserve if it is that of a full disk.
    pub(super) fn note(&self, error: StoreError) -> StoreError {
        match told_full(&error) {
            Some(why) => {
                self.give_up(&why);
                StoreError::Full
            }
            None => error,
        }
    }

    /// Takes the disk for full, and gives up what was kept for then.
    pub(super) fn give_up(&self, why: &str) {
        let mut full = self.lock();
        if full.is_none() {
            tracing::error!(
                reason = why,
                "the disk is full: jobs, results and claims wait, cancels and heartbeats go on from the reserve; free some room"
            );
            *full = Some(why.to_owned());
            // on a disk that is ever so full the file may not even be there
            let _ = std::fs::remove_file(&self.place);
        }
    }

    /// Looks every few seconds whether a disk that was full has room again, until dropped.
    pub(super) async fn keep_looking(&self) {
        loop {
            tokio::time::sleep(LOOK_EVERY).await;
            if self.full().is_some() && self.lay_in().is_ok() {
                tracing::warn!("the disk has room again; everything is written as before");
                *self.lock() = None;
            }
        }
    }

    /// Writes the reserve, unless it is there.
    fn lay_in(&self) -> std::io::Result<()> {
        let length = std::fs::metadata(&self.place).map_or(0, |file| file.len());
        if length == BYTES as u64 {
            return Ok(());
        }
        let write = || {
            let mut file = File::create(&self.place)?;
            // bytes that no file system makes a hole of
            let chunk = vec![0x5a; CHUNK];
            for _ in 0..BYTES / CHUNK {
                file.write_all(&chunk)?;
            }
            file.sync_all()
        };
        write().inspect_err(|_| {
            let _ = std::fs::remove_file(&self.place);
        })
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<String>> {
        self.full.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What an error says of a full disk.
pub(super) fn told_full(error: &StoreError) -> Option<String> {
    use std::io::ErrorKind::{QuotaExceeded, StorageFull};
    match error {
        StoreError::Database(error) => database::told_full(error),
        StoreError::File { source, .. } => {
            matches!(source.kind(), StorageFull | QuotaExceeded).then(|| source.to_string())
        }
        _ => None,
    }
}

/// Whether an error is that of a full disk.
pub(super) fn is_full(error: &StoreError) -> bool {
    matches!(error, StoreError::Full) || told_full(error).is_some()
}

/// Refuses what has to wait for room.
pub(super) fn admit(reserve: &Reserve) -> Result<()> {
    match reserve.full() {
        Some(_) => Err(StoreError::Full),
        None => Ok(()),
    }
}
