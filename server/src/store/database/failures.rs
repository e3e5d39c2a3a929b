//! What errors of either database mean.
use sqlx::postgres::PgDatabaseError;
use sqlx::sqlite::SqliteError;

/// SQLite's codes for a full disk: `SQLITE_FULL`, and what the shared memory's file says of it.
const FULL: [&str; 2] = ["13", "4874"];
/// SQLite's connection has a disk that does not read or write: `SQLITE_IOERR`, `SQLITE_CORRUPT`, `SQLITE_NOTADB`;
/// the low byte of a code is its class.
const BROKEN: [u32; 3] = [10, 11, 26];
/// PostgreSQL's `disk_full`.
const SERVER_FULL: &str = "53100";
/// Classes of PostgreSQL's errors: the server could not be reached or is going down, its disk failed, or it has
/// ended a connection that stood still.
const SERVER_BROKEN: [&str; 4] = ["08", "57P", "58", "25P03"];
/// PostgreSQL's `character_not_in_repertoire` and `untranslatable_character`: a text holds a zero byte.
const NO_TEXT: [&str; 2] = ["22021", "22P05"];

/// What an error says of a full disk.
pub(in super::super) fn told_full(error: &sqlx::Error) -> Option<String> {
    let error = error.as_database_error()?;
    let is_full = match error.try_downcast_ref::<PgDatabaseError>() {
        Some(error) => error.code() == SERVER_FULL,
        None => {
            error.try_downcast_ref::<SqliteError>().is_some() && FULL.contains(&&*error.code()?)
        }
    };
    is_full.then(|| error.message().to_owned())
}

/// Whether it is because of a text that the database cannot keep.
pub(in super::super) fn refuses_text(error: &sqlx::Error) -> bool {
    let error = error.as_database_error();
    let of_server = error.and_then(|error| error.try_downcast_ref::<PgDatabaseError>());
    of_server.is_some_and(|error| NO_TEXT.contains(&error.code()))
}

/// Whether the connection itself has failed: it is not there any more, or its disk does not read or write.
pub(in super::super) fn is_broken(error: &sqlx::Error) -> bool {
    let Some(error) = error.as_database_error() else {
        return true;
    };
    if let Some(error) = error.try_downcast_ref::<PgDatabaseError>() {
        return SERVER_BROKEN
            .iter()
            .any(|class| error.code().starts_with(class));
    }
    let code = error.code().and_then(|code| code.parse::<u32>().ok());
    error.try_downcast_ref::<SqliteError>().is_some()
        && code.is_some_and(|code| BROKEN.contains(&(code & 0xff)))
}
