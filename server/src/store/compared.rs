//! What comparing reads of many jobs: rows in the order asked for, specs one by one, and two columns of a
//! curve in blocks.
use indexmap::IndexMap;
use loadframe_api::{JobKind, JobOutcome, JobStatus, Quantity, Timestamp};
use uuid::Uuid;

use super::Store;
use super::curve::Block;
use super::database::{query_as, query_scalar, row};
use super::encoding::{parsed, variant};
use super::error::{Result, StoreError};
use super::jobs::hex_names;
use crate::access::Sight;
use crate::tasks::blocking;

/// Blocks of a curve that are read at once: some MB.
const BLOCKS: i64 = 64;

row! {
    struct Row {
        seq: i64,
        id: Uuid,
        kind: String,
        name: String,
        tags: String,
        status: String,
        outcome: Option<String>,
        created_at: i64,
        spec_sha256: String,
        spec_bytes: i64,
        summary: Option<String>,
        owner: Option<Uuid>,
        project: Option<Uuid>,
        attempt: Option<i64>,
        columns: String,
        points: i64,
    }
}

/// A job as far as comparing looks.
#[derive(Clone, Debug)]
pub struct Compared {
    seq: i64,
    pub id: Uuid,
    pub kind: JobKind,
    pub name: String,
    pub tags: Vec<String>,
    pub status: JobStatus,
    pub outcome: Option<JobOutcome>,
    pub created_at: Timestamp,
    pub spec_sha256: String,
    /// Length of its spec as JSON [bytes].
    pub spec_bytes: u64,
    pub summary: IndexMap<String, Quantity>,
    attempt: Option<i64>,
    /// Columns of its curve.
    pub columns: Vec<String>,
    /// Points of its curve.
    pub points: u64,
}

/// Where the points of two columns stand in a curve.
#[derive(Clone, Copy, Debug)]
pub struct CurvePart {
    attempt: Option<i64>,
    columns: usize,
    chosen: [usize; 2],
    next: i64,
}

impl Row {
    fn compared(self) -> Result<Compared> {
        let summary = self.summary.as_deref().map(|text| parsed(text, "summary"));
        let outcome = self.outcome.as_deref().map(variant);
        Ok(Compared {
            seq: self.seq,
            id: self.id,
            kind: variant(&self.kind)?,
            name: self.name,
            tags: parsed(&self.tags, "tags")?,
            status: variant(&self.status)?,
            outcome: outcome.transpose()?,
            created_at: Timestamp(self.created_at),
            spec_sha256: self.spec_sha256,
            spec_bytes: self.spec_bytes.unsigned_abs(),
            summary: summary.transpose()?.unwrap_or_default(),
            attempt: self.attempt,
            columns: parsed(&self.columns, "columns")?,
            points: self.points.unsigned_abs(),
        })
    }
}

impl Compared {
    /// Two columns of the curve, from its first point on; none where it has no such columns.
    pub fn part(&self, over: &str, of: &str) -> Option<CurvePart> {
        let place = |name: &str| self.columns.iter().position(|column| column == name);
        Some(CurvePart {
            attempt: self.attempt,
            columns: self.columns.len(),
            chosen: [place(over)?, place(of)?],
            next: 0,
        })
    }
}

impl Store {
    /// The jobs of these ids that `sight` shows, in the order of the ids. A curve is the one that
    /// [`Store::curve`] shows.
    ///
    /// # Errors
    /// The database's.
    pub async fn compared(&self, ids: &[Uuid], sight: &Sight) -> Result<Vec<Compared>> {
        let rows: Vec<Row> = query_as(
            "SELECT j.seq, j.id, j.kind, j.name, j.tags, j.status, j.outcome, j.created_at,
                    j.spec_sha256, j.owner, j.project,
                    COALESCE((SELECT octet_length(s.json) FROM specs s WHERE s.job = j.seq), 0) AS spec_bytes,
                    (SELECT summary FROM results r WHERE r.job = j.seq) AS summary,
                    a.seq AS attempt, COALESCE(a.columns, '[]') AS columns,
                    COALESCE(a.points, 0) AS points
             FROM jobs j LEFT JOIN attempts a ON a.seq =
                (SELECT b.seq FROM attempts b LEFT JOIN results r ON r.job = b.job
                 WHERE b.job = j.seq ORDER BY b.number = r.attempt DESC, b.points DESC, b.seq DESC LIMIT 1)
             WHERE j.id IN (SELECT unhex(value) FROM json_each(?))",
        )
        .bind(hex_names(ids)?)
        .fetch_all(self.reads())
        .await?;
        let seen = rows
            .into_iter()
            .filter(|row| sight.shows(row.id, row.owner, row.project));
        let jobs = seen.map(|row| Ok((row.id, row.compared()?)));
        let mut jobs: IndexMap<Uuid, Compared> = jobs.collect::<Result<_>>()?;
        Ok(ids.iter().filter_map(|id| jobs.swap_remove(id)).collect())
    }

    /// The normalised spec as JSON.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] when the job has been deleted since.
    pub async fn compared_spec(&self, job: &Compared) -> Result<String> {
        let spec = query_scalar("SELECT json FROM specs WHERE job = ?")
            .bind(job.seq)
            .fetch_optional(self.reads())
            .await?;
        spec.ok_or_else(|| StoreError::NotFound(format!("job {}", job.id)))
    }

    /// The next points of a part of a curve, some ten thousands of them, and what remains; no points at
    /// its end.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] for blocks that cannot be read.
    pub async fn curve_part(&self, part: CurvePart) -> Result<(Vec<[f64; 2]>, CurvePart)> {
        let blocks: Vec<Block> = query_as(
            "SELECT first, count, data FROM curve_blocks WHERE attempt = ? AND first >= ?
             ORDER BY first LIMIT ?",
        )
        .bind(part.attempt)
        .bind(part.next)
        .bind(BLOCKS)
        .fetch_all(self.reads())
        .await?;
        let CurvePart {
            columns, chosen, ..
        } = part;
        let decoded = blocking(move || {
            let mut points = Vec::new();
            for block in &blocks {
                block.columns(columns, chosen, &mut points)?;
            }
            let next = blocks.last().map(|block| block.first + block.count);
            Ok::<_, StoreError>((points, next))
        });
        let (points, next) = decoded.await??;
        let next = next.unwrap_or(part.next);
        Ok((points, CurvePart { next, ..part }))
    }
}
