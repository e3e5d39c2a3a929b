//! The one door to the database: which one it is, and how it is spoken to, is known in this folder alone.
//!
//! A [`Database`] gives a [`Connection`] for the writer, with its [`transaction`]s, and [`Pool`]s of such as
//! only read ([`connection`]). Statements
//! ([`statement`]) are written once, in words that every database understands, with [`value`]s of a few
//! types, and run alike ([`backend`]), several at once ([`together`]); where there are no such words, the texts of each are in its file
//! ([`sqlite`], [`postgres`]) and have the names of [`own_words`]. What its errors mean: [`failures`]. The history of the schema: [`migrations`]. What servers on
//! one database tell each other, and keep each other from: [`sharing`]. What is done to a [`whole`] database:
//! copied, moved.
mod backend;
mod column;
mod connection;
mod failures;
mod migrations;
mod own_words;
mod place;
mod postgres;
mod sharing;
mod sqlite;
mod statement;
mod together;
mod transaction;
mod value;
mod whole;

pub(super) use connection::{Connection, Database, On, Pool, Reading, Undo};
pub(super) use failures::{is_broken, refuses_text, told_full};
pub(super) use own_words::{LastStatement, Texts};
pub use place::{DatabaseAddress, DatabasePlace};
pub(super) use sharing::{Held, News, Sharing, raise};
pub(super) use sqlite::FILE;
#[cfg(test)]
pub(super) use sqlite::TEXTS;
pub(super) use statement::{Builder, Query, query, query_as, query_scalar};
pub(super) use value::{FromRow, Kind, Row, first_column, row};
