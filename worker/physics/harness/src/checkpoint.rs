//! Checkpoints: a version byte, a checksum, and the compressed state.
//!
//! Layout: version (1 byte), BLAKE3 of the rest (32 bytes), then a zstd frame holding the state in
//! postcard form. The version comes first and outside the checksum, so that a checkpoint of another
//! version is told apart from a damaged one.
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Raised whenever the state's form changes.
const VERSION: u8 = 11;
const CHECKSUM_BYTES: usize = 32;
/// Level 1: positions are nearly incompressible, so a higher level only costs time.
const COMPRESSION_LEVEL: i32 = 1;

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
    let plain = postcard::to_stdvec(state).map_err(form)?;
    let packed = zstd::encode_all(plain.as_slice(), COMPRESSION_LEVEL).map_err(form)?;
    let mut bytes = Vec::with_capacity(1 + CHECKSUM_BYTES + packed.len());
    bytes.push(VERSION);
    bytes.extend(blake3::hash(&packed).as_bytes());
    bytes.extend(packed);
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

    fn packed() -> Vec<u8> {
        pack(&(3_u64, vec![0.1, -0.0])).expect("a plain state serializes")
    }

    #[test]
    fn what_was_packed_is_read_back() {
        let state: (u64, Vec<f64>) = unpack(&packed()).expect("just packed");
        assert_eq!(state, (3, vec![0.1, -0.0]));
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
