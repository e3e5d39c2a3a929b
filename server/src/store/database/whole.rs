//! What is done to a whole database: it is copied, looked through, or moved to another.
use std::path::Path;

use super::super::error::{Result, StoreError};
use super::{Builder, Connection, Kind, postgres, query, query_as, query_scalar, sqlite};

impl Connection {
    /// Columns of a table, other than those that follow from others.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn columns(&mut self, table: &str) -> Result<Vec<String>> {
        let text = match self {
            Self::Sqlite(_) => sqlite::COLUMNS,
            Self::Postgres(_) => postgres::COLUMNS,
        };
        Ok(query_scalar(text).bind(table).fetch_all(self).await?)
    }

    /// Copies the database, which is in a file, as it is at one moment to another.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn copy_to(&mut self, file: &Path) -> Result<()> {
        let name = file.to_string_lossy().into_owned();
        query(sqlite::COPY).bind(name).execute(self).await?;
        Ok(())
    }

    /// Reads all of the database, which is in a file.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when it is damaged, and the database's.
    pub(in super::super) async fn require_sound(&mut self) -> Result<()> {
        let sound: String = query_scalar(sqlite::CHECK).fetch_one(self).await?;
        match sound.as_str() {
            "ok" => Ok(()),
            _ => Err(StoreError::corrupt("database")(sound)),
        }
    }

    /// Columns of a table and their types, where the database knows them exactly.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn kinds(
        &mut self,
        table: &str,
    ) -> Result<Option<Vec<(String, Kind)>>> {
        let Self::Postgres(_) = self else {
            return Ok(None);
        };
        let kinds: Vec<(String, String)> = query_as(postgres::KINDS)
            .bind(table)
            .fetch_all(self)
            .await?;
        let kinds = kinds
            .into_iter()
            .map(|(name, kind)| (name, postgres::kind(&kind)));
        Ok(Some(kinds.collect()))
    }

    /// The last number that was given out in a column of a table, if any was.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn last_number(
        &mut self,
        table: &str,
        column: &str,
    ) -> Result<Option<i64>> {
        let known: Option<i64> = match self {
            Self::Sqlite(_) => {
                let known = query_scalar("SELECT seq FROM sqlite_sequence WHERE name = ?");
                known.bind(table).fetch_optional(&mut *self).await?
            }
            Self::Postgres(_) => {
                let text = format!(
                    "SELECT CASE WHEN is_called THEN last_value END FROM {table}_{column}_seq"
                );
                let known = Builder::new(&text).build_query_scalar();
                known.fetch_one(&mut *self).await?
            }
        };
        let largest = Builder::new(&format!("SELECT MAX({column}) FROM {table}"));
        let largest: Option<i64> = largest.build_query_scalar().fetch_one(self).await?;
        Ok(known.max(largest))
    }

    /// Gives out numbers after this one from now on.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn go_on_after(
        &mut self,
        table: &str,
        column: &str,
        last: i64,
    ) -> Result<()> {
        match self {
            Self::Sqlite(_) => {
                // where there is no row, the largest number is the last
                let update = query("UPDATE sqlite_sequence SET seq = ?1 WHERE name = ?2");
                let updated = update.bind(last).bind(table).execute(&mut *self).await?;
                if updated.rows_affected() == 0 && table != "needs" {
                    let insert = query("INSERT INTO sqlite_sequence (name, seq) VALUES (?, ?)");
                    insert.bind(table).bind(last).execute(self).await?;
                }
            }
            Self::Postgres(_) => {
                let text = "SELECT setval(pg_get_serial_sequence(?1, ?2), GREATEST(?3, 1), ?3 > 0)";
                let set = query(text).bind(table).bind(column).bind(last);
                set.execute(self).await?;
            }
        }
        Ok(())
    }

    /// Takes the triggers from these tables within a transaction; gives what makes them again.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn drop_triggers(&mut self, tables: &[&str]) -> Result<Vec<String>> {
        if let Self::Postgres(_) = self {
            let turned = |word| {
                let text = move |table| format!("ALTER TABLE {table} {word} TRIGGER USER");
                tables.iter().map(text).collect::<Vec<String>>()
            };
            self.make_triggers(turned("DISABLE")).await?;
            let mut made = turned("ENABLE");
            made.push(postgres::INDEX_TEXTS.to_owned());
            return Ok(made);
        }
        let triggers: Vec<(String, String)> =
            query_as("SELECT name, sql FROM sqlite_schema WHERE type = 'trigger' ORDER BY rowid")
                .fetch_all(&mut *self)
                .await?;
        let drops = triggers
            .iter()
            .map(|(name, _)| format!("DROP TRIGGER {name}"));
        self.make_triggers(drops.collect()).await?;
        let mut made: Vec<String> = triggers.into_iter().map(|(_, text)| text).collect();
        made.push(sqlite::INDEX_TEXTS.to_owned());
        Ok(made)
    }

    /// Runs statements that [`Self::drop_triggers`] gave.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn make_triggers(&mut self, statements: Vec<String>) -> Result<()> {
        for statement in statements {
            Builder::new(&statement).build().execute(&mut *self).await?;
        }
        Ok(())
    }

    /// Brings all of a database in a file, which nobody else has open, into that file.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn settle(&mut self) -> Result<()> {
        if let Self::Sqlite(_) = self {
            query(sqlite::SETTLE).execute(self).await?;
        }
        Ok(())
    }
}
