//! Work on files and folders that may block.
use std::path::Path;

use sha2::{Digest, Sha256};

use super::error::{Result, StoreError};

/// Bytes read and written at a time.
pub(super) const CHUNK: usize = 256 << 10;

/// SHA-256 and length of a file.
pub(super) fn hash_of(path: &Path) -> std::io::Result<(String, u64)> {
    hashed(path).map(|(hash, length)| (hexadecimal(hash), length))
}

/// The same, to be gone on with.
pub(super) fn hashed(path: &Path) -> std::io::Result<(Sha256, u64)> {
    let mut file = std::fs::File::open(path)?;
    let mut hash = Sha256::new();
    let (mut chunk, mut length) = (vec![0; CHUNK], 0);
    loop {
        let count = std::io::Read::read(&mut file, &mut chunk)?;
        if count == 0 {
            return Ok((hash, length));
        }
        hash.update(&chunk[..count]);
        length += count as u64;
    }
}

pub(super) fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// Makes the names in a folder durable.
pub(super) fn sync_folder(folder: &Path) -> std::io::Result<()> {
    std::fs::File::open(folder)?.sync_all()
}

/// Runs file work where it may block.
pub(super) async fn blocking<T: Send + 'static>(
    path: &Path,
    work: impl FnOnce() -> std::io::Result<T> + Send + 'static,
) -> Result<T> {
    let done = crate::tasks::blocking(work).await?;
    done.map_err(StoreError::file(path))
}
