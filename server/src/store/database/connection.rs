//! Which database, and connections to it.
use std::path::Path;

use futures_util::future::BoxFuture;
use sqlx::ConnectOptions;
use sqlx::postgres::{PgPool, Postgres};
use sqlx::sqlite::{Sqlite, SqliteConnectOptions, SqlitePool};

use super::super::error::Result;
use super::backend::{self, Link};
use super::own_words::Texts;
use super::place::{DatabaseAddress, DatabasePlace};
use super::sharing::Sharing;
use super::{postgres, sqlite};

/// Which database, and how it is reached.
#[derive(Clone, Debug)]
pub(in super::super) enum Database {
    Sqlite(Box<SqliteConnectOptions>),
    Postgres(DatabaseAddress),
}

/// A connection, for one statement after the other.
#[derive(Debug)]
pub(in super::super) enum Connection {
    Sqlite(Link<Sqlite>),
    Postgres(Link<Postgres>),
}

/// Connections that only read, for whoever comes.
#[derive(Clone, Debug)]
pub(in super::super) enum Pool {
    Sqlite(SqlitePool),
    Postgres(PgPool),
}

/// What connections read that cannot write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Reading {
    /// Many rows, of which how many there are hangs on what is asked for.
    Lists,
    /// What is found by its name, at once.
    Lookups,
}

/// Where what undoes a command is kept until the command stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Undo {
    InMemory,
    InFile,
}

/// Where a statement is run.
pub(in super::super) enum On<'c> {
    Sqlite(backend::On<'c, Sqlite>),
    Postgres(backend::On<'c, Postgres>),
}

impl<'c> From<&'c mut Connection> for On<'c> {
    fn from(connection: &'c mut Connection) -> Self {
        match connection {
            Connection::Sqlite(link) => Self::Sqlite(backend::On::Connection(link.connection())),
            Connection::Postgres(link) => {
                Self::Postgres(backend::On::Connection(link.connection()))
            }
        }
    }
}

impl<'c> From<&'c Pool> for On<'c> {
    fn from(pool: &'c Pool) -> Self {
        match pool {
            Pool::Sqlite(pool) => Self::Sqlite(backend::On::Pool(pool)),
            Pool::Postgres(pool) => Self::Postgres(backend::On::Pool(pool)),
        }
    }
}

impl Database {
    /// The one at this place; in the data folder it is made where there is none.
    pub(in super::super) fn at(place: &DatabasePlace, data: &Path) -> Self {
        match place {
            DatabasePlace::Folder => Self::Sqlite(Box::new(sqlite::in_folder(data))),
            DatabasePlace::Server(address) => Self::Postgres(address.clone()),
        }
    }

    /// Whether other servers may be on it.
    pub(in super::super) fn is_shared(&self) -> bool {
        matches!(self, Self::Postgres(_))
    }

    /// What servers on it share beside its rows.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn sharing(&self) -> Result<Sharing> {
        match self {
            Self::Sqlite(_) => Ok(Sharing::Alone),
            Self::Postgres(address) => Ok(Sharing::among(&address.0).await?),
        }
    }

    /// One in a file that is there.
    pub(in super::super) fn file(path: &Path) -> Self {
        Self::Sqlite(Box::new(sqlite::file(path)))
    }

    /// A connection of its own.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn connect(&self) -> Result<Connection> {
        Ok(match self {
            Self::Sqlite(database) => Connection::Sqlite(Link::Own(database.connect().await?)),
            Self::Postgres(address) => {
                Connection::Postgres(Link::Own(postgres::connect(&address.0).await?))
            }
        })
    }

    /// A connection for commands.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn connect_for_commands(&self) -> Result<Connection> {
        let mut connection = self.connect().await?;
        connection.keep_undo(Undo::InMemory).await?;
        Ok(connection)
    }

    /// So many connections that cannot write.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn reading(&self, connections: u32, what: Reading) -> Result<Pool> {
        Ok(match self {
            Self::Sqlite(database) => Pool::Sqlite(sqlite::reading(database, connections).await?),
            Self::Postgres(address) => {
                Pool::Postgres(postgres::reading(&address.0, connections, what).await?)
            }
        })
    }
}

impl Pool {
    /// What is said to it in words of its own.
    pub(in super::super) fn texts(&self) -> &'static Texts {
        match self {
            Self::Sqlite(_) => &sqlite::TEXTS,
            Self::Postgres(_) => &postgres::TEXTS,
        }
    }

    /// A connection, until it is dropped.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) fn acquire(&self) -> BoxFuture<'_, sqlx::Result<Connection>> {
        Box::pin(async move {
            Ok(match self {
                Self::Sqlite(pool) => Connection::Sqlite(Link::Pooled(pool.acquire().await?)),
                Self::Postgres(pool) => Connection::Postgres(Link::Pooled(pool.acquire().await?)),
            })
        })
    }

    /// A connection that sees the database as it is at one moment, until it is dropped.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) fn begin(&self) -> BoxFuture<'_, sqlx::Result<Connection>> {
        Box::pin(async move {
            Ok(match self {
                Self::Sqlite(pool) => Connection::Sqlite(Link::Snapshot(pool.begin().await?)),
                Self::Postgres(pool) => {
                    let snapshot = pool.begin_with(postgres::SNAPSHOT).await?;
                    Connection::Postgres(Link::Snapshot(snapshot))
                }
            })
        })
    }
}
