//! The one door to the database: which one it is, and how it is spoken to, is known in this folder alone.
//!
//! A [`Database`] gives a [`Connection`] for the writer and [`Pool`]s of such as only read. Statements
//! ([`statement`]) are written once, in words that every database understands, with [`value`]s of a few
//! types, and run alike ([`backend`]); where there are no such words, the texts of each are in its file
//! ([`sqlite`], [`postgres`]) and have a name here. What its errors mean: [`failures`]. The history of the schema: [`migrations`]. What servers on
//! one database tell each other, and keep each other from: [`sharing`]. What is done to a [`whole`] database:
//! copied, moved.
mod backend;
mod column;
mod failures;
mod migrations;
mod place;
mod postgres;
mod sharing;
mod sqlite;
mod statement;
mod together;
mod value;
mod whole;

use std::path::Path;

use futures_util::future::BoxFuture;
use sqlx::pool::PoolConnection;
use sqlx::postgres::{PgPool, Postgres};
use sqlx::sqlite::{Sqlite, SqliteConnectOptions, SqlitePool};
use sqlx::{ConnectOptions, Transaction};
use uuid::Uuid;

use super::error::Result;
pub(super) use failures::{is_broken, refuses_text, told_full};
pub use place::{DatabaseAddress, DatabasePlace};
pub(super) use sharing::{Held, News, Sharing, raise};
pub(super) use sqlite::FILE;
#[cfg(test)]
pub(super) use sqlite::TEXTS;
pub(super) use statement::{Builder, Query, query, query_as, query_scalar};
pub(super) use value::{FromRow, Kind, Row, first_column, row};

/// Which database, and how it is reached.
#[derive(Clone, Debug)]
pub(super) enum Database {
    Sqlite(Box<SqliteConnectOptions>),
    Postgres(DatabaseAddress),
}

/// A connection, for one statement after the other.
#[derive(Debug)]
pub(super) enum Connection {
    Sqlite(Link<Sqlite>),
    Postgres(Link<Postgres>),
}

/// Connections that only read, for whoever comes.
#[derive(Clone, Debug)]
pub(super) enum Pool {
    Sqlite(SqlitePool),
    Postgres(PgPool),
}

/// What connections read that cannot write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// Many rows, of which how many there are hangs on what is asked for.
    Lists,
    /// What is found by its name, at once.
    Lookups,
}

/// Where a statement is run.
pub(super) enum On<'c> {
    Sqlite(backend::On<'c, Sqlite>),
    Postgres(backend::On<'c, Postgres>),
}

/// What is said to each in words of its own.
#[derive(Debug)]
pub(super) struct Texts {
    /// Numbers of the newest ?6 jobs before ?1 in the projects ?2 but for those of ?4, and those of ?3 but for
    /// projects ?5; newest first, with some twice.
    pub(super) newest_seen: &'static str,
    /// The function that makes letters small.
    pub(super) folded: &'static str,
    /// In the index of texts, `job_texts t`: the column with the numbers of jobs.
    pub(super) number_of_text: &'static str,
    /// The condition on an entry of it for a text, which stands between these.
    pub(super) text_found: [&'static str; 2],
    /// Whether it leads to jobs with that text alone, so that they need not be looked at.
    pub(super) index_decides: bool,
    /// How texts of new jobs come into the index, where they do not by themselves.
    pub(super) new_texts: Option<NewTexts>,
}

/// How texts of new jobs come into the index of texts.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewTexts {
    /// Whether there are any.
    pub(super) are_there: &'static str,
    /// Takes in the next of them.
    pub(super) index_some: &'static str,
}

/// A statement that a transaction may end with, ?1 its value.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastStatement {
    pub(super) alone: &'static str,
    /// The same, and `COMMIT`.
    pub(super) and_commit: &'static str,
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
    pub(super) fn at(place: &DatabasePlace, data: &Path) -> Self {
        match place {
            DatabasePlace::Folder => Self::Sqlite(Box::new(sqlite::in_folder(data))),
            DatabasePlace::Server(address) => Self::Postgres(address.clone()),
        }
    }

    /// Whether other servers may be on it.
    pub(super) fn is_shared(&self) -> bool {
        matches!(self, Self::Postgres(_))
    }

    /// What servers on it share beside its rows.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn sharing(&self) -> Result<Sharing> {
        match self {
            Self::Sqlite(_) => Ok(Sharing::Alone),
            Self::Postgres(address) => Ok(Sharing::among(&address.0).await?),
        }
    }

    /// One in a file that is there.
    pub(super) fn file(path: &Path) -> Self {
        Self::Sqlite(Box::new(sqlite::file(path)))
    }

    /// A connection of its own.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn connect(&self) -> Result<Connection> {
        Ok(match self {
            Self::Sqlite(database) => Connection::Sqlite(Link::Own(database.connect().await?)),
            Self::Postgres(address) => {
                Connection::Postgres(Link::Own(postgres::connect(&address.0).await?))
            }
        })
    }

    /// So many connections that cannot write.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn reading(&self, connections: u32, what: Reading) -> Result<Pool> {
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
    pub(super) fn texts(&self) -> &'static Texts {
        match self {
            Self::Sqlite(_) => &sqlite::TEXTS,
            Self::Postgres(_) => &postgres::TEXTS,
        }
    }

    /// A connection, until it is dropped.
    ///
    /// # Errors
    /// The database's.
    pub(super) fn acquire(&self) -> BoxFuture<'_, sqlx::Result<Connection>> {
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
    pub(super) fn begin(&self) -> BoxFuture<'_, sqlx::Result<Connection>> {
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

impl Connection {
    /// Brings the schema up to date.
    ///
    /// # Errors
    /// [`StoreError::Newer`], and the database's.
    pub(super) async fn migrate(&mut self) -> Result<()> {
        let migrations = match self {
            Self::Sqlite(_) => migrations::of_sqlite(),
            Self::Postgres(_) => migrations::of_postgres(),
        };
        // `run` makes this future one that the compiler cannot see to be `Send`
        let run = match self {
            Self::Sqlite(link) => migrations.run_direct(None, link.connection(), false).await,
            Self::Postgres(link) => migrations.run_direct(None, link.connection(), false).await,
        };
        run.map_err(|error| migrations::newer(&migrations, error))
    }

    /// Begins a transaction that writes: nobody else writes until its end, and it sees all that was written
    /// before. Tells the moment by the database's clock [ms since 1970], where that may be another than this
    /// machine's.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn begin_writing(&mut self) -> Result<Option<i64>> {
        if let Self::Postgres(link) = self {
            return Ok(Some(postgres::begin_writing(link.connection()).await?));
        }
        query(sqlite::BEGIN).execute(self).await?;
        Ok(None)
    }

    /// [`Self::begin_writing`], with the first savepoint of the transaction.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn begin_commands(&mut self) -> Result<Option<i64>> {
        if let Self::Sqlite(_) = self {
            query(sqlite::BEGIN_COMMANDS).execute(self).await?;
            return Ok(None);
        }
        let moment = self.begin_writing().await?;
        self.run("SAVEPOINT command").await?;
        Ok(moment)
    }

    /// Ends a transaction with a last statement of one value, in one way to the database and back where it
    /// takes both at once; it stays.
    ///
    /// # Errors
    /// The database's; what was written is then undone.
    pub(super) async fn commit_with(&mut self, last: LastStatement, value: String) -> Result<()> {
        if let Self::Sqlite(_) = self {
            query(last.and_commit).bind(value).execute(self).await?;
            return Ok(());
        }
        query(last.alone).bind(value).execute(&mut *self).await?;
        self.commit().await
    }

    /// Ends a transaction; it stays.
    ///
    /// # Errors
    /// The database's; what was written is then undone.
    pub(super) async fn commit(&mut self) -> Result<()> {
        query("COMMIT").execute(self).await?;
        Ok(())
    }

    /// Runs statements without values, in one way to the database and back.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn run(&mut self, text: &'static str) -> Result<()> {
        match self {
            Self::Sqlite(_) => _ = query(text).execute(self).await?,
            Self::Postgres(link) => _ = sqlx::raw_sql(text).execute(link.connection()).await?,
        }
        Ok(())
    }

    /// Tells other servers on the database something, when the transaction stays.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn tell(&mut self, news: News) -> Result<()> {
        if let Self::Postgres(_) = self {
            let told = query(postgres::TELL).bind(news.to_string());
            told.execute(self).await?;
        }
        Ok(())
    }

    /// Numbers an event of the type `kind` about the job `id`, and makes that the version of the job if it is
    /// still there; earlier events of the type about it are forgotten. Gives the number.
    pub(super) fn event(&self, id: Uuid, kind: &str, at: i64) -> Query {
        let text = match self {
            Self::Sqlite(_) => sqlite::EVENT,
            Self::Postgres(_) => postgres::EVENT,
        };
        query(text).bind(id).bind(kind).bind(at)
    }

    /// Runs statements one after the other, in one way to the database and back where it takes them together;
    /// the rows of each.
    ///
    /// # Errors
    /// The database's; those after the one that failed are then not run.
    pub(super) fn run_all(
        &mut self,
        queries: Vec<Query>,
    ) -> BoxFuture<'_, sqlx::Result<Vec<Vec<Row>>>> {
        Box::pin(async move {
            if let Self::Sqlite(link) = self {
                return together::run(link, queries).await;
            }
            let mut rows = Vec::with_capacity(queries.len());
            for query in queries {
                rows.push(query.fetch_all(&mut *self).await?);
            }
            Ok(rows)
        })
    }

    /// Whether a job was ever submitted.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn has_had_jobs(&mut self) -> Result<bool> {
        let text = match self {
            Self::Sqlite(_) => sqlite::HAS_HAD_JOBS,
            Self::Postgres(_) => postgres::HAS_HAD_JOBS,
        };
        Ok(query_scalar(text).fetch_one(self).await?)
    }

    /// Closes one of its own in order.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn close(self) -> Result<()> {
        use sqlx::Connection;
        match self {
            Self::Sqlite(Link::Own(connection)) => connection.close().await?,
            Self::Postgres(Link::Own(connection)) => connection.close().await?,
            Self::Sqlite(_) | Self::Postgres(_) => {}
        }
        Ok(())
    }
}
