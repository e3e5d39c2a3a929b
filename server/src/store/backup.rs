//! Backup and restore: database and files, in the order that leaves nothing out.
//!
//! A backup takes the database first, as it is at one moment, and then the files that it names, each held
//! against its SHA-256; from a bucket they come into the backup's folder all the same, so that a backup is
//! whole by itself. Meanwhile the server removes none, so that what is missing is lost. (A server of an earlier
//! version does remove files; those are not missed by a database taken later: so what is missing is looked for
//! again in a newer one.) The database is put in its place last: a folder
//! without it is no backup, and one that was broken off is not taken for whole. A restore goes the same
//! way.
use std::path::Path;

use futures_util::future::BoxFuture;
use serde::Serialize;
use tempfile::NamedTempFile;

use super::database::{Connection, Database, FILE as DATABASE};
use super::disk::{blocking, hash_of, sync_folder};
use super::error::{Loss, Result, StoreError};
use super::identity::{Mark, require_database};
use super::people::WEBHOOK_KEY;
use super::removal::remove_none;
use super::scrub::{Content, LostFile};
use super::storage::Storage;
use super::types::FilesPlace;
use super::where_files::{place_beside, record};

const PARTIAL: &str = "loadframe.db.partial";
/// Newer databases that are taken when files are missing.
const ROUNDS: usize = 5;

/// What was copied.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct BackupReport {
    pub files: u64,
    pub bytes: u64,
    /// Files that jobs name and that could not be copied.
    pub lost: Vec<LostFile>,
}

/// Copies the store in `data` to the empty folder `to`, while a server may be writing.
///
/// # Errors
/// [`StoreError::Invalid`] when there is no store or the folder is not empty; file and database errors.
pub async fn backup(data: &Path, to: &Path) -> Result<BackupReport> {
    backup_from(data, &FilesPlace::Folder, to).await
}

/// The same of a store whose files are at `files`; where those are in a bucket, its keys are needed.
///
/// # Errors
/// As [`backup`], and the bucket's.
pub fn backup_from<'a>(
    data: &'a Path,
    files: &'a FilesPlace,
    to: &'a Path,
) -> BoxFuture<'a, Result<BackupReport>> {
    // boxed, it is compiled once and not again in everything that awaits it
    Box::pin(async move {
        let database = data.join(DATABASE);
        require_database(&database)?;
        let files = place_beside(data, files.clone())?;
        let from = Storage::of(data, &files)?;
        let into = Storage::of(to, &FilesPlace::Folder)?;
        require_empty(to, &into).await?;
        let nothing_goes = remove_none(data).await?;
        let mut missing = Vec::new();
        let mut report = BackupReport::default();
        for _ in 0..ROUNDS {
            take(&database, &to.join(PARTIAL)).await?;
            report = copy_files(&to.join(PARTIAL), &from, &into, to).await?;
            if report.lost == missing {
                break;
            }
            // perhaps their jobs were deleted after the database was taken
            missing.clone_from(&report.lost);
        }
        drop(nothing_goes);
        copy_key(data, to)?;
        finish(to, &into).await?;
        Ok(report)
    })
}

/// Brings the backup in `from` to the empty folder `data`. Where files of the backup are missing or have
/// changed, nothing is put in place unless `even_if_incomplete`.
///
/// # Errors
/// [`StoreError::Invalid`] when it is no backup, or `data` is not empty; file and database errors.
pub async fn restore(from: &Path, data: &Path, even_if_incomplete: bool) -> Result<BackupReport> {
    restore_to(from, data, &FilesPlace::Folder, even_if_incomplete).await
}

/// The same, with the files brought to `files`, which holds none yet.
///
/// # Errors
/// As [`restore`], and the bucket's.
pub fn restore_to<'a>(
    from: &'a Path,
    data: &'a Path,
    files: &'a FilesPlace,
    even_if_incomplete: bool,
) -> BoxFuture<'a, Result<BackupReport>> {
    // boxed, it is compiled once and not again in everything that awaits it
    Box::pin(async move {
        let database = from.join(DATABASE);
        require_database(&database)?;
        let backed_up = Storage::of(from, &FilesPlace::Folder)?;
        let into = Storage::of(data, files)?;
        require_empty(data, &into).await?;
        take(&database, &data.join(PARTIAL)).await?;
        let report = copy_files(&data.join(PARTIAL), &backed_up, &into, data).await?;
        if report.lost.is_empty() || even_if_incomplete {
            copy_key(from, data)?;
            record(data, files)?;
            finish(data, &into).await?;
        }
        Ok(report)
    })
}

async fn require_empty(folder: &Path, files: &Storage) -> Result<()> {
    super::private::private_folder(folder)?;
    let what = if folder.join(DATABASE).exists() {
        folder.display().to_string()
    } else if files.has_files().await? {
        files.to_string()
    } else {
        return Ok(());
    };
    let sentence = format!("{what} holds a store, or a part of one: name an empty folder");
    Err(StoreError::Invalid(sentence))
}

async fn connect(database: &Path) -> Result<Connection> {
    Database::file(database).connect().await
}

/// Takes the database as it is at one moment.
async fn take(database: &Path, to: &Path) -> Result<()> {
    if to.exists() {
        std::fs::remove_file(to).map_err(StoreError::file(to))?;
    }
    let mut connection = connect(database).await?;
    connection.copy_to(to).await?;
    connection.close().await
}

/// Copies the files that `database` names, other than those that are there; on their way to a bucket they
/// lie in the folder `data`.
async fn copy_files(
    database: &Path,
    from: &Storage,
    to: &Storage,
    data: &Path,
) -> Result<BackupReport> {
    let mut connection = connect(database).await?;
    let mut report = BackupReport::default();
    let mut last = String::new();
    loop {
        let contents = Content::after(&mut connection, &last).await?;
        let Some(end) = contents.last() else {
            break;
        };
        last.clone_from(&end.sha256);
        for content in contents {
            match copy(&content, from, to, data).await? {
                None => {
                    report.files += 1;
                    report.bytes += content.bytes.unsigned_abs();
                }
                Some(loss) => report
                    .lost
                    .extend(content.lost(&mut connection, loss).await?),
            }
        }
    }
    connection.close().await?;
    Ok(report)
}

async fn copy(
    content: &Content,
    from: &Storage,
    to: &Storage,
    data: &Path,
) -> Result<Option<Loss>> {
    let (sha256, bytes) = (content.sha256.clone(), content.bytes.unsigned_abs());
    if let Some(found) = to.look(&sha256).await?
        && found.bytes == bytes
    {
        return Ok(None);
    }
    let staging = match to {
        Storage::Folder(folder) => folder.staging(&sha256)?,
        Storage::Bucket(_) => data.to_owned(),
    };
    let copied = NamedTempFile::new_in(&staging).map_err(StoreError::file(&staging))?;
    let copied = copied.into_temp_path();
    if !from.copy_to(&sha256, &copied).await? {
        return Ok(Some(Loss::Missing));
    }
    let expected = (sha256.clone(), bytes);
    let checked = blocking(&staging, move || {
        // the copy is what has to be right
        if hash_of(&copied)? != expected {
            return Ok(None);
        }
        std::fs::File::open(&copied)?.sync_all()?;
        Ok(Some(copied))
    });
    let Some(copied) = checked.await? else {
        return Ok(Some(Loss::Changed));
    };
    match to {
        Storage::Folder(folder) => folder.place(&sha256, copied).await?,
        Storage::Bucket(bucket) => bucket.place_file(&sha256, bytes, &copied).await?,
    }
    Ok(None)
}

/// Copies the key that secrets of webhooks follow from, where there is one.
fn copy_key(from: &Path, to: &Path) -> Result<()> {
    let [source, place] = [from, to].map(|data| data.join(WEBHOOK_KEY));
    match std::fs::copy(&source, &place) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        copied => copied.map(|_| ()).map_err(StoreError::file(&source)),
    }
}

/// Marks the files as the database's, and puts the database in its place.
async fn finish(data: &Path, files: &Storage) -> Result<()> {
    let partial = data.join(PARTIAL);
    let mut connection = connect(&partial).await?;
    connection.require_sound().await?;
    // a database of an earlier version gets its name when a server starts on it
    if let Some(mark) = Mark::of(&mut connection).await? {
        mark.write(files).await?;
    }
    connection.close().await?;
    let put = || -> std::io::Result<()> {
        std::fs::File::open(&partial)?.sync_all()?;
        std::fs::rename(&partial, data.join(DATABASE))?;
        sync_folder(data)
    };
    put().map_err(StoreError::file(data))
}
