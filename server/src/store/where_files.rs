//! A data folder whose files are in a bucket says so, in `files.json`: a server that is started on it without
//! them, or with those of another place, is refused, and commands beside it know where they are. Keys are
//! not written down.
use std::path::Path;

use super::bucket::BucketSettings;
use super::encoding::{json, parsed};
use super::error::{Result, StoreError};
use super::types::FilesPlace;

const NOTE: &str = "files.json";

/// Where the data folder says that its files are, if not in it.
///
/// # Errors
/// When its note cannot be read.
pub(super) fn recorded(data: &Path) -> Result<Option<BucketSettings>> {
    let path = data.join(NOTE);
    match std::fs::read_to_string(&path) {
        Ok(text) => parsed(&text, "note of where the files are").map(Some),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(StoreError::file(path)(error)),
    }
}

/// Holds the place that a server is told of against the one that is written down.
///
/// # Errors
/// [`StoreError::NotTogether`] when it is another.
pub(super) fn require_same(data: &Path, place: &FilesPlace) -> Result<()> {
    let Some(known) = recorded(data)? else {
        return Ok(());
    };
    let told = match place {
        FilesPlace::Bucket(settings) if settings.is_same_place(&known) => return Ok(()),
        FilesPlace::Bucket(settings) => settings.to_string(),
        FilesPlace::Folder => "this folder".to_owned(),
    };
    let data = data.display();
    Err(StoreError::NotTogether(format!(
        "the files of {data} are in {known}, not in {told}, and nothing was touched; name that bucket with \
         --files, or, if they were moved by other means, remove {data}/{NOTE}"
    )))
}

/// Where the files are for a command beside a server, which may have been given the keys of a bucket.
///
/// # Errors
/// As [`require_same`], where a bucket is named.
pub(super) fn place_beside(data: &Path, told: FilesPlace) -> Result<FilesPlace> {
    match (told, recorded(data)?) {
        (FilesPlace::Folder, Some(known)) => Ok(FilesPlace::Bucket(known)),
        (told, _) => require_same(data, &told).map(|()| told),
    }
}

/// Writes the place down.
pub(super) fn record(data: &Path, place: &FilesPlace) -> Result<()> {
    let FilesPlace::Bucket(settings) = place else {
        return Ok(());
    };
    let (path, text) = (data.join(NOTE), json(settings)?);
    let write = || -> std::io::Result<()> {
        let mut file = tempfile::NamedTempFile::new_in(data)?;
        std::io::Write::write_all(&mut file, text.as_bytes())?;
        file.as_file().sync_all()?;
        file.persist(&path)?;
        super::disk::sync_folder(data)
    };
    write().map_err(StoreError::file(&path))
}
