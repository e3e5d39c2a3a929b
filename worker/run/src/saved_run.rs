//! A checkpoint: the simulation's state with what the recording needs to go on.
//!
//! Layout: one line of JSON, then the bytes of the simulation, which carry their own version and
//! checksum. The log travels in it, so that `log.jsonl` is the same however often a run was
//! interrupted.
use loadframe_api::FileEntry;
use serde::{Deserialize, Serialize};

use super::cost::Spent;
use super::engine::Engine;

/// Raised whenever the header's form changes.
const FORMAT: u32 = 1;

/// A run as it was when it was last saved.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedRun {
    header: Header,
    /// What the simulation gave; empty before its first checkpoint.
    state: Vec<u8>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    format: u32,
    engine_version: String,
    /// Absent before format 1 knew it, and then of another build.
    #[serde(default)]
    engine_commit: String,
    spec_sha256: String,
    wall_s: f64,
    cpu_s: f64,
    files: Vec<FileEntry>,
    log: Vec<String>,
}

/// Why a saved run cannot be gone on from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedRunError {
    #[error("the checkpoint's header cannot be read")]
    Header(#[source] serde_json::Error),
    #[error("the checkpoint has format {0}, this engine reads {FORMAT}")]
    Format(u32),
    #[error(
        "the checkpoint is of build {saved}, this is {present}; results must come from one build"
    )]
    OtherBuild { saved: String, present: String },
    #[error("the checkpoint belongs to another spec")]
    OtherSpec,
}

impl SavedRun {
    /// A run of which nothing has been done.
    pub fn beginning(engine: Engine, spec_sha256: &str) -> Self {
        Self::new(
            engine,
            spec_sha256,
            Spent::default(),
            Vec::new(),
            Vec::new(),
            Vec::new(),
        )
    }

    /// A run of `spec_sha256` whose simulation gave `state`.
    pub fn new(
        engine: Engine,
        spec_sha256: &str,
        spent: Spent,
        files: Vec<FileEntry>,
        log: Vec<String>,
        state: Vec<u8>,
    ) -> Self {
        Self {
            header: Header {
                format: FORMAT,
                engine_version: engine.version.to_owned(),
                engine_commit: engine.commit.to_owned(),
                spec_sha256: spec_sha256.to_owned(),
                wall_s: spent.wall_s,
                cpu_s: spent.cpu_s,
                files,
                log,
            },
            state,
        }
    }

    /// The bytes that [`Self::from_bytes`] reads.
    pub fn to_bytes(&self) -> Vec<u8> {
        // plain text and numbers: writing them to memory has no way to fail
        let mut bytes = serde_json::to_vec(&self.header).unwrap_or_default();
        bytes.push(b'\n');
        bytes.extend(&self.state);
        bytes
    }

    /// Reads a run of the spec with the given hash, of this build of the engine.
    ///
    /// # Errors
    /// When the run cannot be gone on from.
    pub fn from_bytes(
        bytes: &[u8],
        engine: Engine,
        spec_sha256: &str,
    ) -> Result<Self, SavedRunError> {
        let end = bytes
            .iter()
            .position(|byte| *byte == b'\n')
            .unwrap_or(bytes.len());
        let (header, state) = bytes.split_at(end);
        let header: Header = serde_json::from_slice(header).map_err(SavedRunError::Header)?;
        if header.format != FORMAT {
            return Err(SavedRunError::Format(header.format));
        }
        if header.spec_sha256 != spec_sha256 {
            return Err(SavedRunError::OtherSpec);
        }
        if (&*header.engine_version, &*header.engine_commit) != (engine.version, engine.commit) {
            return Err(SavedRunError::OtherBuild {
                saved: format!("{}+{}", header.engine_version, header.engine_commit),
                present: engine.build(),
            });
        }
        let state = state.get(1..).unwrap_or_default().to_vec();
        Ok(Self { header, state })
    }

    /// What it took up to here.
    pub fn spent(&self) -> Spent {
        Spent {
            wall_s: self.header.wall_s,
            cpu_s: self.header.cpu_s,
        }
    }

    /// Result files that belong to the saved state.
    pub(crate) fn files(&self) -> &[FileEntry] {
        &self.header.files
    }

    /// Hash of the spec it belongs to.
    pub fn spec_sha256(&self) -> &str {
        &self.header.spec_sha256
    }

    /// What the simulation goes on from, `None` before its first checkpoint.
    pub fn state(&self) -> Option<&[u8]> {
        Some(self.state.as_slice()).filter(|state| !state.is_empty())
    }

    pub(crate) fn log(&self) -> &[String] {
        &self.header.log
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENGINE: Engine = Engine {
        version: "1.2.3",
        commit: "abc",
    };

    fn saved() -> SavedRun {
        let spent = Spent {
            wall_s: 1.5,
            cpu_s: 2.5,
        };
        SavedRun::new(
            ENGINE,
            "ab",
            spent,
            Vec::new(),
            vec!["a\nb".to_owned()],
            b"1\n2".to_vec(),
        )
    }

    #[test]
    fn what_was_saved_is_read_back() {
        let read = SavedRun::from_bytes(&saved().to_bytes(), ENGINE, "ab").expect("just saved");
        assert_eq!(read, saved());
    }

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let bytes = saved().to_bytes();
        let other = SavedRun::from_bytes(&bytes, ENGINE, "cd");
        assert!(matches!(other, Err(SavedRunError::OtherSpec)));
        let cut = SavedRun::from_bytes(&bytes[..9], ENGINE, "ab");
        assert!(matches!(cut, Err(SavedRunError::Header(_))));
        for (version, commit) in [("0.0.1", "abc"), ("1.2.3", "abd")] {
            let other = Engine { version, commit };
            let read = SavedRun::from_bytes(&bytes, other, "ab");
            let Err(error @ SavedRunError::OtherBuild { .. }) = read else {
                panic!("{other:?}: {read:?}");
            };
            assert!(error.to_string().contains("1.2.3+abc"), "{error}");
        }
    }
}
