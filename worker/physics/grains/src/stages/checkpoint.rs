//! A run as a checkpoint, and back.
use loadframe_harness::{
    Recorder, SimulationError,
    checkpoint::{self, CheckpointError, Fingerprint},
};
use serde::{Deserialize, Serialize, Serializer, ser::Error as _};

use super::runner::Runner;
use crate::{contact::lists::Lists, output::journal::Journal, step::state::State};

/// A state and the spec it belongs to.
#[derive(Serialize, Deserialize)]
struct Checkpoint {
    spec: Fingerprint,
    journal: Journal,
    state: State,
    /// Those of each patch, packed.
    contact_lists: Vec<Vec<u8>>,
}

/// The same, to be written without a copy.
#[derive(Serialize)]
struct CheckpointOf<'a> {
    spec: Fingerprint,
    journal: &'a Journal,
    state: &'a State,
    contact_lists: Vec<Packed<'a>>,
}

/// Lists that are packed one patch after the other.
struct Packed<'a>(&'a dyn Lists);

impl Serialize for Packed<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let bytes = self.0.pack().map_err(S::Error::custom)?;
        bytes.serialize(serializer)
    }
}

impl Runner<'_> {
    /// Goes on from what [`Runner::keep`] wrote.
    pub(super) fn resume(&mut self, bytes: &[u8]) -> Result<(), SimulationError> {
        let checkpoint: Checkpoint = checkpoint::unpack(bytes)?;
        self.fingerprint.check(checkpoint.spec)?;
        self.journal = checkpoint.journal;
        let lists = checkpoint.contact_lists.iter();
        let lists = lists.map(|bytes| (self.engine.law.unpack)(bytes));
        let lists = lists.collect::<Result<_, CheckpointError>>()?;
        self.engine.resume(checkpoint.state, lists);
        Ok(())
    }

    pub(super) fn keep(&self, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
        // what is not finite would never come right again: the last good checkpoint stays
        self.check_finite()?;
        let checkpoint = CheckpointOf {
            spec: self.fingerprint,
            journal: &self.journal,
            state: &self.engine.state,
            contact_lists: (self.engine.contact_lists.iter())
                .map(|lists| Packed(lists.as_ref()))
                .collect(),
        };
        recorder.checkpoint(&checkpoint::pack_wanted(&checkpoint, self.interrupt)?)?;
        Ok(())
    }
}
