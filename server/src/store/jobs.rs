//! Jobs as clients see them, and how to tell cheaply whether anything changed.
use std::collections::BTreeSet;

use indexmap::IndexMap;
use loadframe_api::people::Named;
use loadframe_api::{
    AttemptEnd, AttemptView, Estimate, JobKind, JobLimits, JobLinks, JobOutcome, JobStatus,
    JobView, Quantity, ReasonCode, Timestamp,
};
use serde::Deserialize;
use uuid::Uuid;

use super::Store;
use super::database::{FromRow, On, Query, query, query_as, query_scalar, row};
use super::encoding::{json, parsed, variant};
use super::error::{Result, StoreError};

/// Ids as a JSON array, for `unhex` in a statement.
pub(super) fn hex_names(ids: &[Uuid]) -> Result<String> {
    let names: Vec<String> = ids.iter().map(|id| format!("{:X}", id.simple())).collect();
    json(&names)
}

/// The statement that reads jobs, up to where they come from. One statement, so that what it reads
/// belongs together without a transaction. A place in the queue is one more than the jobs before it: of
/// higher priorities, its owner's of the same (in blocks before, in ever smaller blocks before, and within its
/// own block), and as many of each other person's, one more of those whose turn is before its owner's.
macro_rules! select_jobs {
    // one job
    ($from:literal) => {
        select_jobs!(
            "(SELECT name FROM people o WHERE o.id = j.owner)",
            "(SELECT name FROM projects p WHERE p.id = j.project)",
            $from
        )
    };
    // a list, whose names are read afterwards
    (many $from:literal) => {
        select_jobs!("NULL", "NULL", $from)
    };
    ($owner_name:literal, $project_name:literal, $from:literal) => {
        concat!(
            "SELECT j.seq, j.id, j.kind, j.name, j.notes, j.tags, j.priority, j.status, j.outcome,
                j.reason, j.reason_code, j.progress, j.phase, j.eta_s, j.attempt, j.created_at,
                j.started_at, j.finished_at, j.updated_at, j.spec_sha256, j.estimate, j.overrun_factor,
                j.threads, j.owner, j.project, ",
            $owner_name,
            " AS owner_name, ",
            $project_name,
            " AS project_name,
                (SELECT summary FROM results r WHERE r.job = j.seq) AS summary,
                CASE j.status WHEN 'queued' THEN CAST(1
                    + (SELECT COALESCE(SUM(w.jobs), 0) FROM waiting_counts w
                       WHERE w.bits = 18 AND w.priority > j.priority)
                    + (SELECT own.jobs + COALESCE((SELECT SUM(CASE WHEN o.jobs <= own.jobs THEN o.jobs
                            ELSE own.jobs + CASE WHEN CASE
                            WHEN COALESCE(p.use_level, -1e9) <> COALESCE(m.use_level, -1e9)
                            THEN COALESCE(p.use_level, -1e9) < COALESCE(m.use_level, -1e9)
                            ELSE (SELECT b.seq FROM jobs b INDEXED BY jobs_waiting
                                  WHERE b.status = 'queued' AND b.priority = j.priority
                                    AND b.owner IS NOT DISTINCT FROM NULLIF(o.owner, x'') ORDER BY b.seq LIMIT 1)
                                < (SELECT b.seq FROM jobs b INDEXED BY jobs_waiting
                                   WHERE b.status = 'queued' AND b.priority = j.priority
                                     AND b.owner IS NOT DISTINCT FROM j.owner ORDER BY b.seq LIMIT 1) END
                            THEN 1 ELSE 0 END END)
                        FROM (SELECT w.owner, SUM(w.jobs) AS jobs FROM waiting_counts w
                              WHERE w.bits = 18 AND w.priority = j.priority
                                AND w.owner <> COALESCE(j.owner, x'') GROUP BY w.owner) o
                            LEFT JOIN people p ON p.id = o.owner
                            LEFT JOIN people m ON m.id = j.owner), 0)
                       FROM (SELECT
                        (SELECT COALESCE(SUM(w.jobs), 0) FROM waiting_counts w
                         WHERE w.bits = 18 AND w.priority = j.priority
                           AND w.owner = COALESCE(j.owner, x'') AND w.block < j.seq >> 18)
                        + (SELECT COALESCE(SUM(w.jobs), 0) FROM waiting_counts w
                           WHERE w.bits = 12 AND w.priority = j.priority
                             AND w.owner = COALESCE(j.owner, x'')
                             AND w.block >= j.seq >> 18 << 6 AND w.block < j.seq >> 12)
                        + (SELECT COALESCE(SUM(w.jobs), 0) FROM waiting_counts w
                           WHERE w.bits = 6 AND w.priority = j.priority
                             AND w.owner = COALESCE(j.owner, x'')
                             AND w.block >= j.seq >> 12 << 6 AND w.block < j.seq >> 6)
                        + (SELECT COUNT(*) FROM jobs b INDEXED BY jobs_waiting
                           WHERE b.status = 'queued' AND b.priority = j.priority
                             AND b.owner IS NOT DISTINCT FROM j.owner
                             AND b.seq >= j.seq >> 6 << 6 AND b.seq < j.seq) AS jobs LIMIT 1) own)
                AS BIGINT) END AS position,
                (SELECT json_group_array(json_object('number', number, 'worker', worker_name,
                    'host', host, 'started_at', started_at, 'ended_at', ended_at,
                    'end_reason', end_reason, 'engine', engine) ORDER BY number)
                 FROM attempts a WHERE a.job = j.seq) AS attempts
             FROM ",
            $from
        )
    };
}

/// The same for a list, to be gone on with; [`Store::with_names`] completes its rows.
pub(super) const SELECT_JOBS: &str = select_jobs!(many "");

row! {
    /// A job's row with what belongs to it.
    #[derive(Debug)]
    pub(super) struct JobRow {
        pub(super) seq: i64,
        id: Uuid,
        kind: String,
        name: String,
        notes: String,
        tags: String,
        priority: i32,
        status: String,
        outcome: Option<String>,
        reason: String,
        reason_code: String,
        progress: f64,
        phase: String,
        eta_s: Option<f64>,
        attempt: u32,
        created_at: i64,
        started_at: Option<i64>,
        finished_at: Option<i64>,
        updated_at: i64,
        spec_sha256: String,
        estimate: Option<String>,
        overrun_factor: f64,
        threads: Option<u32>,
        owner: Option<Uuid>,
        owner_name: Option<String>,
        pub(super) project: Option<Uuid>,
        project_name: Option<String>,
        summary: Option<String>,
        position: Option<i64>,
        attempts: String,
    }
}

/// An attempt as the statement writes it.
#[derive(Deserialize)]
struct AttemptRow {
    number: u32,
    worker: String,
    host: String,
    started_at: i64,
    ended_at: Option<i64>,
    end_reason: Option<AttemptEnd>,
    engine: String,
}

impl JobRow {
    /// That of the job `id`.
    async fn of(on: impl Into<On<'_>>, id: Uuid) -> Result<Self> {
        let rows = Self::query(id).fetch_all(on).await?;
        Ok(match rows.first() {
            Some(row) => Self::from_row(row)?,
            None => return Err(StoreError::NotFound(format!("job {id}"))),
        })
    }

    /// The statement that reads it.
    pub(super) fn query(id: Uuid) -> Query {
        query(select_jobs!("jobs j WHERE j.id = ?")).bind(id)
    }

    /// The view of a job whose spec is known.
    pub(super) fn view_with_spec(self, spec: &str) -> Result<JobView> {
        let mut view = self.view()?;
        view.spec = Some(parsed(spec, "spec")?);
        Ok(view)
    }

    pub(super) fn view(self) -> Result<JobView> {
        let attempts: Vec<AttemptRow> = parsed(&self.attempts, "attempts")?;
        let summary: Option<IndexMap<String, Quantity>> = match &self.summary {
            Some(text) => Some(parsed(text, "summary")?),
            None => None,
        };
        let outcome: Option<JobOutcome> = self.outcome.as_deref().map(variant).transpose()?;
        Ok(JobView {
            id: self.id,
            kind: variant::<JobKind>(&self.kind)?,
            name: self.name,
            notes: self.notes,
            tags: parsed(&self.tags, "tags")?,
            priority: self.priority,
            status: variant::<JobStatus>(&self.status)?,
            outcome,
            reason: self.reason,
            reason_code: variant::<ReasonCode>(&self.reason_code)?,
            progress: self.progress,
            phase: self.phase,
            eta_s: self.eta_s,
            position: self.position.map(i64::unsigned_abs),
            attempt: self.attempt,
            attempts: attempts.into_iter().map(AttemptRow::view).collect(),
            created_at: Timestamp(self.created_at),
            started_at: self.started_at.map(Timestamp),
            finished_at: self.finished_at.map(Timestamp),
            updated_at: Timestamp(self.updated_at),
            spec_sha256: self.spec_sha256,
            threads: self.threads,
            overrun_factor: self.overrun_factor,
            limits: limits(self.estimate.as_deref(), self.overrun_factor)?,
            spec: None,
            summary,
            values: IndexMap::new(),
            owner: named(self.owner, self.owner_name),
            project: named(self.project, self.project_name),
            links: JobLinks::of(self.id),
        })
    }
}

/// What a job may take, by its estimate as it was written down.
pub(super) fn limits(estimate: Option<&str>, factor: f64) -> Result<Option<JobLimits>> {
    let Some(estimate) = estimate else {
        return Ok(None);
    };
    let estimate: Estimate = parsed(estimate, "estimate")?;
    Ok(Some(JobLimits::beyond(&estimate, factor)))
}

fn named(id: Option<Uuid>, name: Option<String>) -> Option<Named> {
    id.zip(name).map(|(id, name)| Named { id, name })
}

impl AttemptRow {
    fn view(self) -> AttemptView {
        AttemptView {
            number: self.number,
            worker: self.worker,
            host: self.host,
            started_at: Timestamp(self.started_at),
            ended_at: self.ended_at.map(Timestamp),
            end_reason: self.end_reason,
            engine: self.engine,
        }
    }
}

impl Store {
    /// The job with its spec.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn job(&self, id: Uuid) -> Result<JobView> {
        let mut connection = self.lookups().acquire().await?;
        let row = JobRow::of(&mut connection, id).await?;
        // a spec never changes, so it need not be of the same moment
        let spec: Option<String> = query_scalar("SELECT json FROM specs WHERE job = ?")
            .bind(row.seq)
            .fetch_optional(&mut connection)
            .await?;
        match spec {
            Some(spec) => row.view_with_spec(&spec),
            None => Err(StoreError::NotFound(format!("job {id}"))),
        }
    }

    /// Changes whenever the job does.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn job_version(&self, id: Uuid) -> Result<u64> {
        Ok(self.job_state(id).await?.0)
    }

    /// Changes whenever [`Self::job`] does: the version of the job, and the name of its project, whose change is
    /// none of the job's.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn job_state(&self, id: Uuid) -> Result<(u64, Option<String>)> {
        // the place in the queue changes with the others' steps
        let state: Option<(i64, Option<String>)> = query_as(
            "SELECT CASE status WHEN 'queued'
                THEN (SELECT MAX(last) FROM (SELECT MAX(seq) AS last FROM events WHERE type = 'job'
                    UNION ALL SELECT MAX(seq) FROM events WHERE type = 'deleted') steps)
                ELSE version END, (SELECT name FROM projects p WHERE p.id = jobs.project)
             FROM jobs WHERE id = ?",
        )
        .bind(id)
        .fetch_optional(self.lookups())
        .await?;
        let (version, project) = state.ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        Ok((version.unsigned_abs(), project))
    }

    /// Changes whenever [`Self::jobs`] does.
    ///
    /// # Errors
    /// The database's.
    pub async fn jobs_version(&self) -> Result<u64> {
        Ok(self.access_state().versions(self.lookups()).await?.jobs)
    }

    /// Jobs by id, in any order; those that are gone are left out.
    pub(super) async fn jobs_by_id(&self, ids: &[Uuid]) -> Result<Vec<JobView>> {
        let rows: Vec<JobRow> = query_as(select_jobs!(
            many "jobs j WHERE j.id IN (SELECT unhex(value) FROM json_each(?))"
        ))
        .bind(hex_names(ids)?)
        .fetch_all(self.reads())
        .await?;
        Ok(readable(self.with_names(rows, None).await?).0)
    }

    /// Rows of a list with the names of their owners and projects. `access` is how often access had changed
    /// when the request began, where that is known.
    pub(super) async fn with_names(
        &self,
        mut rows: Vec<JobRow>,
        access: Option<u64>,
    ) -> Result<Vec<JobRow>> {
        let named = rows.iter().flat_map(|row| [row.owner, row.project]);
        let named: BTreeSet<Uuid> = named.flatten().collect();
        if named.is_empty() {
            return Ok(rows);
        }
        let access = match access {
            Some(access) => access,
            None => self.access_version().await?,
        };
        let names = self.names(access, &named).await?;
        let name = |id: Option<Uuid>| names.get(&id?).map(ToString::to_string);
        for row in &mut rows {
            row.owner_name = name(row.owner);
            row.project_name = name(row.project);
        }
        Ok(rows)
    }
}

/// The jobs that can be read, and how many cannot: what stands in one row keeps nobody from the others.
pub(super) fn readable(rows: Vec<JobRow>) -> (Vec<JobView>, u64) {
    let (mut views, mut unreadable) = (Vec::with_capacity(rows.len()), 0);
    for row in rows {
        let id = row.id;
        match row.view() {
            Ok(view) => views.push(view),
            Err(error) => {
                unreadable += 1;
                tracing::error!(job_id = %id, %error, "a job cannot be read and is left out of the list");
            }
        }
    }
    (views, unreadable)
}
