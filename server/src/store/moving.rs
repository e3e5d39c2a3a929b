//! A lab from one database to another: from the data folder to PostgreSQL, or back.
//!
//! Every row is copied as it is, what follows from others by triggers too, in one transaction of the new
//! database. Then both are read side by side in the order of their keys, and only where no value differs the
//! copy stays. Files stay where they are. No server may be on either meanwhile.
use std::path::Path;

use futures_util::TryStreamExt;
use futures_util::future::BoxFuture;
use serde::Serialize;

use super::database::{Builder, Connection, Database, DatabasePlace, FILE, Kind, query_scalar};
use super::disk::sync_folder;
use super::error::{Result, StoreError};
use super::open::lock;
use super::private::private_folder;

/// All tables, those that others refer to first, and the order of their rows.
const TABLES: [(&str, &str); 50] = [
    ("store", "\"only\""),
    ("access", "\"only\""),
    ("people", "id"),
    ("groups", "id"),
    ("members", "team, person"),
    ("projects", "id"),
    ("identities", "issuer, subject"),
    ("invitations", "id"),
    ("sessions", "id"),
    ("tokens", "id"),
    ("retention", "project"),
    ("machines", "host, worker_name"),
    ("workers", "id"),
    ("idempotency_keys", "key"),
    ("needs", "id"),
    ("jobs", "seq"),
    ("specs", "job"),
    ("results", "job"),
    ("attempts", "seq"),
    ("curve_blocks", "attempt, first"),
    ("log_lines", "job, number"),
    ("attempt_files", "attempt, name"),
    ("checkpoints", "seq"),
    ("checkpoint_files", "checkpoint, name"),
    ("job_faults", "job, attempt"),
    ("events", "seq"),
    ("job_counts", "state"),
    ("job_tags", "tag, job"),
    ("kept_fields", "id"),
    ("kept_values", "field, job"),
    ("waiting_lines", "priority, owner, kind, needs"),
    ("waiting_counts", "bits, priority, owner, block"),
    ("disk_use", "person, project, kind"),
    ("comparisons", "id"),
    ("comparison_jobs", "comparison, place"),
    ("shares", "id"),
    ("webhooks", "id"),
    ("outbox", "number"),
    ("audit", "number"),
    ("trash", "job"),
    ("trashed_jobs", "seq"),
    ("trashed_specs", "job"),
    ("trashed_results", "job"),
    ("trashed_attempts", "seq"),
    ("trashed_curve_blocks", "attempt, first"),
    ("trashed_log_lines", "job, number"),
    ("trashed_attempt_files", "attempt, name"),
    ("trashed_checkpoints", "seq"),
    ("trashed_checkpoint_files", "checkpoint, name"),
    ("trashed_job_faults", "job, attempt"),
];

/// Tables whose numbers never come again, and their columns.
const NUMBERED: [(&str, &str); 6] = [
    ("jobs", "seq"),
    ("events", "seq"),
    ("checkpoints", "seq"),
    ("audit", "number"),
    ("outbox", "number"),
    ("needs", "id"),
];

/// What was copied and compared.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MoveReport {
    /// Rows of each table that has any.
    pub tables: Vec<(&'static str, u64)>,
    pub rows: u64,
}

/// Copies the lab in `data` between the database there and the one at `to`, or from there when `back`.
///
/// # Errors
/// [`StoreError::InUse`] when a server has the folder; [`StoreError::Invalid`] when there is nothing to copy,
/// or the other one is not empty; [`StoreError::Corrupt`] when the copy differs; those of both databases.
/// Nothing is changed then.
pub fn move_store<'a>(
    data: &'a Path,
    server: &'a DatabasePlace,
    back: bool,
) -> BoxFuture<'a, Result<MoveReport>> {
    // boxed, it is compiled once and not again in everything that awaits it
    Box::pin(async move {
        private_folder(data)?;
        let _lock = lock(data, &DatabasePlace::Folder)?;
        let folder = DatabasePlace::Folder;
        let (from, to) = if back {
            (server, &folder)
        } else {
            (&folder, server)
        };
        let file = data.join(FILE);
        if back && file.exists() {
            let sentence = format!(
                "{} is there: the lab comes back to a folder without a database",
                file.display()
            );
            return Err(StoreError::Invalid(sentence));
        }
        if !back && !std::fs::metadata(&file).is_ok_and(|file| file.len() > 0) {
            let sentence = format!("{} is missing or empty: there is no lab", file.display());
            return Err(StoreError::Invalid(sentence));
        }
        let moved = copy_all(&Database::at(from, data), &Database::at(to, data)).await;
        if back && moved.is_err() {
            // what was begun is no database
            let _ = std::fs::remove_file(&file);
        }
        let report = moved?;
        if !back {
            // so that no server goes on with it
            let put_away = data.join(format!("{FILE}.moved"));
            let rename = std::fs::rename(&file, &put_away).and_then(|()| sync_folder(data));
            rename.map_err(StoreError::file(&file))?;
        }
        Ok(report)
    })
}

async fn copy_all(from: &Database, to: &Database) -> Result<MoveReport> {
    let (mut source, mut target) = (from.connect().await?, to.connect().await?);
    source.migrate().await?;
    target.migrate().await?;
    source.begin_writing().await?;
    target.begin_writing().await?;
    require_empty(&mut target).await?;
    let triggers = target
        .drop_triggers(&TABLES.map(|(table, _)| table))
        .await?;
    let mut report = MoveReport::default();
    for (table, order) in TABLES {
        let columns = columns(&mut source, &mut target, table).await?;
        Builder::new(&format!("DELETE FROM {table}"))
            .build()
            .execute(&mut target)
            .await?;
        let rows = copy(&mut source, &mut target, table, &columns).await?;
        compare(&mut source, &mut target, table, order, &columns).await?;
        if rows > 0 {
            report.tables.push((table, rows));
            report.rows += rows;
        }
    }
    for (table, column) in NUMBERED {
        if let Some(last) = source.last_number(table, column).await? {
            target.go_on_after(table, column, last).await?;
        }
    }
    target.make_triggers(triggers).await?;
    target.commit().await?;
    source.commit().await?;
    source.settle().await?;
    target.settle().await?;
    source.close().await?;
    target.close().await?;
    Ok(report)
}

async fn require_empty(target: &mut Connection) -> Result<()> {
    let is_used: bool = query_scalar(
        "SELECT EXISTS (SELECT 1 FROM jobs) OR EXISTS (SELECT 1 FROM people) OR EXISTS (SELECT 1 FROM store)
            OR EXISTS (SELECT 1 FROM trash)",
    )
    .fetch_one(target)
    .await?;
    if is_used {
        let sentence = "the other database holds a lab already: name an empty one";
        return Err(StoreError::Invalid(sentence.to_owned()));
    }
    Ok(())
}

/// Columns of a table and their types, which both databases have.
async fn columns(
    source: &mut Connection,
    target: &mut Connection,
    table: &str,
) -> Result<Vec<(String, Kind)>> {
    let kinds = match source.kinds(table).await? {
        Some(kinds) => Some(kinds),
        None => target.kinds(table).await?,
    };
    let kinds = kinds.unwrap_or_default();
    let mut names: Vec<&String> = kinds.iter().map(|(name, _)| name).collect();
    names.sort_unstable();
    for connection in [source, target] {
        let mut own = connection.columns(table).await?;
        own.sort_unstable();
        if own.iter().ne(names.iter().copied()) {
            return Err(StoreError::corrupt("schema")(format!(
                "{table} has other columns in one database than in the other"
            )));
        }
    }
    Ok(kinds)
}

fn listed(columns: &[(String, Kind)]) -> String {
    let quoted = columns.iter().map(|(name, _)| format!("\"{name}\""));
    quoted.collect::<Vec<_>>().join(", ")
}

async fn copy(
    source: &mut Connection,
    target: &mut Connection,
    table: &str,
    columns: &[(String, Kind)],
) -> Result<u64> {
    let names = listed(columns);
    let all = Builder::new(&format!("SELECT {names} FROM {table}")).build();
    let mut rows = all.fetch(source);
    let mut count = 0;
    while let Some(row) = rows.try_next().await? {
        let mut insert = Builder::new(&format!("INSERT INTO {table} ({names}) VALUES ("));
        for (place, (_, kind)) in columns.iter().enumerate() {
            if place > 0 {
                insert.push(", ");
            }
            insert.push_value(row.value(place, *kind)?);
        }
        insert.push(")");
        insert.build().execute(&mut *target).await?;
        count += 1;
    }
    Ok(count)
}

/// Reads both side by side.
async fn compare(
    source: &mut Connection,
    target: &mut Connection,
    table: &str,
    order: &str,
    columns: &[(String, Kind)],
) -> Result<()> {
    let names = listed(columns);
    let text = format!("SELECT {names} FROM {table} ORDER BY {order}");
    let mut theirs = Builder::new(&text).build().fetch(source);
    let mut ours = Builder::new(&text).build().fetch(target);
    loop {
        let (their, our) = (theirs.try_next().await?, ours.try_next().await?);
        let (their, our) = match (their, our) {
            (None, None) => return Ok(()),
            (Some(their), Some(our)) => (their, our),
            _ => return Err(differs(table, "the number of rows")),
        };
        for (place, (name, kind)) in columns.iter().enumerate() {
            let (their, our) = (their.value(place, *kind)?, our.value(place, *kind)?);
            if !their.is_same(&our) {
                return Err(differs(table, name));
            }
        }
    }
}

fn differs(table: &str, what: &str) -> StoreError {
    StoreError::corrupt("copy")(format!(
        "{what} of {table} differs from what was copied; nothing was moved"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn every_table_is_moved() {
        let memory = Database::file(Path::new(":memory:"));
        let mut connection = memory.connect().await.expect("a database");
        connection.migrate().await.expect("migrated");
        let tables: Vec<String> = query_scalar(
            "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite%'
                AND name NOT LIKE 'job_texts%' AND name <> '_sqlx_migrations' ORDER BY name",
        )
        .fetch_all(&mut connection)
        .await
        .expect("its tables");
        let mut moved = TABLES.map(|(table, _)| table);
        moved.sort_unstable();
        assert_eq!(tables, moved);
    }
}
