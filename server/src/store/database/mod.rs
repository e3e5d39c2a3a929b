//! The one door to the database: which one it is, and how it is spoken to, is known in this folder alone.
//!
//! A [`Database`] gives a [`Connection`] for the writer and [`Pool`]s of such as only read. Statements
//! ([`statement`]) are written once, in words that every database understands, with [`value`]s of a few
//! types; where there are no such words, the texts of each are side by side in its file ([`sqlite`]) and
//! have a name here. The history of the schema: [`migrations`].
mod migrations;
mod sqlite;
mod statement;
mod value;

use std::path::Path;

use sqlx::pool::PoolConnection;
use sqlx::sqlite::{Sqlite, SqliteConnectOptions, SqliteError, SqlitePool};
use sqlx::{ConnectOptions, Transaction};
use uuid::Uuid;

use super::error::{Result, StoreError};
pub(super) use sqlite::FILE;
pub(super) use statement::{Builder, query, query_as, query_scalar};
pub(super) use value::{FromRow, Row, row};

/// Which database, and how it is reached.
#[derive(Clone, Debug)]
pub(super) enum Database {
    Sqlite(SqliteConnectOptions),
}

/// A connection, for one statement after the other.
#[derive(Debug)]
pub(super) enum Connection {
    Sqlite(Link<Sqlite>),
}

/// Connections that only read, for whoever comes.
#[derive(Clone, Debug)]
pub(super) enum Pool {
    Sqlite(SqlitePool),
}

/// Where a statement is run.
pub(super) enum On<'c> {
    Sqlite(sqlite::On<'c>),
}

/// How a connection is held.
#[derive(Debug)]
pub(super) enum Link<D: sqlx::Database> {
    /// For itself.
    Own(D::Connection),
    /// From a pool, to which it goes back.
    Pooled(PoolConnection<D>),
    /// The same, for what the database was at one moment.
    Snapshot(Transaction<'static, D>),
}

impl<D: sqlx::Database> Link<D> {
    fn connection(&mut self) -> &mut D::Connection {
        match self {
            Self::Own(connection) => connection,
            Self::Pooled(connection) => connection,
            Self::Snapshot(connection) => connection,
        }
    }
}

impl<'c> From<&'c mut Connection> for On<'c> {
    fn from(connection: &'c mut Connection) -> Self {
        match connection {
            Connection::Sqlite(link) => Self::Sqlite(sqlite::On::Connection(link.connection())),
        }
    }
}

impl<'c> From<&'c Pool> for On<'c> {
    fn from(pool: &'c Pool) -> Self {
        match pool {
            Pool::Sqlite(pool) => Self::Sqlite(sqlite::On::Pool(pool)),
        }
    }
}

impl Database {
    /// The one in a data folder, made where there is none.
    pub(super) fn in_folder(data: &Path) -> Self {
        Self::Sqlite(sqlite::in_folder(data))
    }

    /// One in a file that is there.
    pub(super) fn file(path: &Path) -> Self {
        Self::Sqlite(sqlite::file(path))
    }

    /// A connection of its own.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn connect(&self) -> Result<Connection> {
        Ok(match self {
            Self::Sqlite(database) => Connection::Sqlite(Link::Own(database.connect().await?)),
        })
    }

    /// So many connections that cannot write.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn reading(&self, connections: u32) -> Result<Pool> {
        Ok(match self {
            Self::Sqlite(database) => Pool::Sqlite(sqlite::reading(database, connections).await?),
        })
    }
}

impl Pool {
    /// A connection, until it is dropped.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn acquire(&self) -> sqlx::Result<Connection> {
        Ok(match self {
            Self::Sqlite(pool) => Connection::Sqlite(Link::Pooled(pool.acquire().await?)),
        })
    }

    /// A connection that sees the database as it is at one moment, until it is dropped.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn begin(&self) -> sqlx::Result<Connection> {
        Ok(match self {
            Self::Sqlite(pool) => Connection::Sqlite(Link::Snapshot(pool.begin().await?)),
        })
    }
}

impl Connection {
    /// Brings the schema up to date.
    ///
    /// # Errors
    /// [`StoreError::Newer`], and the database's.
    pub(super) async fn migrate(&mut self) -> Result<()> {
        let migrations = migrations::migrations();
        // `run` makes this future one that the compiler cannot see to be `Send`
        let run = match self {
            Self::Sqlite(link) => migrations.run_direct(None, link.connection(), false).await,
        };
        run.map_err(|error| migrations::newer(&migrations, error))
    }

    /// Begins a transaction that writes: nobody else writes until its end, and it sees all that was written
    /// before.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn begin_writing(&mut self) -> Result<()> {
        let text = match self {
            Self::Sqlite(_) => sqlite::BEGIN,
        };
        query(text).execute(self).await?;
        Ok(())
    }

    /// Numbers an event of the type `kind` about the job `id`, and makes that the version of the job in `row`
    /// if it is still there; earlier events of the type about it are forgotten.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn event(&mut self, row: i64, id: Uuid, kind: &str, at: i64) -> Result<i64> {
        let text = match self {
            Self::Sqlite(_) => sqlite::EVENT,
        };
        let event = query(text).bind(id).bind(kind).bind(at).bind(row);
        match self {
            Self::Sqlite(_) => Ok(event.execute(self).await?.last_number),
        }
    }

    /// Whether a job was ever submitted.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn has_had_jobs(&mut self) -> Result<bool> {
        let text = match self {
            Self::Sqlite(_) => sqlite::HAS_HAD_JOBS,
        };
        Ok(query_scalar(text).fetch_one(self).await?)
    }

    /// Columns of a table, other than those that follow from others.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn columns(&mut self, table: &str) -> Result<Vec<String>> {
        let text = match self {
            Self::Sqlite(_) => sqlite::COLUMNS,
        };
        Ok(query_scalar(text).bind(table).fetch_all(self).await?)
    }

    /// Copies the database as it is at one moment to a file.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn copy_to(&mut self, file: &Path) -> Result<()> {
        let text = match self {
            Self::Sqlite(_) => sqlite::COPY,
        };
        let name = file.to_string_lossy().into_owned();
        query(text).bind(name).execute(self).await?;
        Ok(())
    }

    /// Reads all of the database.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when it is damaged, and the database's.
    pub(super) async fn require_sound(&mut self) -> Result<()> {
        let text = match self {
            Self::Sqlite(_) => sqlite::CHECK,
        };
        let sound: String = query_scalar(text).fetch_one(self).await?;
        match sound.as_str() {
            "ok" => Ok(()),
            _ => Err(StoreError::corrupt("database")(sound)),
        }
    }

    /// Closes one of its own in order.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn close(self) -> Result<()> {
        use sqlx::Connection;
        match self {
            Self::Sqlite(Link::Own(connection)) => connection.close().await?,
            Self::Sqlite(_) => {}
        }
        Ok(())
    }
}

/// What an error says of a full disk.
pub(super) fn told_full(error: &sqlx::Error) -> Option<String> {
    let error = error.as_database_error()?;
    let of_sqlite = error.try_downcast_ref::<SqliteError>();
    of_sqlite.and_then(sqlite::told_full)
}

/// Whether the connection itself has failed: it is not there any more, or its disk does not read or write.
pub(super) fn is_broken(error: &sqlx::Error) -> bool {
    let Some(error) = error.as_database_error() else {
        return true;
    };
    let of_sqlite = error.try_downcast_ref::<SqliteError>();
    of_sqlite.is_some_and(sqlite::is_broken)
}
