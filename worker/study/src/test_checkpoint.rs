//! Tests that were interrupted, in a file each beside those that are finished.
use std::io;
use std::path::{Path, PathBuf};

use crate::ENGINE_COMMIT;
use crate::run::{SavedRun, Spent};

/// Where a test is kept while it is not finished.
#[derive(Debug)]
pub(super) struct Unfinished {
    path: PathBuf,
    spec_sha256: String,
}

impl Unfinished {
    pub(super) fn new(folder: &Path, spec_sha256: &str) -> Self {
        Self {
            // of one engine only: a result comes from one
            path: folder.join(format!("unfinished_{spec_sha256}_{ENGINE_COMMIT}.bin")),
            spec_sha256: spec_sha256.to_owned(),
        }
    }

    /// What is there of the test; a file that cannot be used is none.
    pub(super) fn read(&self) -> SavedRun {
        let bytes = std::fs::read(&self.path).ok();
        let saved = bytes.and_then(|bytes| SavedRun::from_bytes(&bytes, &self.spec_sha256).ok());
        saved.unwrap_or_else(|| SavedRun::beginning(&self.spec_sha256))
    }

    /// Keeps the state of a test that took so much processor time up to here.
    pub(super) fn keep(&self, cpu_s: f64, state: &[u8]) -> io::Result<()> {
        let spent = Spent { wall_s: 0.0, cpu_s };
        let saved = SavedRun::new(&self.spec_sha256, spent, vec![], vec![], state.to_vec());
        let partial = self.path.with_extension("partial");
        std::fs::write(&partial, saved.to_bytes())?;
        std::fs::rename(partial, &self.path)
    }

    /// The test is finished, or its state could not be gone on from.
    pub(super) fn remove(&self) {
        // a file that stays is never read again
        let _ = std::fs::remove_file(&self.path);
    }
}
