//! What waits, by what it needs.
use loadframe_api::allocations::{Backlog, BacklogClass};

use super::Store;
use super::database::{query_as, query_scalar};
use super::encoding::json;
use super::error::Result;

/// Bounds of memory that jobs are sorted by: 500 MB and its doubles, up to a terabyte [MB].
const SMALLEST_CLASS: f64 = 500.0;
const CLASSES: i32 = 12;
/// Jobs that are looked at; so many waiting ones are enough to know what machines to ask for.
const MOST_JOBS: i64 = 10_000;

impl Store {
    /// How many jobs wait, and what the first of them need by their estimates. Jobs that need more than
    /// the largest class, or have no estimate, are in the largest and the smallest one.
    ///
    /// # Errors
    /// The database's.
    pub async fn backlog(&self) -> Result<Backlog> {
        let bounds: Vec<f64> = (0..CLASSES)
            .map(|doublings| SMALLEST_CLASS * 2.0_f64.powi(doublings))
            .collect();
        let mut snapshot = self.reads().begin().await?;
        let waiting: Option<i64> =
            query_scalar("SELECT CAST(SUM(jobs) AS BIGINT) FROM waiting_lines")
                .fetch_one(&mut snapshot)
                .await?;
        let classes: Vec<(f64, i64, f64, f64)> = query_as(
            "SELECT class, COUNT(*), MAX(wall), SUM(wall) FROM (
                SELECT COALESCE((SELECT MIN(CAST(value AS DOUBLE PRECISION)) FROM json_each(?1)
                                 WHERE CAST(value AS DOUBLE PRECISION) >= memory),
                                (SELECT MAX(CAST(value AS DOUBLE PRECISION)) FROM json_each(?1))) AS class, wall
                FROM (SELECT CAST(COALESCE(json_extract(estimate, '$.memory_mb'), '0') AS DOUBLE PRECISION) AS memory,
                             CAST(COALESCE(json_extract(estimate, '$.wall_s'), '0') AS DOUBLE PRECISION) AS wall
                      FROM jobs INDEXED BY jobs_by_status
                      WHERE status = 'queued' ORDER BY seq LIMIT ?2) first) sorted
             GROUP BY class ORDER BY class",
        )
        .bind(json(&bounds)?)
        .bind(MOST_JOBS)
        .fetch_all(&mut snapshot)
        .await?;
        let class =
            |(memory_mb, jobs, longest_wall_s, total_wall_s): (f64, i64, f64, f64)| BacklogClass {
                memory_mb,
                jobs: jobs.unsigned_abs(),
                longest_wall_s,
                total_wall_s,
            };
        Ok(Backlog {
            waiting: waiting.unwrap_or_default().unsigned_abs(),
            classes: classes.into_iter().map(class).collect(),
        })
    }
}
