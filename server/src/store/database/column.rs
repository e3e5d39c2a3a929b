//! How a column of a row is read from either database.
use sqlx::postgres::PgRow;
use sqlx::sqlite::{Sqlite, SqliteRow};
use sqlx::{TypeInfo, ValueRef};
use uuid::Uuid;

/// A type that a column is read as.
pub(in super::super) trait Column: OfSqlite + OfPostgres {}

impl<T: OfSqlite + OfPostgres> Column for T {}

/// A type that SQLite's columns are read as.
pub(in super::super) trait OfSqlite: Sized {
    /// # Errors
    /// When there is no such column, or it holds something else.
    fn of_sqlite(row: &SqliteRow, place: usize) -> sqlx::Result<Self>;
}

impl<T> OfSqlite for T
where
    T: for<'r> sqlx::Decode<'r, Sqlite> + sqlx::Type<Sqlite>,
{
    fn of_sqlite(row: &SqliteRow, place: usize) -> sqlx::Result<Self> {
        sqlx::Row::try_get(row, place)
    }
}

/// A type that PostgreSQL's columns are read as.
pub(in super::super) trait OfPostgres: Sized {
    /// # Errors
    /// When there is no such column, or it holds something else.
    fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self>;
}

macro_rules! column {
    ($($type:ty)+) => {
        $(impl OfPostgres for $type {
            fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self> {
                sqlx::Row::try_get(row, place)
            }
        })+
    };
}

column! { f64 bool String Vec<u8> }

impl OfPostgres for i64 {
    fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self> {
        use sqlx::Row;
        // numbers that stand in a statement have 32 bits
        if row.try_get_raw(place)?.type_info().name() == "INT4" {
            return row.try_get::<i32, _>(place).map(Self::from);
        }
        row.try_get(place)
    }
}

/// A narrower number, all of which have 64 bits there.
fn narrow<T: TryFrom<i64, Error: std::error::Error + Send + Sync + 'static>>(
    row: &PgRow,
    place: usize,
) -> sqlx::Result<T> {
    T::try_from(<i64 as OfPostgres>::of_postgres(row, place)?).map_err(|error| decode(place, error))
}

fn decode(place: usize, error: impl Into<sqlx::error::BoxDynError>) -> sqlx::Error {
    sqlx::Error::ColumnDecode {
        index: place.to_string(),
        source: error.into(),
    }
}

impl OfPostgres for u32 {
    fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self> {
        narrow(row, place)
    }
}

impl OfPostgres for i32 {
    fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self> {
        narrow(row, place)
    }
}

impl OfPostgres for Uuid {
    fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self> {
        let bytes: &[u8] = sqlx::Row::try_get(row, place)?;
        Self::from_slice(bytes).map_err(|error| decode(place, error))
    }
}

impl<T: OfPostgres> OfPostgres for Option<T> {
    fn of_postgres(row: &PgRow, place: usize) -> sqlx::Result<Self> {
        if sqlx::Row::try_get_raw(row, place)?.is_null() {
            return Ok(None);
        }
        T::of_postgres(row, place).map(Some)
    }
}
