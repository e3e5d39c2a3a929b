//! A database and the folder of its files belong together: both carry the store's name, and count the
//! servers that were started on them.
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteConnection;
use uuid::Uuid;

use super::encoding::parsed;
use super::error::{Result, StoreError};

/// What lies in the folder of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Mark {
    pub(super) store: Uuid,
    pub(super) starts: i64,
}

/// Who opens the store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opening {
    Server,
    Beside,
}

/// How the database stands to the folder that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Identity {
    /// The database is older than the folder: one that was put back, and knows less than there is.
    pub(super) is_behind: bool,
}

impl Mark {
    fn path(data: &Path) -> PathBuf {
        data.join("blobs").join("store.json")
    }

    /// That of the folder of files in `data`, if it has one.
    pub(super) fn read(data: &Path) -> Result<Option<Self>> {
        let path = Self::path(data);
        match std::fs::read_to_string(&path) {
            Ok(text) => parsed(&text, "name of the folder of files").map(Some),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(StoreError::file(path)(error)),
        }
    }

    /// Leaves it in the folder of files in `data`.
    pub(super) fn write(self, data: &Path) -> Result<()> {
        let path = Self::path(data);
        let text = super::encoding::json(&self)?;
        let written = || -> std::io::Result<()> {
            let folder = data.join("blobs");
            std::fs::create_dir_all(&folder)?;
            let mut file = tempfile::NamedTempFile::new_in(&folder)?;
            std::io::Write::write_all(&mut file, text.as_bytes())?;
            file.as_file().sync_all()?;
            file.persist(&path)?;
            std::fs::File::open(&folder)?.sync_all()
        };
        written().map_err(StoreError::file(&path))
    }

    /// That of the database, if it has one.
    pub(super) async fn of(connection: &mut SqliteConnection) -> Result<Option<Self>> {
        let row: Option<(Uuid, i64)> = sqlx::query_as("SELECT id, starts FROM store")
            .fetch_optional(connection)
            .await?;
        Ok(row.map(|(store, starts)| Self { store, starts }))
    }
}

/// Refuses to make a database where there are files: theirs was lost. Nothing is written, so that it can
/// be put back.
///
/// # Errors
/// [`StoreError::NotTogether`].
pub(super) fn refuse_new_beside_files(data: &Path) -> Result<()> {
    let length = std::fs::metadata(data.join("loadframe.db")).map_or(0, |file| file.len());
    if length == 0 && has_files(&data.join("blobs"))? {
        return Err(refuse(
            data,
            "the database is missing or empty, and there are files",
        ));
    }
    Ok(())
}

/// Holds the database against the folder of files in `data`, and gives both a name where they have
/// none.
///
/// # Errors
/// [`StoreError::NotTogether`] when one belongs to another store, or is lost.
pub(super) async fn identify(
    connection: &mut SqliteConnection,
    data: &Path,
    opening: Opening,
) -> Result<Identity> {
    let folder = Mark::read(data)?;
    let has_files = has_files(&data.join("blobs"))?;
    let named = Mark::of(connection).await?;
    let own = match (named, folder) {
        (Some(own), Some(folder)) if own.store != folder.store && has_files => {
            return Err(refuse(data, "the files are those of another database"));
        }
        (Some(_), None) if has_files => {
            return Err(refuse(data, "the files are not marked as this database's"));
        }
        (Some(_), None) if names_files(connection).await? => {
            return Err(refuse(data, "the files are gone"));
        }
        (Some(own), _) => own,
        // a database of an earlier version has no name yet, and a new one has had no job
        (None, _) if has_files && !has_had_jobs(connection).await? => {
            return Err(refuse(
                data,
                "the database is new, or was lost, and there are files",
            ));
        }
        (None, Some(folder)) => Mark {
            starts: 0,
            ..folder
        },
        (None, None) => Mark {
            store: Uuid::new_v4(),
            starts: 0,
        },
    };
    let before = folder.filter(|folder| folder.store == own.store);
    let before = before.map_or(0, |folder| folder.starts);
    let starts = own.starts.max(before) + i64::from(opening == Opening::Server);
    let mark = Mark { starts, ..own };
    if named != Some(mark) {
        sqlx::query("INSERT OR REPLACE INTO store (only, id, starts) VALUES (1, ?, ?)")
            .bind(mark.store)
            .bind(mark.starts)
            .execute(connection)
            .await?;
    }
    if folder != Some(mark) {
        mark.write(data)?;
    }
    Ok(Identity {
        is_behind: has_files && before > own.starts,
    })
}

fn refuse(data: &Path, what: &str) -> StoreError {
    let data = data.display();
    StoreError::NotTogether(format!(
        "{what}: {data}/loadframe.db and {data}/blobs do not belong together, and nothing was touched; \
         put back the one that is missing or wrong (`loadframe restore` brings both from a backup), or \
         move both away to begin anew"
    ))
}

/// Whether any file lies there.
pub(super) fn has_files(blobs: &Path) -> Result<bool> {
    let look = || -> std::io::Result<bool> {
        for folder in std::fs::read_dir(blobs)? {
            let folder = folder?;
            if folder.file_type()?.is_dir() && std::fs::read_dir(folder.path())?.next().is_some() {
                return Ok(true);
            }
        }
        Ok(false)
    };
    match look() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(false),
        looked => looked.map_err(StoreError::file(blobs)),
    }
}

async fn names_files(connection: &mut SqliteConnection) -> Result<bool> {
    let names = sqlx::query_scalar(
        "SELECT EXISTS (SELECT 1 FROM attempt_files) OR EXISTS (SELECT 1 FROM checkpoints)",
    );
    Ok(names.fetch_one(connection).await?)
}

async fn has_had_jobs(connection: &mut SqliteConnection) -> Result<bool> {
    let had =
        sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM sqlite_sequence WHERE name = 'jobs')");
    Ok(had.fetch_one(connection).await?)
}
