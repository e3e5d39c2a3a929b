//! The rows of a job, from its tables to those of the trash and back, whatever columns they have.

use super::super::database::{Builder, Connection, query_scalar};
use super::super::error::Result;

/// Every table with rows of a job, those that others hang on first, and what makes them the job's.
pub(super) const TABLES: [(&str, Of); 10] = [
    ("jobs", Of::Itself),
    ("specs", Of::Job),
    ("results", Of::Job),
    ("attempts", Of::Job),
    ("curve_blocks", Of::Attempt),
    ("log_lines", Of::Job),
    ("attempt_files", Of::Attempt),
    ("checkpoints", Of::Job),
    ("checkpoint_files", Of::Checkpoint),
    ("job_faults", Of::Job),
];

/// How a row names its job.
#[derive(Clone, Copy, Debug)]
pub(super) enum Of {
    Itself,
    Job,
    Attempt,
    Checkpoint,
}

impl Of {
    /// The condition on rows of the job `?1`, among tables of this prefix.
    fn condition(self, prefix: &str) -> String {
        match self {
            Self::Itself => "seq = ?1".to_owned(),
            Self::Job => "job = ?1".to_owned(),
            Self::Attempt => {
                format!("attempt IN (SELECT seq FROM {prefix}attempts WHERE job = ?1)")
            }
            Self::Checkpoint => {
                format!("checkpoint IN (SELECT seq FROM {prefix}checkpoints WHERE job = ?1)")
            }
        }
    }
}

const LIVING: &str = "";
const TRASHED: &str = "trashed_";

/// Copies all rows of the job to the trash.
pub(super) async fn copy_to_trash(connection: &mut Connection, job: i64) -> Result<()> {
    copy(connection, job, LIVING, TRASHED).await
}

/// Moves all rows of the job back.
pub(super) async fn bring_back(connection: &mut Connection, job: i64) -> Result<()> {
    copy(connection, job, TRASHED, LIVING).await?;
    remove(connection, job).await
}

/// Removes all rows of the job from the trash.
pub(super) async fn remove(connection: &mut Connection, job: i64) -> Result<()> {
    for (table, of) in TABLES.into_iter().rev() {
        let condition = of.condition(TRASHED);
        let statement = format!("DELETE FROM {TRASHED}{table} WHERE {condition}");
        Builder::new(&statement)
            .build()
            .bind(job)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

async fn copy(connection: &mut Connection, job: i64, from: &str, to: &str) -> Result<()> {
    for (table, of) in TABLES {
        // not those that follow from others
        let columns = connection.columns(table).await?.join(", ");
        let condition = of.condition(from);
        let statement = format!(
            "INSERT INTO {to}{table} ({columns}) SELECT {columns} FROM {from}{table} WHERE {condition}"
        );
        // names of this build's own tables and columns
        Builder::new(&statement)
            .build()
            .bind(job)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

/// SHA-256 of every file of the job in the trash.
pub(super) async fn files(connection: &mut Connection, job: i64) -> Result<Vec<String>> {
    let files = query_scalar(
        "SELECT sha256 FROM trashed_attempt_files
            WHERE attempt IN (SELECT seq FROM trashed_attempts WHERE job = ?1)
         UNION SELECT sha256 FROM trashed_checkpoints WHERE job = ?1
         UNION SELECT sha256 FROM trashed_checkpoint_files
            WHERE checkpoint IN (SELECT seq FROM trashed_checkpoints WHERE job = ?1)",
    );
    Ok(files.bind(job).fetch_all(connection).await?)
}

#[cfg(test)]
mod tests {
    use super::super::super::database::Database;
    use super::*;

    async fn fresh() -> Connection {
        let memory = Database::file(std::path::Path::new(":memory:"));
        let mut connection = memory.connect().await.expect("a database");
        connection.migrate().await.expect("migrated");
        connection
    }

    async fn columns(connection: &mut Connection, table: &str) -> Vec<String> {
        let mut columns = connection.columns(table).await.expect("its columns");
        columns.sort();
        columns
    }

    /// A migration that adds a column to a table of jobs adds it to its mirror, too.
    #[tokio::test]
    async fn a_mirror_has_the_columns_of_its_table() {
        let mut connection = fresh().await;
        for (table, _) in TABLES {
            let living = columns(&mut connection, table).await;
            let trashed = columns(&mut connection, &format!("{TRASHED}{table}")).await;
            assert!(!living.is_empty());
            assert_eq!(living, trashed, "{table}");
        }
    }

    /// Whatever goes with a job when its row is deleted is kept.
    #[tokio::test]
    async fn every_table_that_hangs_on_a_job_is_mirrored() {
        let mut connection = fresh().await;
        let hanging: Vec<String> = query_scalar(
            "SELECT DISTINCT m.name FROM sqlite_schema m, pragma_foreign_key_list(m.name) f
             WHERE m.type = 'table' AND f.on_delete = 'CASCADE' AND f.\"table\" <> 'comparisons'
             ORDER BY 1",
        )
        .fetch_all(&mut connection)
        .await
        .expect("the tables");
        let mut mirrored: Vec<&str> = TABLES.iter().map(|(table, _)| *table).skip(1).collect();
        mirrored.sort_unstable();
        assert_eq!(hanging, mirrored);
    }
}
