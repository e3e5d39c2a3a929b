//! Which job a worker gets: the place that decides who works on what next.
//!
//! Jobs that wait with one priority, person, kind and need form a line, of which only the first is looked at;
//! the table of lines is kept by triggers (`0007_matched_work.sql`). Of the lines that fit the worker
//! ([`crate::queue::needs`]) those of the highest priority count, of these those of the person whose turn it
//! is ([`crate::queue::turns`]), of these the job submitted first. A job that the worker's host could not carry
//! out before comes after all others.
//!
//! A machine leaves a job for a moment to one that has at most half its memory, fits it and waits too: the
//! large one stays free for what only it can do, and the small one takes the job long before the moment is over.
use futures_util::TryStreamExt;
use loadframe_api::worker::ClaimRequest;
use uuid::Uuid;

use super::database::{FromRow, Query, Row, query, query_as, query_scalar};
use super::encoding::json;
use super::error::Result;
use super::state::LifecycleRow;
use super::writer::Change;
use crate::queue::needs::Offer;
use crate::queue::turns::{self, LEAST_COUNTED_MS, Standing};

/// How long a job is left to a smaller machine [ms].
const LEFT_FOR: i64 = 1_000;
/// A worker without a job that was seen so lately waits for one [ms]: it asks every 2 s.
const WAITING_SINCE: i64 = 5_000;
/// A machine is much larger than another from so many times its memory on.
const MUCH_LARGER: f64 = 2.0;

/// A line whose jobs fit.
#[derive(Debug)]
struct Line {
    priority: i32,
    owner: Vec<u8>,
    needs: i64,
    kind: String,
    /// Its first job.
    first: LifecycleRow,
}

impl FromRow for Line {
    fn from_row(row: &Row) -> sqlx::Result<Self> {
        Ok(Self {
            priority: row.get(row.place("priority")?)?,
            owner: row.get(row.place("owner")?)?,
            needs: row.get(row.place("needs")?)?,
            kind: row.get(row.place("kind")?)?,
            first: LifecycleRow::from_row(row)?,
        })
    }
}

impl Line {
    /// The person whose jobs they are.
    fn person(&self) -> Option<Uuid> {
        Uuid::from_slice(&self.owner).ok()
    }
}

/// A person, their use of the lab so far, when an attempt at their job began, on how many threads, and whether
/// they have a limit of running jobs.
pub(super) type Charge = (Uuid, Option<f64>, i64, i64, bool);

/// To whom an attempt is charged: a [`Charge`], if its job is somebody's.
pub(super) fn to_charge(attempt: i64) -> Query {
    let found = query(
        "SELECT p.id, p.use_level, a.started_at, a.threads, p.most_running IS NOT NULL
         FROM attempts a JOIN jobs j ON j.seq = a.job JOIN people p ON p.id = j.owner
         WHERE a.seq = ?",
    );
    found.bind(attempt)
}

/// The rows of [`Change::standings_now`].
pub(super) fn standings_of(rows: &[Row]) -> Result<Vec<Standing>> {
    let standing = |row| {
        let (person, level, most_running, running, running_core_s) = FromRow::from_row(row)?;
        Ok(Standing {
            person,
            level,
            running,
            running_core_s,
            most_running,
        })
    };
    rows.iter().map(standing).collect()
}

impl Change {
    /// The job that a worker is to have next, if one fits it.
    pub(super) async fn next_job(
        &mut self,
        worker: &ClaimRequest,
        standings: &[Standing],
    ) -> Result<Option<LifecycleRow>> {
        for with_faults in [false, true] {
            let mut lines = self.first_lines(worker, standings, with_faults).await?;
            while let Some(line) = self.take_next(&mut lines, standings) {
                if self.is_left_to_a_smaller(worker, &line).await? {
                    continue;
                }
                return Ok(Some(line.first));
            }
        }
        Ok(None)
    }

    /// Takes the line out whose turn it is.
    fn take_next(&self, lines: &mut Vec<Line>, standings: &[Standing]) -> Option<Line> {
        let candidates: Vec<_> = lines
            .iter()
            .map(|line| (line.person(), line.first.seq))
            .collect();
        let next = turns::next(&candidates, standings, self.now.as_millis());
        next.map(|index| lines.swap_remove(index))
    }

    /// Lines of the highest priority that has any for this worker.
    async fn first_lines(
        &mut self,
        worker: &ClaimRequest,
        standings: &[Standing],
        with_faults: bool,
    ) -> Result<Vec<Line>> {
        let offer = Offer::of(worker);
        let at_limit = standings.iter().filter(|standing| standing.is_at_limit());
        let at_limit: Vec<Uuid> = at_limit.map(|standing| standing.person).collect();
        // in the order of the key, so that lines of lower priorities are not even read
        let mut rows = query_as(
            "SELECT f.priority, f.owner, f.needs, f.kind,
                    j.seq, j.id, j.status, j.outcome, j.asked, j.losses, j.attempt, j.version
             FROM (SELECT l.priority, l.owner, l.needs, l.kind,
                (SELECT b.seq FROM jobs b INDEXED BY jobs_waiting_alike
                 WHERE b.status = 'queued' AND b.priority = l.priority
                    AND b.owner IS NOT DISTINCT FROM NULLIF(l.owner, x'') AND b.kind = l.kind AND b.needs = l.needs
                    AND (?1 OR NOT EXISTS (SELECT 1 FROM job_faults f
                         WHERE f.job = b.seq AND f.host = ?2))
                 ORDER BY b.seq LIMIT 1) AS head
             FROM waiting_lines l CROSS JOIN needs n
             WHERE n.id = l.needs AND l.kind IN (SELECT value FROM json_each(?3))
                AND n.memory_mb <= COALESCE(?4, n.memory_mb) AND n.disk_mb <= COALESCE(?5, n.disk_mb)
                AND n.core_s <= COALESCE(?6, n.core_s) AND n.threads <= ?7
                AND n.release <= COALESCE(?8, n.release)
                AND l.owner NOT IN (SELECT unhex(value) FROM json_each(?9))) f
                CROSS JOIN jobs j
             WHERE j.seq = f.head ORDER BY f.priority DESC",
        )
        .bind(with_faults)
        .bind(&worker.host)
        .bind(json(&offer.kinds)?)
        .bind(offer.memory_mb)
        .bind(offer.disk_mb)
        .bind(offer.core_s)
        .bind(offer.threads)
        .bind(offer.release)
        .bind(super::jobs::hex_names(&at_limit)?)
        .fetch(&mut self.connection);
        let mut lines: Vec<Line> = Vec::new();
        while let Some(line) = rows.try_next().await? {
            let line: Line = line;
            if lines
                .first()
                .is_some_and(|first| first.priority != line.priority)
            {
                break;
            }
            lines.push(line);
        }
        Ok(lines)
    }

    /// How everybody stands, see [`standings_of`]; nobody where there are no people.
    pub(super) fn standings_now(&self) -> Query {
        let standings = query(
            "SELECT p.id, p.use_level, p.most_running, COALESCE(r.jobs, 0), COALESCE(r.core_s, 0.0)
             FROM people p LEFT JOIN
                (SELECT j.owner, COUNT(*) AS jobs,
                        CAST(SUM(CASE WHEN ?1 - a.started_at > ?2 THEN ?1 - a.started_at ELSE ?2 END
                            * a.threads / 1000.0) AS DOUBLE PRECISION) AS core_s
                 FROM attempts a JOIN jobs j ON j.seq = a.job
                 WHERE a.ended_at IS NULL GROUP BY j.owner) r ON r.owner = p.id",
        );
        standings.bind(self.now.as_millis()).bind(LEAST_COUNTED_MS)
    }

    /// Whether the line's first job came just now and a much smaller machine that fits it waits, too.
    async fn is_left_to_a_smaller(&mut self, worker: &ClaimRequest, line: &Line) -> Result<bool> {
        let Some(memory_mb) = worker.memory_mb else {
            return Ok(false);
        };
        let now = self.now.as_millis();
        let is_left = query_scalar(
            "SELECT EXISTS (SELECT 1 FROM workers w JOIN needs n ON n.id = ?2
                WHERE (SELECT updated_at FROM jobs WHERE seq = ?1) > ?3
                    AND w.last_seen_at > ?4 AND w.memory_mb <= ?5 AND w.memory_mb >= n.memory_mb
                    AND w.threads >= n.threads AND COALESCE(w.disk_mb, n.disk_mb) >= n.disk_mb
                    AND COALESCE(w.release, n.release) >= n.release
                    AND (w.ends_at IS NULL OR w.ends_at - ?6 >= 1000 * n.core_s)
                    AND EXISTS (SELECT 1 FROM json_each(w.kinds) WHERE value = ?7)
                    AND NOT EXISTS (SELECT 1 FROM attempts a
                        WHERE a.worker = w.id AND a.ended_at IS NULL)
                    AND NOT EXISTS (SELECT 1 FROM machines m
                        WHERE m.host = w.host AND m.worker_name = w.name AND m.until > ?6)
                    AND NOT EXISTS (SELECT 1 FROM job_faults f
                        WHERE f.job = ?1 AND f.host = w.host))",
        )
        .bind(line.first.seq)
        .bind(line.needs)
        .bind(now - LEFT_FOR)
        .bind(now - WAITING_SINCE)
        .bind(memory_mb / MUCH_LARGER)
        .bind(now)
        .bind(&line.kind)
        .fetch_one(&mut self.connection)
        .await?;
        Ok(is_left)
    }

    /// Charges an attempt that has ended to the person whose job it was, as [`to_charge`] tells; the statement.
    pub(super) fn charge(
        &mut self,
        (person, level, started_at, threads, has_limit): Charge,
    ) -> Query {
        if has_limit {
            // another job of theirs may have waited for this alone
            self.queued();
        }
        let now = self.now.as_millis();
        let core_s = (now - started_at) as f64 / 1000.0 * threads as f64;
        query("UPDATE people SET use_level = ? WHERE id = ?")
            .bind(turns::charged(level, core_s, now))
            .bind(person)
    }
}
