//! What is done on a connection that writes: the schema, transactions, and what each database has its own
//! words for.
use futures_util::future::BoxFuture;
use uuid::Uuid;

use super::super::error::Result;
use super::backend::Link;
use super::connection::{Connection, Undo};
use super::own_words::LastStatement;
use super::sharing::News;
use super::statement::{Query, query, query_scalar};
use super::value::Row;
use super::{migrations, postgres, sqlite, together};

impl Connection {
    /// Brings the schema up to date.
    ///
    /// # Errors
    /// [`StoreError::Newer`], and the database's.
    pub(in super::super) async fn migrate(&mut self) -> Result<()> {
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
    pub(in super::super) async fn begin_writing(&mut self) -> Result<Option<i64>> {
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
    pub(in super::super) async fn begin_commands(&mut self) -> Result<Option<i64>> {
        if let Self::Sqlite(_) = self {
            query(sqlite::BEGIN_COMMANDS).execute(self).await?;
            return Ok(None);
        }
        let moment = self.begin_writing().await?;
        self.run("SAVEPOINT command").await?;
        Ok(moment)
    }

    /// Says where what undoes a command is to be kept in the transactions that begin from now on: in memory, or,
    /// for what changes very many rows, in a file.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn keep_undo(&mut self, undo: Undo) -> Result<()> {
        if let Self::Sqlite(_) = self {
            let text = match undo {
                Undo::InMemory => sqlite::UNDO_IN_MEMORY,
                Undo::InFile => sqlite::UNDO_IN_FILE,
            };
            query(text).execute(self).await?;
        }
        Ok(())
    }

    /// Ends a transaction with a last statement of one value, in one way to the database and back where it
    /// takes both at once; it stays.
    ///
    /// # Errors
    /// The database's; what was written is then undone.
    pub(in super::super) async fn commit_with(
        &mut self,
        last: LastStatement,
        value: String,
    ) -> Result<()> {
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
    pub(in super::super) async fn commit(&mut self) -> Result<()> {
        query("COMMIT").execute(self).await?;
        Ok(())
    }

    /// Runs statements without values, in one way to the database and back.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn run(&mut self, text: &'static str) -> Result<()> {
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
    pub(in super::super) async fn tell(&mut self, news: News) -> Result<()> {
        if let Self::Postgres(_) = self {
            let told = query(postgres::TELL).bind(news.to_string());
            told.execute(self).await?;
        }
        Ok(())
    }

    /// Numbers an event of the type `kind` about the job `id`, and makes that the version of the job if it is
    /// still there; earlier events of the type about it are forgotten. Gives the number.
    pub(in super::super) fn event(&self, id: Uuid, kind: &str, at: i64) -> Query {
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
    pub(in super::super) fn run_all(
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
    pub(in super::super) async fn has_had_jobs(&mut self) -> Result<bool> {
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
    pub(in super::super) async fn close(self) -> Result<()> {
        use sqlx::Connection;
        match self {
            Self::Sqlite(Link::Own(connection)) => connection.close().await?,
            Self::Postgres(Link::Own(connection)) => connection.close().await?,
            Self::Sqlite(_) | Self::Postgres(_) => {}
        }
        Ok(())
    }
}
