//! What is done alike with every database: a connection is held, a statement is prepared with its values and run.
use futures_util::stream::{BoxStream, StreamExt};
use sqlx::pool::PoolConnection;
use sqlx::{Arguments, Encode, Executor, IntoArguments, Pool, SqlStr, Transaction, Type};

use super::value::{Done, Row, Value};

/// How a connection is held.
#[derive(Debug)]
pub(in super::super) enum Link<D: sqlx::Database> {
    /// For itself.
    Own(D::Connection),
    /// From a pool, to which it goes back.
    Pooled(PoolConnection<D>),
    /// The same, for what the database was at one moment.
    Snapshot(Transaction<'static, D>),
}

impl<D: sqlx::Database> Link<D> {
    pub(super) fn connection(&mut self) -> &mut D::Connection {
        match self {
            Self::Own(connection) => connection,
            Self::Pooled(connection) => connection,
            Self::Snapshot(connection) => connection,
        }
    }
}

/// A database that statements are run on.
pub(in super::super) trait Backend:
    sqlx::Database<Row: Into<Row>, QueryResult: Into<Done>, Arguments: IntoArguments<Self>>
{
    /// A statement in its own words.
    fn worded(text: SqlStr) -> SqlStr;

    /// Values of the places of a statement: [`arguments`], which the compiler believes of each by itself only.
    ///
    /// # Errors
    /// When one of them cannot be written as the database wants it.
    fn arguments(values: Vec<Value>) -> sqlx::Result<Self::Arguments>;

    /// What runs statements on a connection.
    fn on(connection: &mut Self::Connection) -> impl Executor<'_, Database = Self>;

    /// What runs statements on any connection of a pool.
    fn on_any(pool: &Pool<Self>) -> impl Executor<'_, Database = Self>;
}

/// Where a statement is run.
pub(in super::super) enum On<'c, D: Backend> {
    Connection(&'c mut D::Connection),
    Pool(&'c Pool<D>),
}

type Prepared<D> = sqlx::query::Query<'static, D, <D as sqlx::Database>::Arguments>;

fn prepared<D: Backend>(text: SqlStr, values: Vec<Value>) -> sqlx::Result<Prepared<D>> {
    let arguments = D::arguments(values)?;
    Ok(sqlx::query_with(D::worded(text), arguments))
}

/// Values as the arguments of a statement.
///
/// # Errors
/// When one of them cannot be written as the database wants it.
pub(super) fn arguments<D>(values: Vec<Value>) -> sqlx::Result<D::Arguments>
where
    D: sqlx::Database,
    Option<i64>: for<'q> Encode<'q, D> + Type<D>,
    Option<f64>: for<'q> Encode<'q, D> + Type<D>,
    Option<bool>: for<'q> Encode<'q, D> + Type<D>,
    Option<String>: for<'q> Encode<'q, D> + Type<D>,
    Option<Vec<u8>>: for<'q> Encode<'q, D> + Type<D>,
{
    let mut arguments = D::Arguments::default();
    arguments.reserve(values.len(), 0);
    for value in values {
        let added = match value {
            Value::Integer(value) => arguments.add(value),
            Value::Real(value) => arguments.add(value),
            Value::Boolean(value) => arguments.add(value),
            Value::Text(value) => arguments.add(value),
            Value::Bytes(value) => arguments.add(value),
        };
        added.map_err(sqlx::Error::Encode)?;
    }
    Ok(arguments)
}

impl<D: Backend> On<'_, D> {
    pub(super) async fn execute(self, text: SqlStr, values: Vec<Value>) -> sqlx::Result<Done> {
        let statement = prepared::<D>(text, values)?;
        let done = match self {
            Self::Connection(connection) => statement.execute(D::on(connection)).await?,
            Self::Pool(pool) => statement.execute(D::on_any(pool)).await?,
        };
        Ok(done.into())
    }

    pub(super) async fn fetch_all(
        self,
        text: SqlStr,
        values: Vec<Value>,
    ) -> sqlx::Result<Vec<Row>> {
        let statement = prepared::<D>(text, values)?;
        let rows = match self {
            Self::Connection(connection) => statement.fetch_all(D::on(connection)).await?,
            Self::Pool(pool) => statement.fetch_all(D::on_any(pool)).await?,
        };
        Ok(rows.into_iter().map(Into::into).collect())
    }

    pub(super) async fn fetch_optional(
        self,
        text: SqlStr,
        values: Vec<Value>,
    ) -> sqlx::Result<Option<Row>> {
        let statement = prepared::<D>(text, values)?;
        let row = match self {
            Self::Connection(connection) => statement.fetch_optional(D::on(connection)).await?,
            Self::Pool(pool) => statement.fetch_optional(D::on_any(pool)).await?,
        };
        Ok(row.map(Into::into))
    }
}

impl<D: Backend> Link<D> {
    /// Rows one after the other.
    pub(super) fn fetch(
        &mut self,
        text: SqlStr,
        values: Vec<Value>,
    ) -> BoxStream<'_, sqlx::Result<Row>> {
        match prepared::<D>(text, values) {
            Ok(statement) => {
                let rows = statement.fetch(D::on(self.connection()));
                rows.map(|row| row.map(Into::into)).boxed()
            }
            Err(error) => futures_util::stream::iter([Err(error)]).boxed(),
        }
    }
}
