//! Backup and restore: database and files, in the order that leaves nothing out.
//!
//! A backup takes the database first, as it is at one moment, and then the files that it names, each held
//! against its SHA-256. A file that was deleted in between is not missed by a database taken after it: so
//! what is missing is looked for again in a newer one. The database is put in its place last: a folder
//! without it is no backup, and one that was broken off is not taken for whole. A restore goes the same
//! way.
use std::path::Path;
use std::time::Duration;

use serde::Serialize;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};
use tempfile::NamedTempFile;

use super::blobs::{Loss, blocking, hash_of, sync_folder};
use super::error::{Result, StoreError};
use super::identity::{Mark, has_files};
use super::people::WEBHOOK_KEY;
use super::scrub::{Content, LostFile};

const DATABASE: &str = "loadframe.db";
const PARTIAL: &str = "loadframe.db.partial";
/// Newer databases that are taken when files are missing.
const ROUNDS: usize = 5;
/// How long the database may be busy.
const BUSY_TIMEOUT: Duration = Duration::from_secs(60);

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
    let database = data.join(DATABASE);
    require_database(&database)?;
    require_empty(to)?;
    let mut missing = Vec::new();
    let mut report = BackupReport::default();
    for _ in 0..ROUNDS {
        take(&database, &to.join(PARTIAL)).await?;
        report = copy_files(&to.join(PARTIAL), data, to).await?;
        if report.lost == missing {
            break;
        }
        // perhaps their jobs were deleted after the database was taken
        missing.clone_from(&report.lost);
    }
    copy_key(data, to)?;
    finish(to).await?;
    Ok(report)
}

/// Brings the backup in `from` to the empty folder `data`. Where files of the backup are missing or have
/// changed, nothing is put in place unless `even_if_incomplete`.
///
/// # Errors
/// [`StoreError::Invalid`] when it is no backup, or `data` is not empty; file and database errors.
pub async fn restore(from: &Path, data: &Path, even_if_incomplete: bool) -> Result<BackupReport> {
    let database = from.join(DATABASE);
    require_database(&database)?;
    require_empty(data)?;
    take(&database, &data.join(PARTIAL)).await?;
    let report = copy_files(&data.join(PARTIAL), from, data).await?;
    if report.lost.is_empty() || even_if_incomplete {
        copy_key(from, data)?;
        finish(data).await?;
    }
    Ok(report)
}

fn require_database(database: &Path) -> Result<()> {
    let length = std::fs::metadata(database).map_or(0, |file| file.len());
    (length > 0).then_some(()).ok_or_else(|| {
        let database = database.display();
        StoreError::Invalid(format!("{database} is missing or empty: there is no store"))
    })
}

fn require_empty(folder: &Path) -> Result<()> {
    super::private::private_folder(folder)?;
    let holds_database = folder.join(DATABASE).exists();
    if holds_database || has_files(&folder.join("blobs"))? {
        let folder = folder.display();
        let sentence = format!("{folder} holds a store, or a part of one: name an empty folder");
        return Err(StoreError::Invalid(sentence));
    }
    Ok(())
}

async fn connect(database: &Path) -> Result<SqliteConnection> {
    let options = SqliteConnectOptions::new()
        .filename(database)
        .busy_timeout(BUSY_TIMEOUT)
        .disable_statement_logging();
    Ok(options.connect().await?)
}

/// Takes the database as it is at one moment.
async fn take(database: &Path, to: &Path) -> Result<()> {
    if to.exists() {
        std::fs::remove_file(to).map_err(StoreError::file(to))?;
    }
    let mut connection = connect(database).await?;
    sqlx::query("VACUUM INTO ?")
        .bind(to.to_string_lossy().into_owned())
        .execute(&mut connection)
        .await?;
    Ok(connection.close().await?)
}

/// Copies the files that `database` names from the store in `from` to that in `to`, other than those that
/// are there.
async fn copy_files(database: &Path, from: &Path, to: &Path) -> Result<BackupReport> {
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
            match copy(&content, from, to).await? {
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

async fn copy(content: &Content, from: &Path, to: &Path) -> Result<Option<Loss>> {
    let folder = content.sha256.get(..2).unwrap_or_default();
    let [source, place] =
        [from, to].map(|data| data.join("blobs").join(folder).join(&content.sha256));
    let content = content.clone();
    blocking(&place.clone(), move || {
        if place.exists() {
            return Ok(None);
        }
        let folder = place.parent().unwrap_or(&place);
        std::fs::create_dir_all(folder)?;
        let copied = NamedTempFile::new_in(folder)?;
        match std::fs::copy(&source, copied.path()) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Some(Loss::Missing));
            }
            copied => copied?,
        };
        // the copy is what has to be right
        if hash_of(copied.path())? != (content.sha256, content.bytes.unsigned_abs()) {
            return Ok(Some(Loss::Changed));
        }
        copied.as_file().sync_all()?;
        copied.persist(&place)?;
        sync_folder(folder)?;
        Ok(None)
    })
    .await
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
async fn finish(data: &Path) -> Result<()> {
    let partial = data.join(PARTIAL);
    let mut connection = connect(&partial).await?;
    let sound: String = sqlx::query_scalar("PRAGMA integrity_check")
        .fetch_one(&mut connection)
        .await?;
    if sound != "ok" {
        return Err(StoreError::corrupt("database")(sound));
    }
    // a database of an earlier version gets its name when a server starts on it
    if let Some(mark) = Mark::of(&mut connection).await? {
        mark.write(data)?;
    }
    connection.close().await?;
    let put = || -> std::io::Result<()> {
        std::fs::File::open(&partial)?.sync_all()?;
        std::fs::rename(&partial, data.join(DATABASE))?;
        sync_folder(data)
    };
    put().map_err(StoreError::file(data))
}
