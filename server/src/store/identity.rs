//! A database and the place of its files belong together: both carry the store's name, and count the
//! servers that were started on them.
use std::path::Path;

use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::database::{Connection, FILE, query, query_as, query_scalar};
use super::encoding::{json, parsed};
use super::error::{Result, StoreError};
use super::storage::Storage;

/// Name of the note beside the files.
const MARK: &str = "store.json";

/// What lies beside the files.
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
    /// That of the place of files, if it has one.
    pub(super) async fn read(storage: &Storage) -> Result<Option<Self>> {
        match storage.note(MARK).await? {
            Some(text) => parsed(&text, "name of the folder of files").map(Some),
            None => Ok(None),
        }
    }

    /// Leaves it in the place of files.
    pub(super) async fn write(self, storage: &Storage) -> Result<()> {
        storage.leave_note(MARK, &json(&self)?).await
    }

    /// That of the database, if it has one.
    pub(super) async fn of(connection: &mut Connection) -> Result<Option<Self>> {
        let row: Option<(Uuid, i64)> = query_as("SELECT id, starts FROM store")
            .fetch_optional(connection)
            .await?;
        Ok(row.map(|(store, starts)| Self { store, starts }))
    }
}

/// Refuses to go on where no store is, which would make an empty one.
pub(super) fn require_database(database: &Path) -> Result<()> {
    let length = std::fs::metadata(database).map_or(0, |file| file.len());
    (length > 0).then_some(()).ok_or_else(|| {
        let database = database.display();
        StoreError::Invalid(format!("{database} is missing or empty: there is no store"))
    })
}

/// Refuses to make a database where there are files: theirs was lost. Nothing is written, so that it can
/// be put back.
///
/// # Errors
/// [`StoreError::NotTogether`].
pub(super) async fn refuse_new_beside_files(data: &Path, storage: &Storage) -> Result<()> {
    let length = std::fs::metadata(data.join(FILE)).map_or(0, |file| file.len());
    if length == 0 && storage.has_files().await? {
        return Err(refuse(
            data,
            storage,
            "the database is missing or empty, and there are files",
        ));
    }
    Ok(())
}

/// Holds the database in `data` against the files, and gives both a name where they have
/// none.
///
/// # Errors
/// [`StoreError::NotTogether`] when one belongs to another store, or is lost.
pub(super) async fn identify(
    connection: &mut Connection,
    data: &Path,
    storage: &Storage,
    opening: Opening,
) -> Result<Identity> {
    let folder = Mark::read(storage).await?;
    let has_files = storage.has_files().await?;
    let named = Mark::of(connection).await?;
    let own = match (named, folder) {
        (Some(own), Some(folder)) if own.store != folder.store && has_files => {
            return Err(refuse(
                data,
                storage,
                "the files are those of another database",
            ));
        }
        (Some(_), None) if has_files => {
            return Err(refuse(
                data,
                storage,
                "the files are not marked as this database's",
            ));
        }
        (Some(_), None) if names_files(connection).await? => {
            return Err(refuse(data, storage, "the files are gone"));
        }
        (Some(own), _) => own,
        // a database of an earlier version has no name yet, and a new one has had no job
        (None, _) if has_files && !connection.has_had_jobs().await? => {
            return Err(refuse(
                data,
                storage,
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
        query(
            r#"INSERT INTO store ("only", id, starts) VALUES (1, ?1, ?2)
               ON CONFLICT ("only") DO UPDATE SET id = ?1, starts = ?2"#,
        )
        .bind(mark.store)
        .bind(mark.starts)
        .execute(connection)
        .await?;
    }
    if folder != Some(mark) {
        mark.write(storage).await?;
    }
    Ok(Identity {
        is_behind: has_files && before > own.starts,
    })
}

fn refuse(data: &Path, storage: &Storage, what: &str) -> StoreError {
    let data = data.display();
    StoreError::NotTogether(format!(
        "{what}: {data}/loadframe.db and {storage} do not belong together, and nothing was touched; \
         put back the one that is missing or wrong (`loadframe restore` brings both from a backup), or \
         move both away to begin anew"
    ))
}

async fn names_files(connection: &mut Connection) -> Result<bool> {
    let names = query_scalar(
        "SELECT EXISTS (SELECT 1 FROM attempt_files) OR EXISTS (SELECT 1 FROM checkpoints)",
    );
    Ok(names.fetch_one(connection).await?)
}
