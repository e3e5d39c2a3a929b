//! Worker processes: who is there, how fast they are, and the queue in numbers.
use std::sync::atomic::Ordering;
use std::sync::{MutexGuard, PoisonError};
use std::time::Duration;

use loadframe_api::worker::ClaimRequest;
use loadframe_api::{Calibration, SetAside, Timestamp, WorkerView};
use uuid::Uuid;

use super::clock::millis;
use super::database::{Query, query, query_as, query_scalar, row};
use super::encoding::{json, variant};
use super::error::Result;
use super::writer::Change;
use super::{Counts, LeaseKey, Store};
use crate::queue::needs::{believed, release};

/// A waiting worker is written down again when it was last seen this long ago [ms].
const SEEN_EVERY: i64 = 2_000;
/// A speed that was read is taken for that of the lab so long [ms]: of workers that come to other servers, and
/// of those that go, it tells later.
const SPEED_KEPT: i64 = 1_000;
/// The same for a working one, whose heartbeats come oftener.
const HEARD_EVERY: i64 = 1_000;
/// A worker is taken for gone when it was silent for a lease and this long [ms].
const GRACE: i64 = 5_000;

row! {
    struct WorkerRow {
        id: Uuid,
        name: String,
        host: String,
        threads: u32,
        engine_version: String,
        memory_mb: Option<f64>,
        disk_mb: Option<f64>,
        ends_at: Option<i64>,
        last_seen_at: i64,
        job: Option<Uuid>,
        /// The rest is null unless its machine is set aside.
        until: Option<i64>,
        faults: Option<u32>,
        code: Option<String>,
        reason: Option<String>,
    }
}

impl WorkerRow {
    fn set_aside(&self) -> Result<Option<SetAside>> {
        let (Some(until), Some(code)) = (self.until, &self.code) else {
            return Ok(None);
        };
        Ok(Some(SetAside {
            until: Timestamp(until),
            faults: self.faults.unwrap_or_default(),
            code: variant(code)?,
            reason: self.reason.clone().unwrap_or_default(),
        }))
    }
}

impl Change {
    /// Notes that a worker asks for a job. One that asks again and again costs no commit each time.
    pub(super) fn worker_registered(&self, worker: &ClaimRequest) -> Result<Query> {
        let speed = believed(worker.calibration).map(|speed| speed.bond_evaluations_per_s);
        let left = worker.time_left_s.map(Duration::try_from_secs_f64);
        let left = left.and_then(std::result::Result::ok).map(millis);
        let ends_at = left.map(|left| self.now.as_millis().saturating_add(left));
        let registered = query(
            "INSERT INTO workers (id, name, host, threads, engine_version, bond_evaluations_per_s,
                                  last_seen_at, kinds, memory_mb, disk_mb, ends_at, release)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?9, ?10, ?11, ?12, ?13)
             ON CONFLICT (id) DO UPDATE SET bond_evaluations_per_s = ?6, last_seen_at = ?7,
                memory_mb = ?10, disk_mb = ?11, ends_at = ?12
             WHERE workers.last_seen_at < ?8",
        )
        .bind(worker.worker_id)
        .bind(&worker.name)
        .bind(&worker.host)
        .bind(worker.threads)
        .bind(&worker.engine_version)
        .bind(speed)
        .bind(self.now.as_millis())
        .bind(self.now.as_millis() - SEEN_EVERY)
        .bind(json(&worker.kinds)?)
        .bind(worker.memory_mb)
        .bind(worker.disk_mb)
        .bind(ends_at)
        .bind(release(&worker.engine_version));
        Ok(registered)
    }

    /// Notes that a worker speaks under its lease.
    pub(super) fn worker_heard(&self, key: LeaseKey) -> Query {
        query(
            "UPDATE workers SET last_seen_at = ?1 WHERE last_seen_at < ?2
                AND id = (SELECT worker FROM attempts WHERE id = ?3 AND token = ?4)",
        )
        .bind(self.now.as_millis())
        .bind(self.now.as_millis() - HEARD_EVERY)
        .bind(key.id)
        .bind(key.token)
    }
}

impl Store {
    /// A live worker was seen since this moment.
    pub(super) fn alive_since(&self) -> i64 {
        self.now().as_millis() - self.lease_millis() - GRACE
    }

    /// Worker processes, the ones seen last first.
    ///
    /// # Errors
    /// The database's.
    pub async fn workers(&self) -> Result<Vec<WorkerView>> {
        let rows: Vec<WorkerRow> = query_as(
            "SELECT w.id, w.name, w.host, w.threads, w.engine_version, w.memory_mb, w.disk_mb, w.ends_at,
                    w.last_seen_at,
                    (SELECT j.id FROM attempts a JOIN jobs j ON j.seq = a.job
                     WHERE a.worker = w.id AND a.ended_at IS NULL LIMIT 1) AS job,
                    m.until, m.faults, m.code, m.reason
             FROM workers w LEFT JOIN machines m
                ON m.host = w.host AND m.worker_name = w.name AND m.until > ?
             ORDER BY w.last_seen_at DESC, w.name LIMIT 1000",
        )
        .bind(self.now().as_millis())
        .fetch_all(self.reads())
        .await?;
        let since = self.alive_since();
        let view = |row: WorkerRow| -> Result<WorkerView> {
            Ok(WorkerView {
                set_aside: row.set_aside()?,
                id: row.id,
                name: row.name,
                host: row.host,
                threads: row.threads,
                engine_version: row.engine_version,
                memory_mb: row.memory_mb,
                disk_mb: row.disk_mb,
                ends_at: row.ends_at.map(Timestamp),
                alive: row.last_seen_at >= since,
                job_id: row.job,
                last_seen_at: Timestamp(row.last_seen_at),
            })
        };
        rows.into_iter().map(view).collect()
    }

    /// The median of the speeds of live workers, of two the slower, so that one that measured wrongly
    /// among others prices no job; where none lives, the speed of the one seen last.
    ///
    /// # Errors
    /// The database's.
    pub async fn calibration(&self) -> Result<Option<Calibration>> {
        let now = self.now().as_millis();
        if let Some((at, known)) = *self.known_speed()
            && (at..at + SPEED_KEPT).contains(&now)
        {
            return Ok(known);
        }
        let speed: Option<f64> = query_scalar(
            "SELECT bond_evaluations_per_s FROM workers WHERE bond_evaluations_per_s IS NOT NULL
             ORDER BY last_seen_at >= ?1 DESC,
                CASE WHEN last_seen_at >= ?1 THEN bond_evaluations_per_s ELSE -last_seen_at END
             LIMIT 1 OFFSET (SELECT CASE WHEN COUNT(*) > 1 THEN (COUNT(*) - 1) / 2 ELSE 0 END FROM workers
                WHERE bond_evaluations_per_s IS NOT NULL AND last_seen_at >= ?1)",
        )
        .bind(self.alive_since())
        .fetch_optional(self.lookups())
        .await?;
        let speed = speed.map(|bond_evaluations_per_s| Calibration {
            bond_evaluations_per_s,
        });
        *self.known_speed() = Some((now, speed));
        Ok(speed)
    }

    /// Forgets the speed that was read, when a worker comes whose speed it does not contain.
    pub(super) fn forget_speed(&self) {
        *self.known_speed() = None;
    }

    fn known_speed(&self) -> MutexGuard<'_, Option<(i64, Option<Calibration>)>> {
        let known = self.0.speed.lock();
        known.unwrap_or_else(PoisonError::into_inner)
    }

    /// The queue in numbers.
    ///
    /// # Errors
    /// The database's.
    pub async fn counts(&self) -> Result<Counts> {
        let mut counts = Counts::default();
        let jobs: Vec<(String, i64)> = query_as(
            "SELECT state, jobs FROM job_counts
             UNION ALL SELECT 'queued', CAST(COALESCE(SUM(jobs), 0) AS BIGINT) FROM waiting_lines",
        )
        .fetch_all(self.reads())
        .await?;
        for (state, count) in jobs {
            let place = match state.as_str() {
                "queued" => &mut counts.queued,
                "running" => &mut counts.running,
                "paused" => &mut counts.paused,
                "succeeded" => &mut counts.succeeded,
                "failed" => &mut counts.failed,
                "cancelled" => &mut counts.cancelled,
                "timed_out" => &mut counts.timed_out,
                _ => &mut counts.quarantined,
            };
            *place = count.unsigned_abs();
        }
        let (oldest, alive, lost, bytes): (Option<i64>, i64, i64, i64) = query_as(
            "SELECT (SELECT created_at FROM jobs INDEXED BY jobs_by_status
                     WHERE status = 'queued' ORDER BY seq LIMIT 1),
                    (SELECT COUNT(*) FROM workers WHERE last_seen_at >= ?),
                    (SELECT COUNT(*) FROM attempts WHERE end_reason = 'lost'),
                    (SELECT CAST(COALESCE(SUM(bytes), 0) AS BIGINT) FROM (
                        SELECT sha256, bytes FROM attempt_files
                        UNION SELECT sha256, bytes FROM checkpoint_files
                        UNION SELECT sha256, bytes FROM checkpoints
                        UNION SELECT sha256, bytes FROM trashed_attempt_files
                        UNION SELECT sha256, bytes FROM trashed_checkpoint_files
                        UNION SELECT sha256, bytes FROM trashed_checkpoints) contents)",
        )
        .bind(self.alive_since())
        .fetch_one(self.reads())
        .await?;
        let waiting = oldest.map_or(0, |moment| self.now().as_millis() - moment);
        counts.oldest_queued_s = waiting.max(0) as f64 / 1000.0;
        counts.workers_alive = alive.unsigned_abs();
        counts.workers_set_aside = self.count_set_aside(self.alive_since()).await?;
        counts.attempts_lost = lost.unsigned_abs();
        counts.file_bytes = bytes.unsigned_abs();
        counts.is_full = self.full().is_some();
        counts.writer_restarts = self.0.restarts.writer.load(Ordering::Relaxed);
        counts.collector_restarts = self.0.restarts.collector.load(Ordering::Relaxed);
        let faults = &self.blobs().faults;
        counts.files_unnamed = faults.unnamed.load(Ordering::Relaxed);
        counts.files_lost = faults.lost.load(Ordering::Relaxed);
        Ok(counts)
    }
}
