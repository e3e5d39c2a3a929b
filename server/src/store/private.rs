//! The data folder is its owner's alone: other users of the machine read neither results nor hashes.
use std::path::Path;

use super::error::{Result, StoreError};

/// Makes `folder` where it is missing, and closes it and the database in it to everybody else.
///
/// # Errors
/// When it cannot be made. A folder of another owner stays as it is, with a warning.
pub(super) fn private_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(StoreError::file(folder))?;
    close(folder, 0o700);
    Ok(())
}

/// Closes the files of the database, if they are there; those made later take after it.
pub(super) fn private_database(folder: &Path) {
    for name in [
        "loadframe.db",
        "loadframe.db-wal",
        "loadframe.db-shm",
        "lock",
    ] {
        let path = folder.join(name);
        if path.exists() {
            close(&path, 0o600);
        }
    }
}

#[cfg(unix)]
fn close(path: &Path, mode: u32) {
    use std::os::unix::fs::PermissionsExt;
    let closed = std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode));
    if let Err(error) = closed {
        tracing::warn!(path = %path.display(), %error, "other users of this machine may read it");
    }
}

#[cfg(not(unix))]
fn close(_: &Path, _: u32) {}
