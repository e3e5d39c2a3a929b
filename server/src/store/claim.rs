//! Handing a job to a worker.
use std::sync::Arc;

use loadframe_api::JobKind;
use loadframe_api::worker::{CheckpointInfo, ClaimRequest, Lease};
use serde_json::value::RawValue;
use uuid::Uuid;

use super::Store;
use super::calls::Waiting;
use super::checkpoints::CheckpointRow;
use super::choice::standings_of;
use super::clock::millis;
use super::database::{FromRow, Query, Row, query, query_scalar, row};
use super::encoding::variant;
use super::error::{Result, StoreError};
use super::jobs::limits;
use super::state::LifecycleRow;
use super::writer::Change;
use crate::queue::Input;
use crate::queue::turns::Standing;

/// Heartbeats are due this often [s], so that a cancel reaches its worker in less than 2 s,
const HEARTBEAT_S: f64 = 1.0;
/// and so often within a lease that one may be lost.
const HEARTBEATS_A_LEASE: f64 = 4.0;

row! {
    /// What there is for a worker that asks.
    struct Look {
        /// Jobs wait; whether any is for it is another question.
        has_jobs: bool,
        /// Its machine is given none.
        is_set_aside: bool,
        /// It asks for the first time.
        is_new: bool,
        /// It has a live lease that it never used.
        has_unused: bool,
    }
}

row! {
    /// The job that a worker gets.
    struct ClaimedJob {
        id: Uuid,
        token: Uuid,
        number: u32,
        job: Uuid,
        kind: String,
        spec: String,
        spec_sha256: String,
        /// The job's row.
        job_row: i64,
        /// Points of the curve that the attempt has from the one before.
        points: i64,
        estimate: Option<String>,
        overrun_factor: f64,
    }
}

impl ClaimedJob {
    /// The statement that reads what an attempt is of.
    fn query(attempt: Uuid) -> Query {
        let claimed = query(
            "SELECT a.id, a.token, a.number, j.id AS job, j.kind, s.json AS spec,
                    j.spec_sha256, j.seq AS job_row, a.points, j.estimate, j.overrun_factor
             FROM attempts a JOIN jobs j ON j.seq = a.job JOIN specs s ON s.job = a.job
             WHERE a.id = ?",
        );
        claimed.bind(attempt)
    }

    fn of(rows: &[Row]) -> Result<Self> {
        let row = rows.first().ok_or(sqlx::Error::RowNotFound)?;
        Ok(Self::from_row(row)?)
    }
}

/// A job, and the checkpoint that it goes on from.
type Claimed = (ClaimedJob, Option<CheckpointInfo>);

impl Store {
    /// Takes a place among the workers that wait for a job at this server.
    pub fn wait_in_line(&self, request: &ClaimRequest) -> Waiting {
        Waiting::among(Arc::clone(&self.0.calls), self.queued(), request)
    }

    /// The next job for this worker, if one is waiting now that fits it: see [`super::choice`]. A lease that was handed to this worker and never used is handed
    /// out again: the answer to the first claim must have been lost.
    ///
    /// # Errors
    /// [`StoreError::Unavailable`] and the database's.
    pub async fn claim(&self, request: &ClaimRequest) -> Result<Option<Lease>> {
        let (worker, lease) = (request.clone(), self.lease_millis());
        let (is_new, claimed) = self
            .write(move |change| Box::pin(async move { change.claim(&worker, lease).await }))
            .await?;
        if is_new {
            self.forget_speed();
        }
        let Some((claimed, checkpoint)) = claimed else {
            return Ok(None);
        };
        let lease_s = self.options().lease.as_secs_f64();
        Ok(Some(Lease {
            id: claimed.id,
            token: claimed.token,
            job_id: claimed.job,
            attempt: claimed.number,
            kind: variant::<JobKind>(&claimed.kind)?,
            spec: RawValue::from_string(claimed.spec).map_err(StoreError::corrupt("spec"))?,
            spec_sha256: claimed.spec_sha256,
            lease_s,
            heartbeat_s: HEARTBEAT_S.min(lease_s / HEARTBEATS_A_LEASE),
            time_limit_s: self
                .options()
                .job_time_limit
                .map(|limit| limit.as_secs_f64()),
            limits: limits(claimed.estimate.as_deref(), claimed.overrun_factor)?,
            checkpoint,
            curve_points: claimed.points.unsigned_abs(),
        }))
    }
}

impl Change {
    /// Whether the worker asks for the first time, and what it gets.
    async fn claim(
        &mut self,
        worker: &ClaimRequest,
        lease: i64,
    ) -> Result<(bool, Option<Claimed>)> {
        let (look, standings) = self.look_and_register(worker).await?;
        let is_new = look.is_new;
        let claimed = self.claim_of(look, &standings, worker, lease).await?;
        Ok((is_new, claimed))
    }

    async fn claim_of(
        &mut self,
        mut look: Look,
        standings: &[Standing],
        worker: &ClaimRequest,
        lease: i64,
    ) -> Result<Option<Claimed>> {
        if look.is_set_aside && look.is_new {
            // somebody may have seen to the machine
            self.end_pause(worker).await?;
            look.is_set_aside = false;
        }
        let unused = match look.has_unused {
            true => self.unused_lease(worker.worker_id, lease).await?,
            false => None,
        };
        let claimed = match unused {
            Some(claimed) => claimed,
            None if look.is_set_aside || !look.has_jobs => return Ok(None),
            None => match self.next_job(worker, standings).await? {
                Some(job) => self.start_attempt(worker, &job, lease).await?,
                None => return Ok(None),
            },
        };
        let engine = &worker.engine_version;
        let connection = &mut self.connection;
        let newest = match claimed.number {
            ..=1 => None,
            _ => CheckpointRow::newest(connection, claimed.job_row, engine, None).await?,
        };
        let checkpoint = match newest {
            Some(newest) => Some(newest.info(connection).await?),
            None => None,
        };
        Ok(Some((claimed, checkpoint)))
    }

    /// What there is for a worker, and how everybody stands, and notes that it asks, in one go.
    async fn look_and_register(&mut self, worker: &ClaimRequest) -> Result<(Look, Vec<Standing>)> {
        let look = query(
            "SELECT EXISTS (SELECT 1 FROM waiting_lines) AS has_jobs,
                    EXISTS (SELECT 1 FROM machines WHERE host = ?2 AND worker_name = ?3 AND until > ?4)
                        AS is_set_aside,
                    NOT EXISTS (SELECT 1 FROM workers WHERE id = ?1) AS is_new,
                    EXISTS (SELECT 1 FROM attempts WHERE worker = ?1 AND ended_at IS NULL AND heard = FALSE)
                        AS has_unused",
        )
        .bind(worker.worker_id)
        .bind(&worker.host)
        .bind(&worker.name)
        .bind(self.now.as_millis());
        let registered = self.worker_registered(worker)?;
        let statements = vec![look, registered, self.standings_now()];
        let rows = self.connection.run_all(statements).await?;
        let look = rows.first().and_then(|rows| rows.first());
        let look = Look::from_row(look.ok_or(sqlx::Error::RowNotFound)?)?;
        Ok((look, standings_of(rows.last().map_or(&[], Vec::as_slice))?))
    }

    /// What a live lease of the worker that it never used is of; it is extended.
    async fn unused_lease(&mut self, worker: Uuid, lease: i64) -> Result<Option<ClaimedJob>> {
        let attempt: Option<Uuid> = query_scalar(
            "UPDATE attempts SET lease_until = ?1
             WHERE worker = ?2 AND ended_at IS NULL AND heard = FALSE RETURNING id",
        )
        .bind(self.now.as_millis() + lease)
        .bind(worker)
        .fetch_optional(&mut self.connection)
        .await?;
        match attempt {
            Some(attempt) => Ok(Some(self.claimed(attempt).await?)),
            None => Ok(None),
        }
    }

    async fn claimed(&mut self, attempt: Uuid) -> Result<ClaimedJob> {
        let claimed = ClaimedJob::query(attempt);
        ClaimedJob::of(&claimed.fetch_all(&mut self.connection).await?)
    }

    /// Starts an attempt at a queued job; the files of its checkpoint, if it has one, are carried
    /// over.
    async fn start_attempt(
        &mut self,
        worker: &ClaimRequest,
        job: &LifecycleRow,
        lease: i64,
    ) -> Result<ClaimedJob> {
        let why = format!("running on {} ({})", worker.name, worker.host);
        let engine = &worker.engine_version;
        // at its first attempt a job has none
        let newest = match job.attempt {
            0 => None,
            _ => CheckpointRow::newest(&mut self.connection, job.seq, engine, None).await?,
        };
        let (id, number) = (Uuid::now_v7(), job.attempt + 1);
        let started = query(
            "INSERT INTO attempts (seq, id, token, job, number, worker, worker_name, host, started_at,
                                   lease_until, resumed_wall_s, engine, threads)
             -- a number that no attempt in the trash has, either
             VALUES (1 + (SELECT COALESCE(MAX(last), 0) FROM (SELECT MAX(seq) AS last FROM attempts
                     UNION ALL SELECT MAX(seq) FROM trashed_attempts) all_attempts),
                     ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)
             RETURNING seq",
        )
        .bind(id)
        .bind(Uuid::new_v4())
        .bind(job.seq)
        .bind(number)
        .bind(worker.worker_id)
        .bind(&worker.name)
        .bind(&worker.host)
        .bind(self.now.as_millis())
        .bind(self.now.as_millis() + lease)
        .bind(newest.as_ref().map_or(0.0, |newest| newest.wall_s))
        .bind(engine)
        .bind(worker.threads);
        let then = vec![started, ClaimedJob::query(id)];
        let step = self.step_and(job, Input::Claim, Some(why), None, then);
        let (_, rows) = step.await?;
        let [started, claimed] = rows.as_slice() else {
            return Err(sqlx::Error::RowNotFound.into());
        };
        if job.attempt == 0 {
            return ClaimedJob::of(claimed);
        }
        let started = started.first().ok_or(sqlx::Error::RowNotFound)?;
        let attempt: i64 = started.get(0)?;
        match &newest {
            Some(newest) => {
                self.carry_over(attempt, newest).await?;
                self.carry_curve_over(attempt, newest).await?;
            }
            None => self.tell_of_other_builds(job, number, engine).await?,
        }
        self.claimed(id).await
    }
}

impl Store {
    /// Length of a lease in the database's unit.
    pub(super) fn lease_millis(&self) -> i64 {
        millis(self.options().lease)
    }
}
