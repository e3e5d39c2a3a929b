//! Values of specs and results that lists are sorted and filtered by, kept in a table with indexes.
//!
//! Of all that a spec may say only those fields are kept that somebody has asked for: a list by another one
//! reads the specs of the newest jobs ([`super::search`]) and asks for the field to be kept. From then on
//! triggers keep it of every new spec and result; of the jobs before, some at a time are filled in, from the
//! newest on, by a duty beside all other work. Lists by fields that are kept of all jobs: [`lists`].
pub(super) mod condition;
pub(super) mod lists;

use std::time::Duration;

use super::database::{Connection, query, query_as, query_scalar};
use super::error::Result;
use super::pointer::{Order, Pointer, Root};
use super::search::Wanted;
use super::writer::Change;
use super::{JobFilter, Store};

/// Fields that are kept at most: each costs a submission some microseconds, and a million jobs some 50 MB.
const MOST_FIELDS: i64 = 32;
/// A field that nobody has asked for so long [ms] gives way to another.
const UNASKED: i64 = 24 * 3600 * 1000;
/// That it was asked for is written down again after so long [ms].
const ASKED_AGAIN: i64 = 3600 * 1000;
/// Jobs whose values are filled in by one change: others wait for it.
const AT_ONCE: i64 = 500;
/// Values of a field that was given up that go by one change.
const REMOVED_AT_ONCE: i64 = 5_000;
/// Whether there is something to fill in is looked at so often.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// Jobs that are looked at before a field is kept: none of them has it where it is misspelt.
const LOOKED_AT: u32 = 2_000;

/// A field that is kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptField {
    pub(super) id: i64,
    /// Of all jobs.
    pub(super) is_whole: bool,
    asked_at: i64,
}

impl Store {
    /// The kept field at the pointer, if it is one.
    pub(super) async fn kept_field(&self, pointer: &Pointer) -> Result<Option<KeptField>> {
        let row: Option<(i64, i64, i64)> =
            query_as("SELECT id, filled_from, asked_at FROM kept_fields WHERE pointer = ?")
                .bind(pointer.text())
                .fetch_optional(self.reads())
                .await?;
        let field = row.map(|(id, filled_from, asked_at)| KeptField {
            id,
            is_whole: filled_from == 0,
            asked_at,
        });
        if let Some(field) = field {
            self.note_asked(field).await;
        }
        Ok(field)
    }

    /// Whether the values at the pointer are kept of all jobs.
    ///
    /// # Errors
    /// The database's.
    pub async fn keeps_values(&self, pointer: &Pointer) -> Result<bool> {
        let field = self.kept_field(pointer).await?;
        Ok(field.is_some_and(|field| field.is_whole))
    }

    /// Writes down now and then that a field was asked for; a list does not fail for it.
    async fn note_asked(&self, field: KeptField) {
        if self.now().as_millis() - field.asked_at < ASKED_AGAIN {
            return;
        }
        let written = self.write(move |change| {
            Box::pin(async move {
                query("UPDATE kept_fields SET asked_at = ? WHERE id = ?")
                    .bind(change.now.as_millis())
                    .bind(field.id)
                    .execute(&mut change.connection)
                    .await?;
                Ok(())
            })
        });
        if let Err(error) = written.await {
            tracing::warn!(%error, "that a list was asked for could not be noted");
        }
    }

    /// Keeps the values at the pointer from now on, where the newest jobs have any and a place is free or
    /// another field was not asked for since yesterday; tells whether they are kept.
    ///
    /// # Errors
    /// The database's, [`super::StoreError::Full`] and [`super::StoreError::Unavailable`].
    pub async fn keep_values(&self, pointer: &Pointer) -> Result<bool> {
        let newest = self.numbers(&JobFilter::default(), None, LOOKED_AT).await?;
        let by_it = Wanted {
            order: Some(Order {
                pointer: pointer.clone(),
                is_falling: false,
            }),
            ..Wanted::default()
        };
        if !self.has_values(&newest, &by_it).await? {
            return Ok(false);
        }
        let pointer = pointer.clone();
        self.write(move |change| Box::pin(change.keep_values(pointer)))
            .await
    }

    /// Fills in the values of the next jobs, or removes some of a field that was given up; tells whether
    /// there may be more to do.
    ///
    /// # Errors
    /// The database's, [`super::StoreError::Full`] and [`super::StoreError::Unavailable`].
    pub async fn fill_values(&self) -> Result<bool> {
        let is_open: bool = query_scalar(
            "SELECT EXISTS (SELECT 1 FROM kept_fields WHERE pointer IS NULL OR filled_from > 0)",
        )
        .fetch_one(self.lookups())
        .await?;
        if is_open {
            self.write(|change| Box::pin(change.fill_values())).await?;
        }
        Ok(is_open)
    }

    /// Fills in the values of fields that are kept, until dropped.
    pub async fn keep_filling_values(self) {
        loop {
            let start = tokio::time::Instant::now();
            match self.fill_values().await {
                // as long as it worked, others work
                Ok(true) => tokio::time::sleep(start.elapsed()).await,
                Ok(false) => tokio::time::sleep(LOOK_EVERY).await,
                Err(error) => {
                    tracing::warn!(%error, "values for lists could not be filled in");
                    tokio::time::sleep(LOOK_EVERY).await;
                }
            }
        }
    }
}

impl Change {
    fn keep_values(&mut self, pointer: Pointer) -> super::writer::Work<'_, bool> {
        Box::pin(async move {
            let connection = &mut self.connection;
            let is_kept: bool =
                query_scalar("SELECT EXISTS (SELECT 1 FROM kept_fields WHERE pointer = ?)")
                    .bind(pointer.text())
                    .fetch_one(&mut *connection)
                    .await?;
            if is_kept {
                return Ok(true);
            }
            let fields: i64 =
                query_scalar("SELECT COUNT(*) FROM kept_fields WHERE pointer IS NOT NULL")
                    .fetch_one(&mut *connection)
                    .await?;
            let now = self.now.as_millis();
            if fields >= MOST_FIELDS && !give_one_up(connection, now - UNASKED).await? {
                return Ok(false);
            }
            let source = match pointer.root() {
                Root::Spec => "specs",
                Root::Results => "results",
            };
            query(
                "INSERT INTO kept_fields (id, pointer, source, path, filled_from, asked_at)
                 SELECT COALESCE((SELECT MAX(id) FROM kept_fields), 0) + 1, ?, ?, ?,
                    COALESCE((SELECT MAX(seq) + 1 FROM jobs), 0), ?",
            )
            .bind(pointer.text())
            .bind(source)
            .bind(pointer.path())
            .bind(now)
            .execute(connection)
            .await?;
            Ok(true)
        })
    }

    fn fill_values(&mut self) -> super::writer::Work<'_, ()> {
        Box::pin(async move {
            let connection = &mut self.connection;
            let given_up: Option<i64> = query_scalar(
                "SELECT id FROM kept_fields WHERE pointer IS NULL ORDER BY id LIMIT 1",
            )
            .fetch_optional(&mut *connection)
            .await?;
            if let Some(field) = given_up {
                return remove_some(connection, field).await;
            }
            let open: Option<(i64, i64)> = query_as(
                "SELECT id, filled_from FROM kept_fields WHERE filled_from > 0 ORDER BY id LIMIT 1",
            )
            .fetch_optional(&mut *connection)
            .await?;
            match open {
                Some((field, from)) => fill_some(connection, field, from).await,
                None => Ok(()),
            }
        })
    }
}

/// Gives the field up that was not asked for longest, if not since `before`; tells whether there was one.
async fn give_one_up(connection: &mut Connection, before: i64) -> Result<bool> {
    let given_up = query(
        "UPDATE kept_fields SET pointer = NULL WHERE id =
            (SELECT id FROM kept_fields WHERE pointer IS NOT NULL AND asked_at < ?
             ORDER BY asked_at, id LIMIT 1)",
    )
    .bind(before)
    .execute(connection)
    .await?;
    Ok(given_up.rows_affected() > 0)
}

/// Fills in the values of the jobs before number `from`, the newest of them.
async fn fill_some(connection: &mut Connection, field: i64, from: i64) -> Result<()> {
    let first: Option<i64> = query_scalar(
        "SELECT MIN(seq) FROM (SELECT seq FROM jobs WHERE seq < ? ORDER BY seq DESC LIMIT ?) n",
    )
    .bind(from)
    .bind(AT_ONCE)
    .fetch_one(&mut *connection)
    .await?;
    let first = first.unwrap_or(0);
    query(
        "INSERT INTO kept_values (field, job, number, text, is_truth)
         SELECT field, job, number, text, is_truth FROM found_values
         WHERE field = ? AND job >= ? AND job < ?
         ON CONFLICT DO NOTHING",
    )
    .bind(field)
    .bind(first)
    .bind(from)
    .execute(&mut *connection)
    .await?;
    query("UPDATE kept_fields SET filled_from = ? WHERE id = ?")
        .bind(first)
        .bind(field)
        .execute(connection)
        .await?;
    Ok(())
}

/// Removes some values of a field that was given up; with the last of them the field.
async fn remove_some(connection: &mut Connection, field: i64) -> Result<()> {
    let removed = query(
        "DELETE FROM kept_values WHERE field = ?1 AND job IN
            (SELECT job FROM kept_values WHERE field = ?1 LIMIT ?2)",
    )
    .bind(field)
    .bind(REMOVED_AT_ONCE)
    .execute(&mut *connection)
    .await?;
    if removed.rows_affected() == 0 {
        query("DELETE FROM kept_fields WHERE id = ?")
            .bind(field)
            .execute(connection)
            .await?;
    }
    Ok(())
}
