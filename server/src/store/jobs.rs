//! Jobs as clients see them: one, many, and how to tell cheaply whether anything changed.
use indexmap::IndexMap;
use loadframe_api::people::Named;
use loadframe_api::{
    AttemptEnd, AttemptView, JobKind, JobLinks, JobOutcome, JobStatus, JobView, Page, Quantity,
    ReasonCode, Timestamp,
};
use serde::Deserialize;
use uuid::Uuid;

use super::encoding::{json, parsed, variant, wire_name};
use super::error::{Result, StoreError};
use super::row::row;
use super::{JobFilter, Store};
use crate::access::Sight;

/// Ids as a JSON array, for `unhex` in a statement.
pub(super) fn hex_names(ids: &[Uuid]) -> Result<String> {
    let names: Vec<String> = ids.iter().map(|id| format!("{:X}", id.simple())).collect();
    json(&names)
}

/// Longest page of a list.
const LONGEST_PAGE: u32 = 1000;

/// The statement that reads jobs, ended by `$rest`. One statement, so that what it reads belongs
/// together without a transaction.
macro_rules! select_jobs {
    ($rest:literal) => {
        concat!(
            "SELECT j.seq, j.id, j.kind, j.name, j.notes, j.tags, j.priority, j.status, j.outcome,
                j.reason, j.reason_code, j.progress, j.phase, j.eta_s, j.attempt, j.created_at,
                j.started_at, j.finished_at, j.updated_at, j.spec_sha256,
                j.owner, (SELECT name FROM people o WHERE o.id = j.owner) AS owner_name,
                j.project, (SELECT name FROM projects p WHERE p.id = j.project) AS project_name,
                (SELECT summary FROM results r WHERE r.job = j.seq) AS summary,
                CASE j.status WHEN 'queued' THEN 1 + (SELECT COUNT(*) FROM jobs b
                    WHERE b.status = 'queued' AND (b.priority > j.priority
                       OR (b.priority = j.priority AND b.seq < j.seq))) END AS position,
                (SELECT json_group_array(json_object('number', number, 'worker', worker_name,
                    'host', host, 'started_at', started_at, 'ended_at', ended_at,
                    'end_reason', end_reason) ORDER BY number)
                 FROM attempts a WHERE a.job = j.seq) AS attempts
             FROM jobs j ",
            $rest
        )
    };
}

row! {
    /// A job's row with what belongs to it.
    #[derive(Debug)]
    pub(super) struct JobRow {
        seq: i64,
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
        owner: Option<Uuid>,
        owner_name: Option<String>,
        project: Option<Uuid>,
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
}

impl JobRow {
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
            spec: None,
            summary,
            owner: named(self.owner, self.owner_name),
            project: named(self.project, self.project_name),
            links: JobLinks::of(self.id),
        })
    }
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
        }
    }
}

/// A page of the first `limit` rows; one more of them says that another page follows.
fn page_of(mut rows: Vec<JobRow>, limit: u32) -> Result<Page<JobView>> {
    let is_last = rows.len() <= limit as usize;
    rows.truncate(limit as usize);
    let next = rows
        .last()
        .filter(|_| !is_last)
        .map(|row| row.seq.to_string());
    let items = rows.into_iter().map(JobRow::view).collect::<Result<_>>()?;
    Ok(Page { items, next })
}

impl Store {
    /// The job with its spec.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn job(&self, id: Uuid) -> Result<JobView> {
        let mut connection = self.reads().acquire().await?;
        let row: Option<JobRow> = sqlx::query_as(select_jobs!("WHERE j.id = ?"))
            .bind(id)
            .fetch_optional(&mut *connection)
            .await?;
        let row = row.ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        // a spec never changes, so it need not be of the same moment
        let spec: Option<String> = sqlx::query_scalar("SELECT json FROM specs WHERE job = ?")
            .bind(row.seq)
            .fetch_optional(&mut *connection)
            .await?;
        let mut view = row.view()?;
        view.spec = match spec {
            Some(text) => Some(parsed(&text, "spec")?),
            None => return Err(StoreError::NotFound(format!("job {id}"))),
        };
        Ok(view)
    }

    /// Changes whenever [`Self::job`] does.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn job_version(&self, id: Uuid) -> Result<u64> {
        // the place in the queue changes with the others' steps
        let version: Option<i64> = sqlx::query_scalar(
            "SELECT CASE status WHEN 'queued'
                THEN MAX((SELECT MAX(seq) FROM events WHERE type = 'job'),
                    COALESCE((SELECT MAX(seq) FROM events WHERE type = 'deleted'), 0))
                ELSE version END
             FROM jobs WHERE id = ?",
        )
        .bind(id)
        .fetch_optional(self.reads())
        .await?;
        let version = version.ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        Ok(version.unsigned_abs())
    }

    /// Changes whenever [`Self::jobs`] does.
    ///
    /// # Errors
    /// The database's.
    pub async fn jobs_version(&self) -> Result<u64> {
        let version: Option<i64> = sqlx::query_scalar("SELECT MAX(seq) FROM events")
            .fetch_one(self.reads())
            .await?;
        Ok(version.unwrap_or_default().unsigned_abs())
    }

    /// Jobs that pass the filter, newest first; `cursor` is the `next` of the page before.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] for a cursor that was never given out.
    pub async fn jobs(
        &self,
        filter: &JobFilter,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        let limit = limit.clamp(1, LONGEST_PAGE);
        let before: Option<i64> = match cursor {
            None => None,
            Some(text) => Some(text.parse().map_err(|_| {
                StoreError::Invalid("the cursor is not one that a page gave as `next`".to_owned())
            })?),
        };
        let everything = Sight::everything();
        let sight = filter.sight.as_ref().unwrap_or(&everything);
        if !sight.everything && filter.narrows_nothing_else() {
            let newest = self.newest_seen(sight, before.unwrap_or(i64::MAX), limit + 1);
            let rows: Vec<JobRow> = sqlx::query_as(select_jobs!(
                "WHERE j.seq IN (SELECT value FROM json_each(?)) ORDER BY j.seq DESC"
            ))
            .bind(json(&newest.await?)?)
            .fetch_all(self.reads())
            .await?;
            return page_of(rows, limit);
        }
        let rows: Vec<JobRow> = sqlx::query_as(select_jobs!(
            "WHERE (?1 IS NULL OR j.seq < ?1)
               AND (?2 IS NULL OR j.status = ?2)
               AND (?3 IS NULL OR j.outcome = ?3)
               AND (?4 IS NULL OR j.kind = ?4)
               AND (?5 IS NULL OR EXISTS (SELECT 1 FROM json_each(j.tags) WHERE value = ?5))
               AND (?6 IS NULL OR instr(lower(j.name), ?6) OR instr(lower(j.notes), ?6)
                    OR instr(lower(j.tags), ?6) OR instr(lower(hex(j.id)), replace(?6, '-', '')) = 1)
               AND (?7 IS NULL OR j.created_at > ?7)
               AND (?8 IS NULL OR j.created_at < ?8)
               AND (?10 OR j.owner = ?11 OR j.id = ?12
                    OR j.project IN (SELECT unhex(value) FROM json_each(?13)))
               AND (?14 = '[]' OR j.project IS NULL
                    OR j.project NOT IN (SELECT unhex(value) FROM json_each(?14)))
               AND (?15 IS NULL OR j.owner IS NOT ?15) AND (?16 IS NULL OR j.project = ?16)
             ORDER BY j.seq DESC LIMIT ?9"
        ))
        .bind(before)
        .bind(filter.status.as_ref().map(wire_name).transpose()?)
        .bind(filter.outcome.as_ref().map(wire_name).transpose()?)
        .bind(filter.kind.map(JobKind::name))
        .bind(filter.tag.as_deref())
        .bind(filter.q.as_ref().map(|text| text.to_ascii_lowercase()))
        .bind(filter.created_after.map(Timestamp::as_millis))
        .bind(filter.created_before.map(Timestamp::as_millis))
        .bind(limit + 1)
        .bind(sight.everything)
        .bind(sight.owner)
        .bind(sight.job)
        .bind(hex_names(&sight.projects)?)
        .bind(hex_names(&sight.not_in)?)
        .bind(sight.not_of)
        .bind(filter.project)
        .fetch_all(self.reads())
        .await?;
        page_of(rows, limit)
    }

    /// Jobs by id, in any order; those that are gone are left out.
    pub(super) async fn jobs_by_id(&self, ids: &[Uuid]) -> Result<Vec<JobView>> {
        let rows: Vec<JobRow> = sqlx::query_as(select_jobs!(
            "WHERE j.id IN (SELECT unhex(value) FROM json_each(?))"
        ))
        .bind(hex_names(ids)?)
        .fetch_all(self.reads())
        .await?;
        rows.into_iter().map(JobRow::view).collect()
    }
}
