//! A job's log: its last lines, numbered over all attempts.
use loadframe_api::{LogLine, Timestamp};
use uuid::Uuid;

use super::Store;
use super::database::{query, query_as, query_scalar};
use super::encoding::json;
use super::error::Result;
use super::state::LifecycleRow;
use super::writer::Change;

/// Lines a report may bring.
pub(super) const MOST_LINES_A_REPORT: usize = 1000;
/// Lines kept of a job; older ones are in the result's log file.
const LINES_KEPT: i64 = 2000;
/// Longest line kept [characters].
const LONGEST_LINE: usize = 2000;

impl Change {
    pub(super) async fn append_log(
        &mut self,
        job: &LifecycleRow,
        attempt: u32,
        lines: &[String],
    ) -> Result<()> {
        if lines.is_empty() {
            return Ok(());
        }
        let short = |line: &String| line.chars().take(LONGEST_LINE).collect::<String>();
        let lines: Vec<String> = lines.iter().map(short).collect();
        query(
            "INSERT INTO log_lines (job, number, attempt, at, message)
             SELECT seq, log_lines + key, ?1, ?2, value FROM jobs, json_each(?3) WHERE seq = ?4",
        )
        .bind(attempt)
        .bind(self.now.as_millis())
        .bind(json(&lines)?)
        .bind(job.seq)
        .execute(&mut self.connection)
        .await?;
        let written: i64 = query_scalar(
            "UPDATE jobs SET log_lines = log_lines + ? WHERE seq = ? RETURNING log_lines",
        )
        .bind(i64::try_from(lines.len()).unwrap_or(i64::MAX))
        .bind(job.seq)
        .fetch_one(&mut self.connection)
        .await?;
        query("DELETE FROM log_lines WHERE job = ? AND number < ?")
            .bind(job.seq)
            .bind(written - LINES_KEPT)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }

    /// The last `count` lines of a job's log, oldest first.
    pub(super) async fn last_lines(&mut self, job: i64, count: u32) -> Result<Vec<String>> {
        let mut lines: Vec<String> = query_scalar(
            "SELECT message FROM log_lines WHERE job = ? ORDER BY number DESC LIMIT ?",
        )
        .bind(job)
        .bind(count)
        .fetch_all(&mut self.connection)
        .await?;
        lines.reverse();
        Ok(lines)
    }
}

impl Store {
    /// Log lines from the `since`-th on, counted from the first line of the job; of a long log
    /// only the last lines are there.
    ///
    /// # Errors
    /// [`super::StoreError::NotFound`] when there is no such job.
    pub async fn log(&self, id: Uuid, since: u64) -> Result<Vec<LogLine>> {
        let mut connection = self.reads().acquire().await?;
        let job = LifecycleRow::of(&mut connection, id).await?;
        let lines: Vec<(i64, u32, String)> = query_as(
            "SELECT at, attempt, message FROM log_lines WHERE job = ? AND number >= ?
             ORDER BY number",
        )
        .bind(job.seq)
        .bind(i64::try_from(since).unwrap_or(i64::MAX))
        .fetch_all(&mut connection)
        .await?;
        let line = |(at, attempt, message)| LogLine {
            at: Timestamp(at),
            attempt,
            message,
        };
        Ok(lines.into_iter().map(line).collect())
    }
}
