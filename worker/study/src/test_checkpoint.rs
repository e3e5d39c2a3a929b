//! Checkpoints of tests that were interrupted, in a file each beside the finished tests.
use std::io;
use std::path::{Path, PathBuf};

use loadframe_run::{Engine, SavedRun, Spent};

/// Where the state of a test is kept while it is not finished.
#[derive(Debug)]
pub(super) struct TestCheckpoint {
    engine: Engine,
    path: PathBuf,
    spec_sha256: String,
}

impl TestCheckpoint {
    pub(super) fn new(folder: &Path, engine: Engine, spec_sha256: &str) -> Self {
        let name = format!("unfinished_{spec_sha256}_{}.bin", engine.commit);
        Self {
            engine,
            // of one engine only: a result comes from one
            path: folder.join(name),
            spec_sha256: spec_sha256.to_owned(),
        }
    }

    /// What is there of the test; a file that cannot be used is none.
    pub(super) fn read(&self) -> SavedRun {
        let bytes = std::fs::read(&self.path).ok();
        let saved = bytes
            .and_then(|bytes| SavedRun::from_bytes(&bytes, self.engine, &self.spec_sha256).ok());
        saved.unwrap_or_else(|| SavedRun::beginning(self.engine, &self.spec_sha256))
    }

    /// Saves the state of a test that took so much processor time up to here.
    pub(super) fn write(&self, cpu_s: f64, state: &[u8]) -> io::Result<()> {
        let spent = Spent { wall_s: 0.0, cpu_s };
        let saved = SavedRun::new(
            self.engine,
            &self.spec_sha256,
            spent,
            vec![],
            vec![],
            state.to_vec(),
        );
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
