//! Checkpoints: a version byte, a checksum, and the compressed state.
//!
//! Layout: version (1 byte), BLAKE3 of the rest (32 bytes), then a zstd frame holding the state in
//! postcard form. The version comes first and outside the checksum, so that a checkpoint of another
//! version is told apart from a damaged one.
use std::io::{BufWriter, IntoInnerError};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{InterruptSource, Uninterrupted, Wanted};

/// Raised whenever the state's form changes.
const VERSION: u8 = 15;
const CHECKSUM_BYTES: usize = 32;
/// Level 1: positions are nearly incompressible, so a higher level only costs time.
const COMPRESSION_LEVEL: i32 = 1;
/// Bytes of plain state between two looks whether it is still wanted.
const BUFFER_BYTES: usize = 1 << 16;

/// Why a checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    #[error("it has version {found}, this engine reads version {VERSION}")]
    Version { found: u8 },
    #[error("it is empty or cut short")]
    Truncated,
    #[error("its checksum does not match its content")]
    Corrupt,
    #[error("it belongs to another spec")]
    OtherSpec,
    #[error("its state cannot be read or written: {0}")]
    Form(String),
}

/// Tells the specs of checkpoints apart; kept in each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint([u8; 32]);

impl Fingerprint {
    /// # Errors
    /// [`CheckpointError::Form`] when the spec does not serialize.
    pub fn of(spec: &impl Serialize) -> Result<Self, CheckpointError> {
        let bytes = postcard::to_stdvec(spec).map_err(form)?;
        Ok(Self(*blake3::hash(&bytes).as_bytes()))
    }

    /// # Errors
    /// [`CheckpointError::OtherSpec`] when a checkpoint's fingerprint is not this one.
    pub fn check(self, of_checkpoint: Self) -> Result<(), CheckpointError> {
        if of_checkpoint == self {
            Ok(())
        } else {
            Err(CheckpointError::OtherSpec)
        }
    }
}

/// Packs `state`.
///
/// # Errors
/// [`CheckpointError::Form`] when the state does not serialize.
pub fn pack(state: &impl Serialize) -> Result<Vec<u8>, CheckpointError> {
    pack_wanted(state, &Uninterrupted)
}

/// Packs a `state` that may be large, and gives up when nothing of the run is wanted any more. The plain
/// state is never in memory as a whole.
///
/// # Errors
/// [`CheckpointError::Form`] when the state does not serialize or is not wanted.
pub fn pack_wanted(
    state: &impl Serialize,
    interrupt: &dyn InterruptSource,
) -> Result<Vec<u8>, CheckpointError> {
    let mut bytes = vec![VERSION];
    bytes.resize(1 + CHECKSUM_BYTES, 0);
    let packer = zstd::Encoder::new(bytes, COMPRESSION_LEVEL).map_err(form)?;
    let out = BufWriter::with_capacity(BUFFER_BYTES, Wanted::new(packer, interrupt));
    let out = postcard::to_io(state, out).map_err(form)?;
    let packer = out.into_inner().map_err(IntoInnerError::into_error);
    let packer = packer.map_err(form)?.into_inner();
    let mut bytes = packer.finish().map_err(form)?;
    let (before, packed) = bytes.split_at_mut(1 + CHECKSUM_BYTES);
    before[1..].copy_from_slice(blake3::hash(packed).as_bytes());
    Ok(bytes)
}

/// Reads what [`pack`] wrote.
///
/// # Errors
/// When the bytes are of another version, damaged, or of another type.
pub fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CheckpointError> {
    let (&version, rest) = bytes.split_first().ok_or(CheckpointError::Truncated)?;
    if version != VERSION {
        return Err(CheckpointError::Version { found: version });
    }
    let (checksum, packed) = rest
        .split_at_checked(CHECKSUM_BYTES)
        .ok_or(CheckpointError::Truncated)?;
    if blake3::hash(packed).as_bytes() != checksum {
        return Err(CheckpointError::Corrupt);
    }
    let plain = zstd::decode_all(packed).map_err(form)?;
    postcard::from_bytes(&plain).map_err(form)
}

pub fn form(error: impl std::fmt::Display) -> CheckpointError {
    CheckpointError::Form(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interrupt;
    use std::sync::atomic::{AtomicU64, Ordering};

    fn packed() -> Vec<u8> {
        pack(&(3_u64, vec![0.1, -0.0])).expect("a plain state serializes")
    }

    #[test]
    fn what_was_packed_is_read_back() {
        let state: (u64, Vec<f64>) = unpack(&packed()).expect("just packed");
        assert_eq!(state, (3, vec![0.1, -0.0]));
    }

    #[test]
    fn a_large_state_that_nobody_wants_is_given_up_on_the_way() {
        /// Is asked to give up at its third look.
        struct Third(AtomicU64);
        impl InterruptSource for Third {
            fn interrupt(&self) -> Option<Interrupt> {
                (self.0.fetch_add(1, Ordering::Relaxed) >= 2).then_some(Interrupt::Cancel)
            }
        }
        let third = Third(AtomicU64::new(0));
        let state = vec![0.5; 10 * BUFFER_BYTES];
        assert!(matches!(
            pack_wanted(&state, &third),
            Err(CheckpointError::Form(_))
        ));
        // 80 buffers of numbers: it looks no more often than it needs to find out
        assert!(third.0.load(Ordering::Relaxed) < 6);
    }

    #[test]
    fn another_version_is_named() {
        let mut bytes = packed();
        bytes[0] = VERSION + 1;
        let error = unpack::<(u64, Vec<f64>)>(&bytes);
        assert!(matches!(error, Err(CheckpointError::Version { found }) if found == VERSION + 1));
    }

    #[test]
    fn damage_is_found_wherever_it_is() {
        for position in 1..packed().len() {
            let mut bytes = packed();
            bytes[position] ^= 1;
            let error = unpack::<(u64, Vec<f64>)>(&bytes);
            assert!(matches!(error, Err(CheckpointError::Corrupt)), "{position}");
        }
        let cut = unpack::<u64>(&packed()[..20]);
        assert!(matches!(cut, Err(CheckpointError::Truncated)));
        assert!(matches!(
            unpack::<u64>(&[]),
            Err(CheckpointError::Truncated)
        ));
    }
}
