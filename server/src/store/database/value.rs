//! What goes into statements and comes out of their rows, in the few types that every database has.
use sqlx::postgres::PgRow;
use sqlx::sqlite::SqliteRow;
use uuid::Uuid;

use super::column::{Column, OfPostgres, OfSqlite};

/// A value that is bound to a place of a statement; `None` is null, of that type.
#[derive(Clone, Debug)]
pub(in super::super) enum Value {
    Integer(Option<i64>),
    Real(Option<f64>),
    Boolean(Option<bool>),
    Text(Option<String>),
    Bytes(Option<Vec<u8>>),
}

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Kind {
    Integer,
    Real,
    Boolean,
    Text,
    Bytes,
}

impl Value {
    /// Whether it is the same to the last bit.
    pub(in super::super) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Integer(one), Self::Integer(other)) => one == other,
            (Self::Real(one), Self::Real(other)) => {
                one.map(f64::to_bits) == other.map(f64::to_bits)
            }
            (Self::Boolean(one), Self::Boolean(other)) => one == other,
            (Self::Text(one), Self::Text(other)) => one == other,
            (Self::Bytes(one), Self::Bytes(other)) => one == other,
            _ => false,
        }
    }
}

/// What can be bound.
pub(in super::super) trait Bind {
    fn bound(self) -> Value;
    /// Nothing of this type.
    fn null() -> Value;
}

macro_rules! bind {
    ($($type:ty => $kind:ident by $convert:expr,)+) => {
        $(impl Bind for $type {
            fn bound(self) -> Value {
                let convert: fn($type) -> _ = $convert;
                Value::$kind(Some(convert(self)))
            }
            fn null() -> Value {
                Value::$kind(None)
            }
        })+
    };
}

bind! {
    i64 => Integer by |value| value,
    i32 => Integer by i64::from,
    u32 => Integer by i64::from,
    f64 => Real by |value| value,
    bool => Boolean by |value| value,
    &str => Text by str::to_owned,
    String => Text by |value| value,
    // in the order of its sixteen bytes
    Uuid => Bytes by |id| id.as_bytes().to_vec(),
    Vec<u8> => Bytes by |value| value,
}

impl<T: Bind> Bind for Option<T> {
    fn bound(self) -> Value {
        self.map_or_else(T::null, T::bound)
    }

    fn null() -> Value {
        T::null()
    }
}

impl<T: Bind + Clone> Bind for &T {
    fn bound(self) -> Value {
        self.clone().bound()
    }

    fn null() -> Value {
        T::null()
    }
}

/// A row that a statement gives back.
#[derive(Debug)]
pub(in super::super) enum Row {
    Sqlite(SqliteRow),
    Postgres(PgRow),
}

impl From<SqliteRow> for Row {
    fn from(row: SqliteRow) -> Self {
        Self::Sqlite(row)
    }
}

impl From<PgRow> for Row {
    fn from(row: PgRow) -> Self {
        Self::Postgres(row)
    }
}

impl Row {
    /// The value in a column, by its place from 0 on.
    ///
    /// # Errors
    /// When there is no such column, or it holds something else.
    pub(in super::super) fn get<T: Column>(&self, place: usize) -> sqlx::Result<T> {
        match self {
            Self::Sqlite(row) => OfSqlite::of_sqlite(row, place),
            Self::Postgres(row) => OfPostgres::of_postgres(row, place),
        }
    }

    /// The value in a column, of this type.
    ///
    /// # Errors
    /// When there is no such column, or it holds something else.
    pub(in super::super) fn value(&self, place: usize, kind: Kind) -> sqlx::Result<Value> {
        Ok(match kind {
            Kind::Integer => Value::Integer(self.get(place)?),
            Kind::Real => Value::Real(self.get(place)?),
            Kind::Boolean => Value::Boolean(self.get(place)?),
            Kind::Text => Value::Text(self.get(place)?),
            Kind::Bytes => Value::Bytes(self.get(place)?),
        })
    }

    /// The place of the column of this name.
    ///
    /// # Errors
    /// When there is none.
    pub(in super::super) fn place(&self, name: &str) -> sqlx::Result<usize> {
        use sqlx::{Column, Row};
        match self {
            Self::Sqlite(row) => Ok(row.try_column(name)?.ordinal()),
            Self::Postgres(row) => Ok(row.try_column(name)?.ordinal()),
        }
    }
}

/// The first column of rows.
///
/// # Errors
/// When there is none, or it holds something else.
pub(in super::super) fn first_column<T: Column>(rows: &[Row]) -> sqlx::Result<Vec<T>> {
    rows.iter().map(|row| row.get(0)).collect()
}

/// What a statement has done.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Done {
    pub(super) rows_affected: u64,
}

impl Done {
    /// Rows that it wrote or removed.
    pub(in super::super) fn rows_affected(self) -> u64 {
        self.rows_affected
    }
}

/// What is read from a row.
pub(in super::super) trait FromRow: Sized {
    /// # Errors
    /// When a column is missing or holds something else.
    fn from_row(row: &Row) -> sqlx::Result<Self>;
}

macro_rules! tuples {
    ($($($place:literal $type:ident)+;)+) => {
        $(impl<$($type: Column),+> FromRow for ($($type,)+) {
            fn from_row(row: &Row) -> sqlx::Result<Self> {
                Ok(($(row.get::<$type>($place)?,)+))
            }
        })+
    };
}

tuples! {
    0 A;
    0 A 1 B;
    0 A 1 B 2 C;
    0 A 1 B 2 C 3 D;
    0 A 1 B 2 C 3 D 4 E;
}

/// Declares a struct that is read from a row: each field from the column of its name.
macro_rules! row {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $name:ident {
            $($(#[$field_attribute:meta])* $field_visibility:vis $field:ident: $type:ty,)+
        }
    ) => {
        $(#[$attribute])*
        $visibility struct $name {
            $($(#[$field_attribute])* $field_visibility $field: $type,)+
        }

        impl $crate::store::database::FromRow for $name {
            fn from_row(row: &$crate::store::database::Row) -> sqlx::Result<Self> {
                Ok(Self {
                    $($field: row.get(row.place(stringify!($field))?)?,)+
                })
            }
        }
    };
}
pub(in super::super) use row;
