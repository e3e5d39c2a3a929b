//! Statements: a text, the values of its places, and what is made of the rows.
//!
//! Places are written as SQLite knows them, `?` one after the other or `?1` by number. Every statement is
//! prepared once a connection and kept.
use std::fmt::Display;
use std::marker::PhantomData;

use futures_util::future::BoxFuture;
use futures_util::stream::{BoxStream, TryStreamExt};
use sqlx::{AssertSqlSafe, SqlSafeStr, SqlStr};

use super::column::Column;
use super::connection::{Connection, On};
use super::value::{Bind, Done, FromRow, Row, Value};

/// A statement that is run for what it does.
#[derive(Debug)]
pub(in super::super) struct Query {
    pub(super) text: SqlStr,
    pub(super) values: Vec<Value>,
}

/// A statement whose rows are read as `R`.
#[derive(Debug)]
pub(in super::super) struct QueryAs<R>(Query, PhantomData<fn() -> R>);

/// A statement of which the first column is read, as `T`.
#[derive(Debug)]
pub(in super::super) struct QueryScalar<T>(Query, PhantomData<fn() -> T>);

pub(in super::super) fn query(text: impl SqlSafeStr) -> Query {
    Query {
        text: text.into_sql_str(),
        values: Vec::new(),
    }
}

pub(in super::super) fn query_as<R: FromRow>(text: impl SqlSafeStr) -> QueryAs<R> {
    QueryAs(query(text), PhantomData)
}

pub(in super::super) fn query_scalar<T: Column>(text: impl SqlSafeStr) -> QueryScalar<T> {
    QueryScalar(query(text), PhantomData)
}

impl Query {
    /// Binds the value of the next place.
    pub(in super::super) fn bind(mut self, value: impl Bind) -> Self {
        self.values.push(value.bound());
        self
    }

    pub(in super::super) fn execute<'c>(
        self,
        on: impl Into<On<'c>>,
    ) -> BoxFuture<'c, sqlx::Result<Done>> {
        self.execute_on(on.into())
    }

    pub(in super::super) fn fetch_all<'c>(
        self,
        on: impl Into<On<'c>>,
    ) -> BoxFuture<'c, sqlx::Result<Vec<Row>>> {
        self.fetch_all_on(on.into())
    }

    fn fetch_optional<'c>(self, on: impl Into<On<'c>>) -> BoxFuture<'c, sqlx::Result<Option<Row>>> {
        self.fetch_optional_on(on.into())
    }

    // Boxes, for what is awaited is compiled anew in every unit of code that awaits it: with the whole driver
    // below, without them.

    fn execute_on(self, on: On<'_>) -> BoxFuture<'_, sqlx::Result<Done>> {
        let Self { text, values } = self;
        match on {
            On::Sqlite(on) => Box::pin(on.execute(text, values)),
            On::Postgres(on) => Box::pin(on.execute(text, values)),
        }
    }

    fn fetch_all_on(self, on: On<'_>) -> BoxFuture<'_, sqlx::Result<Vec<Row>>> {
        let Self { text, values } = self;
        match on {
            On::Sqlite(on) => Box::pin(on.fetch_all(text, values)),
            On::Postgres(on) => Box::pin(on.fetch_all(text, values)),
        }
    }

    fn fetch_optional_on(self, on: On<'_>) -> BoxFuture<'_, sqlx::Result<Option<Row>>> {
        let Self { text, values } = self;
        match on {
            On::Sqlite(on) => Box::pin(on.fetch_optional(text, values)),
            On::Postgres(on) => Box::pin(on.fetch_optional(text, values)),
        }
    }

    /// Rows one after the other.
    pub(in super::super) fn fetch(
        self,
        connection: &mut Connection,
    ) -> BoxStream<'_, sqlx::Result<Row>> {
        let Self { text, values } = self;
        match connection {
            Connection::Sqlite(link) => link.fetch(text, values),
            Connection::Postgres(link) => link.fetch(text, values),
        }
    }
}

impl<R: FromRow> QueryAs<R> {
    /// Binds the value of the next place.
    pub(in super::super) fn bind(self, value: impl Bind) -> Self {
        Self(self.0.bind(value), PhantomData)
    }

    pub(in super::super) async fn fetch_all(self, on: impl Into<On<'_>>) -> sqlx::Result<Vec<R>> {
        let rows = self.0.fetch_all(on).await?;
        rows.iter().map(R::from_row).collect()
    }

    pub(in super::super) async fn fetch_optional(
        self,
        on: impl Into<On<'_>>,
    ) -> sqlx::Result<Option<R>> {
        let row = self.0.fetch_optional(on).await?;
        row.as_ref().map(R::from_row).transpose()
    }

    pub(in super::super) async fn fetch_one(self, on: impl Into<On<'_>>) -> sqlx::Result<R> {
        let row = self.fetch_optional(on).await?;
        row.ok_or(sqlx::Error::RowNotFound)
    }

    /// Rows one after the other, so that what is not wanted need not be read.
    pub(in super::super) fn fetch(
        self,
        connection: &mut Connection,
    ) -> impl futures_util::Stream<Item = sqlx::Result<R>> + Unpin {
        let read = |row: Row| std::future::ready(R::from_row(&row));
        self.0.fetch(connection).and_then(read)
    }
}

impl<T: Column> QueryScalar<T> {
    /// Binds the value of the next place.
    pub(in super::super) fn bind(self, value: impl Bind) -> Self {
        Self(self.0.bind(value), PhantomData)
    }

    pub(in super::super) async fn fetch_all(self, on: impl Into<On<'_>>) -> sqlx::Result<Vec<T>> {
        let rows = self.0.fetch_all(on).await?;
        rows.iter().map(|row| row.get(0)).collect()
    }

    pub(in super::super) async fn fetch_optional(
        self,
        on: impl Into<On<'_>>,
    ) -> sqlx::Result<Option<T>> {
        let row = self.0.fetch_optional(on).await?;
        row.map(|row| row.get(0)).transpose()
    }

    pub(in super::super) async fn fetch_one(self, on: impl Into<On<'_>>) -> sqlx::Result<T> {
        let value = self.fetch_optional(on).await?;
        value.ok_or(sqlx::Error::RowNotFound)
    }
}

/// A statement that is put together from parts, none of which comes from a caller.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Builder {
    text: String,
    values: Vec<Value>,
}

impl Builder {
    pub(in super::super) fn new(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            values: Vec::new(),
        }
    }

    pub(in super::super) fn push(&mut self, text: impl Display) -> &mut Self {
        use std::fmt::Write;
        // a String takes whatever is written
        let _ = write!(self.text, "{text}");
        self
    }

    /// A place, and its value.
    pub(in super::super) fn push_bind(&mut self, value: impl Bind) -> &mut Self {
        self.push_value(value.bound())
    }

    /// The same of a value that is one already.
    pub(in super::super) fn push_value(&mut self, value: Value) -> &mut Self {
        self.text.push('?');
        self.values.push(value);
        self
    }

    /// Another one, with its places and values, as it is.
    pub(in super::super) fn append(&mut self, other: Self) -> &mut Self {
        self.text.push_str(&other.text);
        self.values.extend(other.values);
        self
    }

    pub(in super::super) fn build(self) -> Query {
        Query {
            text: AssertSqlSafe(self.text).into_sql_str(),
            values: self.values,
        }
    }

    pub(in super::super) fn build_query_as<R: FromRow>(self) -> QueryAs<R> {
        QueryAs(self.build(), PhantomData)
    }

    pub(in super::super) fn build_query_scalar<T: Column>(self) -> QueryScalar<T> {
        QueryScalar(self.build(), PhantomData)
    }
}
