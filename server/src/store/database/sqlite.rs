//! SQLite: a file in the data folder, with a write-ahead log, durable at every commit.
//!
//! What only SQLite understands is here, and in `migrations/`.
use std::path::Path;
use std::time::Duration;

use sqlx::sqlite::{
    Sqlite, SqliteArguments, SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqlitePool,
    SqlitePoolOptions, SqliteQueryResult, SqliteSynchronous,
};
use sqlx::{ConnectOptions, Executor, SqlStr};

use super::backend::{self, Backend};
use super::own_words::{NewTexts, Texts};
use super::value::{Done, Value};

/// The file of the database in its data folder.
pub(in super::super) const FILE: &str = "loadframe.db";
/// How long a statement waits for another process, such as a token command, to finish writing.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);
/// How long a copy of the database waits.
const LONG_BUSY_TIMEOUT: Duration = Duration::from_secs(60);
/// The write-ahead log is cut back to this [bytes] after a burst.
const LOG_KEPT: &str = "67108864";

/// Begins a transaction that may write.
pub(super) const BEGIN: &str = "BEGIN IMMEDIATE";
/// The same, and its first savepoint.
pub(super) const BEGIN_COMMANDS: &str = "BEGIN IMMEDIATE; SAVEPOINT command";
/// Keeps in memory what undoes a command, or from 16 changed pages on in a file of its own: making and removing
/// one takes longer than most commands, which change that many.
pub(super) const UNDO_IN_MEMORY: &str = "PRAGMA temp_store = MEMORY";
pub(super) const UNDO_IN_FILE: &str = "PRAGMA temp_store = DEFAULT";
/// Numbers an event and makes that its job's version: ?1 the job's id, ?2 the event's type, ?3 the moment.
pub(super) const EVENT: &str = "INSERT OR REPLACE INTO events (job, type, at) VALUES (?1, ?2, ?3)
     RETURNING seq;
     UPDATE jobs SET version = last_insert_rowid(), updated_at = ?3 WHERE id = ?1";
/// Whether a job was ever submitted.
pub(super) const HAS_HAD_JOBS: &str =
    "SELECT EXISTS (SELECT 1 FROM sqlite_sequence WHERE name = 'jobs')";
/// Columns of the table ?1, other than those that follow from others.
pub(super) const COLUMNS: &str = "SELECT name FROM pragma_table_info(?)";

/// Brings what is in the write-ahead log into the file.
pub(super) const SETTLE: &str = "PRAGMA wal_checkpoint(TRUNCATE)";
/// Makes the index of texts anew.
pub(super) const INDEX_TEXTS: &str = "INSERT INTO job_texts (job_texts) VALUES ('rebuild');
     UPDATE job_texts_known SET up_to = (SELECT COALESCE(MAX(seq), 0) FROM jobs)";
/// Copies the database as it is at one moment to the file ?1.
pub(super) const COPY: &str = "VACUUM INTO ?";
/// Whether all of it can be read and fits together: then `ok`.
pub(super) const CHECK: &str = "PRAGMA integrity_check";

/// Texts of its own.
pub(in super::super) const TEXTS: Texts = Texts {
    // merged by a recursion that always goes on from the largest number it has, a step of one search in an
    // index each
    newest_seen: "WITH RECURSIVE seen(project, seq) AS (
                SELECT unhex(value), (SELECT MAX(j.seq) FROM jobs j
                    WHERE j.project = unhex(value) AND j.seq < ?1 AND j.owner IS DISTINCT FROM ?4)
                FROM json_each(?2)
                UNION ALL
                SELECT NULL, (SELECT MAX(j.seq) FROM jobs j WHERE j.owner = ?3 AND j.seq < ?1
                    AND (j.project IS NULL OR j.project NOT IN (SELECT unhex(value) FROM json_each(?5))))
                UNION ALL
                SELECT project, CASE WHEN project IS NULL
                    THEN (SELECT MAX(j.seq) FROM jobs j WHERE j.owner = ?3 AND j.seq < seen.seq
                        AND (j.project IS NULL OR j.project NOT IN (SELECT unhex(value) FROM json_each(?5))))
                    ELSE (SELECT MAX(j.seq) FROM jobs j WHERE j.project = seen.project
                        AND j.seq < seen.seq AND j.owner IS DISTINCT FROM ?4) END
                FROM seen WHERE seq IS NOT NULL
                ORDER BY 2 DESC)
             SELECT seq FROM seen WHERE seq IS NOT NULL LIMIT ?6",
    folded: "lower",
    number_of_text: "t.rowid",
    // whatever is sought is one phrase
    text_found: ["job_texts MATCH '\"' || replace(", ", '\"', '\"\"') || '\"'"],
    index_decides: true,
    new_texts: Some(NewTexts {
        are_there: "SELECT COALESCE((SELECT MAX(seq) FROM jobs), 0) > up_to FROM job_texts_known",
        index_some: "INSERT INTO job_texts (rowid, name, notes, tags)
             SELECT seq, name, notes, tags FROM jobs WHERE seq > (SELECT up_to FROM job_texts_known)
             ORDER BY seq LIMIT 500;
             UPDATE job_texts_known SET up_to = COALESCE((SELECT MAX(seq) FROM
                (SELECT seq FROM jobs WHERE seq > up_to ORDER BY seq LIMIT 500)), up_to)",
    }),
};

/// The database in a data folder.
pub(super) fn in_folder(data: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(data.join(FILE))
        .create_if_missing(true)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .foreign_keys(true)
        .busy_timeout(BUSY_TIMEOUT)
        .pragma("journal_size_limit", LOG_KEPT)
        .disable_statement_logging()
}

/// A file that is there, to be copied or looked at.
pub(super) fn file(path: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(path)
        .busy_timeout(LONG_BUSY_TIMEOUT)
        .disable_statement_logging()
}

/// Connections that cannot write.
pub(super) async fn reading(
    database: &SqliteConnectOptions,
    connections: u32,
) -> sqlx::Result<SqlitePool> {
    SqlitePoolOptions::new()
        .max_connections(connections)
        .test_before_acquire(false)
        .connect_with(database.clone().pragma("query_only", "on"))
        .await
}

impl Backend for Sqlite {
    fn worded(text: SqlStr) -> SqlStr {
        text
    }

    fn arguments(values: Vec<Value>) -> sqlx::Result<SqliteArguments> {
        backend::arguments::<Self>(values)
    }

    fn on(connection: &mut SqliteConnection) -> impl Executor<'_, Database = Self> {
        connection
    }

    fn on_any(pool: &SqlitePool) -> impl Executor<'_, Database = Self> {
        pool
    }
}

impl From<SqliteQueryResult> for Done {
    fn from(done: SqliteQueryResult) -> Self {
        Self {
            rows_affected: done.rows_affected(),
        }
    }
}
