//! Curves: points in the order they were computed, in blocks of about 100 kB.
use loadframe_api::CurveView;
use loadframe_api::worker::{CurveBlock, MOST_CURVE_COLUMNS, MOST_CURVE_POINTS};
use uuid::Uuid;

use super::Store;
use super::checkpoints::CheckpointRow;
use super::database::{query, query_as, row};
use super::encoding::{json, parsed};
use super::error::{Result, StoreError};
use super::lease::LeasedAttempt;
use super::writer::Change;
use crate::tasks::blocking;

/// Size of a full block before compression [bytes].
const BLOCK_BYTES: usize = 100_000;
/// Fast; the numbers of a simulation gain little from more.
const COMPRESSION: i32 = 1;

row! {
    #[derive(Debug)]
    pub(super) struct Block {
        pub(super) first: i64,
        pub(super) count: i64,
        data: Vec<u8>,
    }
}

impl Block {
    /// Appends two of the block's columns.
    pub(super) fn columns(
        &self,
        columns: usize,
        chosen: [usize; 2],
        points: &mut Vec<[f64; 2]>,
    ) -> Result<()> {
        let (bytes, count) = unpacked(self, columns)?;
        let (values, _) = bytes.as_chunks::<8>();
        let value = |column: usize, row: usize| f64::from_le_bytes(values[column * count + row]);
        points.extend((0..count).map(|row| chosen.map(|column| value(column, row))));
        Ok(())
    }
}

impl Change {
    /// Appends what is new in `block` to the attempt's curve; whether anything was.
    pub(super) async fn append_points(
        &mut self,
        attempt: &LeasedAttempt,
        block: &CurveBlock,
    ) -> Result<bool> {
        check(attempt, block)?;
        let known = usize::try_from(attempt.points.unsigned_abs() - block.first);
        let new = block.rows.get(known.unwrap_or(usize::MAX)..);
        let Some(new) = new.filter(|rows| !rows.is_empty()) else {
            return Ok(false);
        };
        let columns = block.columns.len();
        let full = BLOCK_BYTES.div_ceil(8 * columns);
        // a last block that is not full takes the first new points, so that a curve reported point
        // by point is read as fast as one reported at once
        let (mut first, mut rows) = match self.last_block(attempt.seq).await? {
            Some(last) if last.count.unsigned_abs() < full as u64 => {
                (last.first, decode(&last, columns)?)
            }
            _ => (attempt.points, Vec::new()),
        };
        rows.extend_from_slice(new);
        for rows in rows.chunks(full) {
            let count = i64::try_from(rows.len()).unwrap_or(i64::MAX);
            query(
                "INSERT INTO curve_blocks (attempt, first, count, data) VALUES (?, ?, ?, ?)
                 ON CONFLICT (attempt, first) DO UPDATE SET count = excluded.count, data = excluded.data",
            )
            .bind(attempt.seq)
            .bind(first)
            .bind(count)
            .bind(encode(rows, columns)?)
            .execute(&mut self.connection)
            .await?;
            first += count;
        }
        query("UPDATE attempts SET columns = ?, points = ? WHERE seq = ?")
            .bind(json(&block.columns)?)
            .bind(first)
            .bind(attempt.seq)
            .execute(&mut self.connection)
            .await?;
        Ok(true)
    }

    /// Gives an attempt that goes on from a checkpoint the points of the curve before it, in whole blocks:
    /// its worker sends only what follows. They are those of the longest curve that the same build has
    /// computed of the job: up to a checkpoint all are the same.
    pub(super) async fn carry_curve_over(
        &mut self,
        attempt: i64,
        from: &CheckpointRow,
    ) -> Result<()> {
        let longest: Option<(i64, String)> = query_as(
            "SELECT a.seq, a.columns FROM attempts a JOIN attempts mine ON mine.job = a.job
             WHERE mine.seq = ? AND a.engine = mine.engine AND a.points > 0
             ORDER BY a.points DESC, a.seq DESC LIMIT 1",
        )
        .bind(attempt)
        .fetch_optional(&mut self.connection)
        .await?;
        let Some((longest, columns)) = longest else {
            return Ok(());
        };
        let carried = query(
            "INSERT INTO curve_blocks (attempt, first, count, data)
             SELECT ?1, b.first, b.count, b.data FROM curve_blocks b
             WHERE b.attempt = ?2
               AND b.first + b.count <= (SELECT points FROM checkpoints WHERE seq = ?3)",
        )
        .bind(attempt)
        .bind(longest)
        .bind(from.seq)
        .execute(&mut self.connection)
        .await?;
        if carried.rows_affected() > 0 {
            query(
                "UPDATE attempts SET columns = ?2,
                    points = (SELECT MAX(first + count) FROM curve_blocks WHERE attempt = ?1)
                 WHERE seq = ?1",
            )
            .bind(attempt)
            .bind(columns)
            .execute(&mut self.connection)
            .await?;
        }
        Ok(())
    }

    async fn last_block(&mut self, attempt: i64) -> Result<Option<Block>> {
        let last = query_as(
            "SELECT first, count, data FROM curve_blocks WHERE attempt = ?
             ORDER BY first DESC LIMIT 1",
        )
        .bind(attempt)
        .fetch_optional(&mut self.connection)
        .await?;
        Ok(last)
    }

    /// Of a job's curves, keeps `result`, or else the longest: all attempts compute the same
    /// points, so that it holds all the others.
    pub(super) async fn keep_one_curve(&mut self, job: i64, result: Option<i64>) -> Result<()> {
        query(
            "UPDATE attempts SET points = 0, columns = '[]'
             WHERE job = ?1 AND points > 0 AND seq <> COALESCE(?2,
                (SELECT seq FROM attempts WHERE job = ?1 ORDER BY points DESC, seq DESC LIMIT 1))",
        )
        .bind(job)
        .bind(result)
        .execute(&mut self.connection)
        .await?;
        query(
            "DELETE FROM curve_blocks
             WHERE attempt IN (SELECT seq FROM attempts WHERE job = ? AND points = 0)",
        )
        .bind(job)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }
}

row! {
    struct Curve {
        attempt: Option<i64>,
        number: u32,
        columns: String,
        complete: bool,
    }
}

impl Store {
    /// Points of the curve from `since` on, at most `limit`. The curve never shrinks: while a new
    /// attempt catches up, the one that got furthest is shown.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] when there is no such job.
    pub async fn curve(&self, id: Uuid, since: u64, limit: Option<u64>) -> Result<CurveView> {
        let most = i64::MAX as u64;
        let since = since.min(most);
        let end = since.saturating_add(limit.unwrap_or(most)).min(most);
        // one snapshot, or an attempt could end between the two statements
        let mut snapshot = self.reads().begin().await?;
        let curve: Curve = query_as(
            "SELECT a.seq AS attempt, COALESCE(a.number, 0) AS number,
                    COALESCE(a.columns, '[]') AS columns, j.status = 'finished' AS complete
             FROM jobs j LEFT JOIN attempts a ON a.job = j.seq
             LEFT JOIN results r ON r.job = j.seq
             WHERE j.id = ? ORDER BY a.number = r.attempt DESC, a.points DESC, a.seq DESC LIMIT 1",
        )
        .bind(id)
        .fetch_optional(&mut snapshot)
        .await?
        .ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        let blocks: Vec<Block> = query_as(
            "SELECT first, count, data FROM curve_blocks
             WHERE attempt = ? AND first + count > ? AND first < ? ORDER BY first",
        )
        .bind(curve.attempt)
        .bind(since.cast_signed())
        .bind(end.cast_signed())
        .fetch_all(&mut snapshot)
        .await?;
        drop(snapshot);
        let columns: Vec<String> = parsed(&curve.columns, "columns")?;
        let width = columns.len();
        let points = blocking(move || between(&blocks, width, since, end)).await??;
        Ok(CurveView {
            columns,
            attempt: curve.number,
            next: since + points.len() as u64,
            points,
            complete: curve.complete,
        })
    }
}

/// The points of consecutive blocks whose index is in `since..end`.
fn between(blocks: &[Block], columns: usize, since: u64, end: u64) -> Result<Vec<Vec<f64>>> {
    let mut points = Vec::new();
    for block in blocks {
        let first = block.first.unsigned_abs();
        let rows = decode(block, columns)?.into_iter().zip(first..);
        let inside = rows.filter(|(_, index)| (since..end).contains(index));
        points.extend(inside.map(|(row, _)| row));
    }
    Ok(points)
}

fn check(attempt: &LeasedAttempt, block: &CurveBlock) -> Result<()> {
    let invalid = |sentence: String| Err(StoreError::Invalid(sentence));
    if !(1..=MOST_CURVE_COLUMNS).contains(&block.columns.len())
        || block.rows.len() > MOST_CURVE_POINTS
    {
        return invalid(format!(
            "a block has 1 … {MOST_CURVE_COLUMNS} columns and at most {MOST_CURVE_POINTS} rows"
        ));
    }
    let points = attempt.points.unsigned_abs();
    if block.first > points {
        let first = block.first;
        return invalid(format!(
            "the curve has {points} points; a block from {first} leaves a gap"
        ));
    }
    if points > 0 && parsed::<Vec<String>>(&attempt.columns, "columns")? != block.columns {
        return invalid("the columns of a curve stay the same".to_owned());
    }
    let width = block.columns.len();
    if block.rows.iter().any(|row| row.len() != width) {
        return invalid(format!("every row has {width} values, one for each column"));
    }
    if block.rows.iter().flatten().any(|value| !value.is_finite()) {
        return invalid("the values of a curve are finite".to_owned());
    }
    Ok(())
}

/// Column after column, little-endian, compressed: neighbours in a column are alike.
fn encode(rows: &[Vec<f64>], columns: usize) -> Result<Vec<u8>> {
    let column = |column: usize| rows.iter().filter_map(move |row| row.get(column));
    let bytes: Vec<u8> = (0..columns)
        .flat_map(column)
        .flat_map(|value| value.to_le_bytes())
        .collect();
    zstd::bulk::compress(&bytes, COMPRESSION).map_err(StoreError::corrupt("curve"))
}

/// The numbers of a block, column after column, and how many each has.
fn unpacked(block: &Block, columns: usize) -> Result<(Vec<u8>, usize)> {
    let count = usize::try_from(block.count).map_err(StoreError::corrupt("curve"))?;
    let size = count * columns * 8;
    let bytes = zstd::bulk::decompress(&block.data, size).map_err(StoreError::corrupt("curve"))?;
    if bytes.len() != size {
        return Err(StoreError::corrupt("curve")("a block of another size"));
    }
    Ok((bytes, count))
}

fn decode(block: &Block, columns: usize) -> Result<Vec<Vec<f64>>> {
    let (bytes, count) = unpacked(block, columns)?;
    let (values, _) = bytes.as_chunks::<8>();
    let row = |row: usize| {
        let value = |column: usize| f64::from_le_bytes(values[column * count + row]);
        (0..columns).map(value).collect()
    };
    Ok((0..count).map(row).collect())
}
