//! What a worker reports while it holds a lease: that it is alive, how far it is, what it computed.
use loadframe_api::worker::{Command, ProgressReport};
use uuid::Uuid;

use super::database::{Connection, FromRow, Query, Row, query, query_as, row};
use super::encoding::json;
use super::error::{Result, StoreError};
use super::state::LifecycleRow;
use super::writer::{Change, EventType};
use super::{LeaseKey, Store, log};
use crate::queue::UserRequest;

/// Longest phase [characters].
const LONGEST_PHASE: usize = 500;

row! {
    /// An attempt under its lease.
    #[derive(Debug)]
    pub(super) struct LeasedAttempt {
        /// The attempt's row.
        pub(super) seq: i64,
        pub(super) token: Uuid,
        pub(super) number: u32,
        pub(super) worker_name: String,
        pub(super) host: String,
        /// The build of the worker.
        pub(super) engine: String,
        pub(super) ended_at: Option<i64>,
        pub(super) ended_by: Option<String>,
        pub(super) columns: String,
        pub(super) points: i64,
        /// Log lines its worker has brought.
        log_lines: i64,
        /// The job's id.
        pub(super) job: Uuid,
    }
}

/// The attempt ?1 with the token ?2.
const FOUND: &str = "SELECT a.seq, a.token, a.number, a.worker_name, a.host, a.engine, a.ended_at,
        a.ended_by, a.columns, a.points, a.log_lines, j.id AS job
     FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.id = ?1 AND a.token = ?2";
/// The job of the attempt ?1 with the token ?2.
const JOB: &str = "SELECT j.seq, j.id, j.status, j.outcome, j.asked, j.losses, j.attempt, j.version
     FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.id = ?1 AND a.token = ?2";

impl LeasedAttempt {
    /// The attempt whose id and token `key` has, live or ended.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when there is none.
    pub(super) async fn find(connection: &mut Connection, key: LeaseKey) -> Result<Self> {
        query_as(FOUND)
            .bind(key.id)
            .bind(key.token)
            .fetch_optional(connection)
            .await?
            .ok_or(StoreError::LeaseLost)
    }

    /// [`Self::find`], with its job.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when there is none.
    pub(super) async fn with_job(
        connection: &mut Connection,
        key: LeaseKey,
    ) -> Result<(Self, LifecycleRow)> {
        let statements = vec![attempt_of(key), job_of(key)];
        leased(&connection.run_all(statements).await?, 1)
    }

    /// The attempt, if it is live.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when it is not.
    pub(super) async fn live(connection: &mut Connection, key: LeaseKey) -> Result<Self> {
        let attempt = Self::find(connection, key).await?;
        if attempt.ended_at.is_none() {
            Ok(attempt)
        } else {
            Err(StoreError::LeaseLost)
        }
    }
}

pub(super) fn attempt_of(key: LeaseKey) -> Query {
    query(FOUND).bind(key.id).bind(key.token)
}

pub(super) fn job_of(key: LeaseKey) -> Query {
    query(JOB).bind(key.id).bind(key.token)
}

/// An attempt from the first of `rows`, and its job from those in this place.
pub(super) fn leased(rows: &[Vec<Row>], job: usize) -> Result<(LeasedAttempt, LifecycleRow)> {
    let first = |place: usize| rows.get(place).and_then(|rows| rows.first());
    let (Some(attempt), Some(job)) = (first(0), first(job)) else {
        return Err(StoreError::LeaseLost);
    };
    Ok((
        LeasedAttempt::from_row(attempt)?,
        LifecycleRow::from_row(job)?,
    ))
}

impl Change {
    /// Extends a live lease, and notes that its worker is there; the attempt and its job.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when the lease is not held.
    pub(super) async fn extend(
        &mut self,
        key: LeaseKey,
        lease: i64,
    ) -> Result<(LeasedAttempt, LifecycleRow)> {
        let (attempt, job, _) = self.extend_and(key, lease, Vec::new()).await?;
        Ok((attempt, job))
    }

    /// [`Self::extend`], and in the same go `then`, which does nothing where the lease is not held; the rows of each
    /// statement of it.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when the lease is not held.
    pub(super) async fn extend_and(
        &mut self,
        key: LeaseKey,
        lease: i64,
        then: impl IntoIterator<Item = Query>,
    ) -> Result<(LeasedAttempt, LifecycleRow, Vec<Vec<Row>>)> {
        let extended = query(
            "UPDATE attempts SET lease_until = ?, heard = TRUE
             WHERE id = ? AND token = ? AND ended_at IS NULL
             RETURNING seq, token, number, worker_name, host, engine, ended_at, ended_by,
                       columns, points, log_lines,
                       (SELECT id FROM jobs WHERE jobs.seq = attempts.job) AS job",
        )
        .bind(self.now.as_millis() + lease)
        .bind(key.id)
        .bind(key.token);
        let mut statements = vec![extended, self.worker_heard(key), job_of(key)];
        let place = statements.len();
        statements.extend(then);
        let mut rows = self.connection.run_all(statements).await?;
        let (attempt, job) = leased(&rows, 2)?;
        Ok((attempt, job, rows.split_off(place)))
    }

    async fn report(
        &mut self,
        key: LeaseKey,
        lease: i64,
        report: &ProgressReport,
    ) -> Result<Command> {
        let (attempt, job) = self.extend(key, lease).await?;
        query("UPDATE jobs SET progress = ?, phase = ?, eta_s = ? WHERE seq = ?")
            .bind(report.progress)
            .bind(&report.phase)
            .bind(report.eta_s)
            .bind(job.seq)
            .execute(&mut self.connection)
            .await?;
        if let Some(block) = &report.points
            && self.append_points(&attempt, block).await?
        {
            self.event(job.id, EventType::Points).await?;
        }
        self.append_report(&job, &attempt, report).await?;
        self.event(job.id, EventType::Progress).await?;
        Ok(UserRequest::command(job.asked()?))
    }
}

impl Change {
    /// Takes in the log lines of a report that the server has not yet.
    async fn append_report(
        &mut self,
        job: &LifecycleRow,
        attempt: &LeasedAttempt,
        report: &ProgressReport,
    ) -> Result<()> {
        let known = attempt.log_lines.unsigned_abs();
        let from = report.log_from.unwrap_or(known);
        let repeated = usize::try_from(known.saturating_sub(from)).unwrap_or(usize::MAX);
        let Some(lines) = report.log.get(repeated..).filter(|lines| !lines.is_empty()) else {
            return Ok(());
        };
        let known = from.saturating_add(report.log.len() as u64);
        query("UPDATE attempts SET log_lines = ? WHERE seq = ?")
            .bind(i64::try_from(known).unwrap_or(i64::MAX))
            .bind(attempt.seq)
            .execute(&mut self.connection)
            .await?;
        self.append_log(job, attempt.number, lines).await
    }
}

impl Store {
    /// Takes in progress, curve points and log lines; counts as a heartbeat.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when the lease is not held, [`StoreError::Invalid`] when the
    /// report leaves a gap in the curve or has values out of their range.
    pub async fn report(&self, key: LeaseKey, report: &ProgressReport) -> Result<Command> {
        check(report)?;
        let (lease, report) = (self.lease_millis(), report.clone());
        self.write(move |change| Box::pin(async move { change.report(key, lease, &report).await }))
            .await
    }
}

fn check(report: &ProgressReport) -> Result<()> {
    let invalid = |sentence: &str| Err(StoreError::Invalid(sentence.to_owned()));
    if !(0.0..=1.0).contains(&report.progress) {
        return invalid("progress is between 0 and 1");
    }
    if report.eta_s.is_some_and(|eta| eta.is_nan() || eta < 0.0) {
        return invalid("eta_s is not negative");
    }
    if report.phase.chars().count() > LONGEST_PHASE {
        return invalid("phase has at most 500 characters");
    }
    if report.log.len() > log::MOST_LINES_A_REPORT {
        return invalid("log has at most 1000 lines a report");
    }
    Ok(())
}

impl Store {
    /// Extends the lease and tells what the user wants of the attempt. The first heartbeat of an attempt is
    /// written down at once: whatever the job does to its worker from then on counts.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when the lease is not held.
    pub async fn heartbeat(&self, key: LeaseKey) -> Result<Command> {
        let live: Option<(i64, bool, Option<String>)> = query_as(
            "SELECT a.seq, a.heard, j.asked FROM attempts a JOIN jobs j ON j.seq = a.job
             WHERE a.id = ? AND a.token = ? AND a.ended_at IS NULL",
        )
        .bind(key.id)
        .bind(key.token)
        .fetch_optional(self.lookups())
        .await?;
        let (attempt, heard, asked) = live.ok_or(StoreError::LeaseLost)?;
        if heard {
            let asked = LifecycleRow::asked_for(asked.as_deref())?;
            self.pulses().note(attempt, self.now().as_millis());
            return Ok(UserRequest::command(asked));
        }
        let lease = self.lease_millis();
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let (_, job) = change.extend(key, lease).await?;
                Ok(UserRequest::command(job.asked()?))
            })
        })
        .await
    }

    /// Writes down the heartbeats that have come since the last time.
    ///
    /// # Errors
    /// The database's; the heartbeats are then kept for the next time.
    pub(super) async fn write_pulses(&self) -> Result<()> {
        let pulses = self.pulses().all();
        if pulses.is_empty() {
            return Ok(());
        }
        let (rows, lease) = (json(&pulses)?, self.lease_millis());
        self.write_from_reserve(move |change| {
            Box::pin(async move { change.extend_all(&rows, lease).await })
        })
        .await?;
        self.pulses().forget(&pulses);
        Ok(())
    }
}

impl Change {
    /// Extends the live leases of attempts, and notes that their workers are there: `pulses` is a list of
    /// rows of attempts with the moment of each.
    async fn extend_all(&mut self, pulses: &str, lease: i64) -> Result<()> {
        query(
            "UPDATE attempts SET lease_until = p.at + ?2
             FROM (SELECT CAST(json_extract(value, '$[0]') AS BIGINT) AS attempt,
                          CAST(json_extract(value, '$[1]') AS BIGINT) AS at FROM json_each(?1)) p
             WHERE seq = p.attempt AND ended_at IS NULL AND lease_until < p.at + ?2",
        )
        .bind(pulses)
        .bind(lease)
        .execute(&mut self.connection)
        .await?;
        query(
            "UPDATE workers SET last_seen_at = heard.at
             FROM (SELECT a.worker, MAX(CAST(json_extract(p.value, '$[1]') AS BIGINT)) AS at
                   FROM json_each(?1) p JOIN attempts a ON a.seq = CAST(json_extract(p.value, '$[0]') AS BIGINT)
                   GROUP BY a.worker) heard
             WHERE id = heard.worker AND last_seen_at < heard.at",
        )
        .bind(pulses)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }
}
