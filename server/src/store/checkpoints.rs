//! Checkpoints of a job: the two newest are kept until it has a result or is deleted.
//!
//! A worker goes on from the newest that its own build has made, since results come from one build. One
//! whose bytes or files are missing or have changed is forgotten, and there is the one before.
use loadframe_api::worker::{CheckpointInfo, CheckpointQuery};
use tokio::io::AsyncRead;

use super::blobs::FileGuard;
use super::database::{Connection, Query, Row, first_column, query, query_as, query_scalar, row};
use super::encoding::entry;
use super::error::{Result, StoreError};
use super::lease::LeasedAttempt;
use super::state::LifecycleRow;
use super::storage::Content;
use super::writer::Change;
use super::{LeaseKey, Store};

/// Largest checkpoint [bytes].
pub(super) const LARGEST_CHECKPOINT: u64 = 16 << 30;
/// Checkpoints kept of a job.
const KEPT: u32 = 2;

row! {
    /// A checkpoint.
    #[derive(Clone, Debug)]
    pub(super) struct CheckpointRow {
        /// Higher ones are newer.
        pub(super) seq: i64,
        bytes: i64,
        sha256: String,
        pub(super) wall_s: f64,
        cpu_s: f64,
    }
}

impl CheckpointRow {
    /// The newest checkpoint of the job that a worker of the build `engine` can go on from; before the
    /// one of content `before`, if given.
    pub(super) async fn newest(
        connection: &mut Connection,
        job: i64,
        engine: &str,
        before: Option<&str>,
    ) -> Result<Option<Self>> {
        let newest = query_as(
            "SELECT seq, bytes, sha256, wall_s, cpu_s FROM checkpoints
             WHERE job = ?1 AND engine IN ('', ?2) AND (?3 IS NULL OR seq <
                (SELECT MAX(seq) FROM checkpoints WHERE job = ?1 AND sha256 = ?3))
             ORDER BY seq DESC LIMIT 1",
        );
        let newest = newest.bind(job).bind(engine).bind(before);
        Ok(newest.fetch_optional(connection).await?)
    }

    /// What a worker is told of it.
    pub(super) async fn info(&self, connection: &mut Connection) -> Result<CheckpointInfo> {
        let files: Vec<(String, i64, String)> =
            query_as("SELECT name, bytes, sha256 FROM checkpoint_files WHERE checkpoint = ?")
                .bind(self.seq)
                .fetch_all(connection)
                .await?;
        Ok(CheckpointInfo {
            bytes: self.bytes.unsigned_abs(),
            sha256: self.sha256.clone(),
            files: files.into_iter().map(entry).collect(),
            wall_s: self.wall_s,
            cpu_s: self.cpu_s,
        })
    }
}

/// Contents of one checkpoint of a job, or of all.
pub(super) fn checkpoint_contents(job: i64, one: Option<i64>) -> Query {
    let contents = query(
        "SELECT sha256 FROM checkpoints WHERE job = ?1 AND (?2 IS NULL OR seq = ?2)
         UNION SELECT f.sha256 FROM checkpoint_files f
            JOIN checkpoints c ON c.seq = f.checkpoint
            WHERE c.job = ?1 AND (?2 IS NULL OR c.seq = ?2)",
    );
    contents.bind(job).bind(one)
}

/// Refuses times that no work takes.
pub(super) fn check_times(query: &CheckpointQuery) -> Result<()> {
    let is_wrong = |time: &f64| !time.is_finite() || *time < 0.0;
    if [query.wall_s, query.cpu_s].iter().any(is_wrong) {
        let sentence = "wall_s and cpu_s are finite and not negative";
        return Err(StoreError::Invalid(sentence.to_owned()));
    }
    Ok(())
}

impl Store {
    /// Takes in a checkpoint, to which all files uploaded so far by this attempt belong. One that is
    /// further than those before forgives the job the workers it has lost.
    ///
    /// # Errors
    /// As [`Self::upload`].
    pub async fn save_checkpoint(
        &self,
        key: LeaseKey,
        query: &CheckpointQuery,
        body: impl AsyncRead + Send + Unpin,
    ) -> Result<CheckpointInfo> {
        check_times(query)?;
        self.check_lease(key).await?;
        let received = self
            .received(
                "a checkpoint",
                &query.sha256,
                LARGEST_CHECKPOINT,
                None,
                body,
            )
            .await?;
        let bytes = received.bytes;
        let guard = self.blobs().keep(received).await;
        let guard = guard.map_err(|error| self.noted(error))?;
        self.name_checkpoint(key, query, bytes, guard).await
    }

    /// Names a checkpoint whose bytes are in their place.
    pub(super) async fn name_checkpoint(
        &self,
        key: LeaseKey,
        query: &CheckpointQuery,
        bytes: u64,
        guard: FileGuard,
    ) -> Result<CheckpointInfo> {
        let (row, lease) = (query.clone(), self.lease_millis());
        let (info, guard) = self
            .write(move |change| {
                Box::pin(async move {
                    let info = change.set_checkpoint(key, lease, &row, bytes).await?;
                    Ok((info, guard))
                })
            })
            .await?;
        guard.named();
        Ok(info)
    }

    /// The checkpoint that the attempt goes on from, and its bytes: the newest, or the one
    /// before that of content `before`, which its worker could not use. One of which something is
    /// missing or has changed is forgotten, and the job's log tells what follows.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`]; [`StoreError::NotFound`] when there is none.
    pub async fn checkpoint(
        &self,
        key: LeaseKey,
        before: Option<&str>,
    ) -> Result<(CheckpointInfo, Content)> {
        if let Some(unusable) = before {
            self.pass_over(key, unusable.to_owned()).await?;
        }
        loop {
            let mut snapshot = self.reads().begin().await?;
            let attempt = LeasedAttempt::live(&mut snapshot, key).await?;
            let job = LifecycleRow::of(&mut snapshot, attempt.job).await?;
            let newest =
                CheckpointRow::newest(&mut snapshot, job.seq, &attempt.engine, before).await?;
            let Some(newest) = newest else {
                return Err(StoreError::NotFound("checkpoint to go on from".to_owned()));
            };
            let info = newest.info(&mut snapshot).await?;
            drop(snapshot);
            let why = match self.usable(&info).await? {
                Ok(content) => return Ok((info, content)),
                Err(why) => why,
            };
            tracing::error!(job_id = %attempt.job, "{why}");
            self.forget(key, newest, why, before.map(str::to_owned))
                .await?;
        }
    }

    /// The bytes of a checkpoint, having held them and its files against their SHA-256; or what is wrong.
    async fn usable(&self, info: &CheckpointInfo) -> Result<Result<Content, String>> {
        let own = self.blobs().verified(&info.sha256, info.bytes).await?;
        let content = match own {
            Ok(content) => content,
            Err(loss) => return Ok(Err(format!("the checkpoint {loss}"))),
        };
        for file in &info.files {
            if let Err(loss) = self.blobs().verified(&file.sha256, file.bytes).await? {
                return Ok(Err(format!("{} of the checkpoint {loss}", file.name)));
            }
        }
        Ok(Ok(content))
    }

    /// Removes a checkpoint that cannot be used; the attempt goes on from the one before.
    async fn forget(
        &self,
        key: LeaseKey,
        broken: CheckpointRow,
        why: String,
        before: Option<String>,
    ) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let attempt = LeasedAttempt::live(&mut change.connection, key).await?;
                let job = LifecycleRow::of(&mut change.connection, attempt.job).await?;
                change
                    .leave_files(&attempt, &broken.sha256, job.seq)
                    .await?;
                change.remove_checkpoints(job.seq, Some(broken.seq)).await?;
                let then = match change.go_on(&attempt, job.seq, before.as_deref()).await? {
                    true => "the job goes on from the one before",
                    false => "the job begins anew",
                };
                let line = format!("{why}; {then}");
                change.append_log(&job, attempt.number, &[line]).await
            })
        })
        .await
    }

    /// Lets the attempt go on from the checkpoint before the one of this content, which stays.
    async fn pass_over(&self, key: LeaseKey, unusable: String) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let attempt = LeasedAttempt::live(&mut change.connection, key).await?;
                let job = LifecycleRow::of(&mut change.connection, attempt.job).await?;
                change.leave_files(&attempt, &unusable, job.seq).await?;
                change.go_on(&attempt, job.seq, Some(&unusable)).await?;
                Ok(())
            })
        })
        .await
    }
}

impl Change {
    /// Takes from the attempt the files that it got with a checkpoint.
    async fn leave_files(&mut self, attempt: &LeasedAttempt, sha256: &str, job: i64) -> Result<()> {
        query(
            "DELETE FROM attempt_files WHERE attempt = ?1 AND EXISTS (
                SELECT 1 FROM checkpoint_files f JOIN checkpoints c ON c.seq = f.checkpoint
                WHERE c.job = ?2 AND c.sha256 = ?3
                  AND f.name = attempt_files.name AND f.sha256 = attempt_files.sha256)",
        )
        .bind(attempt.seq)
        .bind(job)
        .bind(sha256)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }

    /// Lets the attempt go on from the newest checkpoint (before `before`), if there is one.
    async fn go_on(
        &mut self,
        attempt: &LeasedAttempt,
        job: i64,
        before: Option<&str>,
    ) -> Result<bool> {
        let engine = &attempt.engine;
        let from = CheckpointRow::newest(&mut self.connection, job, engine, before).await?;
        let wall_s = from.as_ref().map_or(0.0, |from| from.wall_s);
        query("UPDATE attempts SET resumed_wall_s = ? WHERE seq = ?")
            .bind(wall_s)
            .bind(attempt.seq)
            .execute(&mut self.connection)
            .await?;
        if let Some(from) = &from {
            self.carry_over(attempt.seq, from).await?;
        }
        Ok(from.is_some())
    }

    /// Carries the files of a checkpoint over to an attempt.
    pub(super) async fn carry_over(&mut self, attempt: i64, from: &CheckpointRow) -> Result<()> {
        query(
            "INSERT INTO attempt_files (attempt, name, bytes, sha256)
             SELECT ?, name, bytes, sha256 FROM checkpoint_files WHERE checkpoint = ?",
        )
        .bind(attempt)
        .bind(from.seq)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }

    /// Tells in the job's log when there are checkpoints, but of other builds than the worker's.
    pub(super) async fn tell_of_other_builds(
        &mut self,
        job: &LifecycleRow,
        attempt: u32,
        engine: &str,
    ) -> Result<()> {
        let other: Option<String> =
            query_scalar("SELECT engine FROM checkpoints WHERE job = ? ORDER BY seq DESC LIMIT 1")
                .bind(job.seq)
                .fetch_optional(&mut self.connection)
                .await?;
        let Some(other) = other else {
            return Ok(());
        };
        let line = format!(
            "the checkpoint is of build {other}, this worker is {engine}: it begins anew, as results come from one build"
        );
        self.append_log(job, attempt, &[line]).await
    }

    async fn set_checkpoint(
        &mut self,
        key: LeaseKey,
        lease: i64,
        sent: &CheckpointQuery,
        bytes: u64,
    ) -> Result<CheckpointInfo> {
        let (attempt, job) = self.extend(key, lease).await?;
        if self.is_late(&attempt, job.seq, sent).await? {
            self.garbage([sent.sha256.clone()]);
            return self.newest_info(&attempt, job.seq).await;
        }
        self.forgive_if_further(job.seq, sent.wall_s).await?;
        let seq: i64 = query_scalar(
            "INSERT INTO checkpoints (job, attempt, bytes, sha256, wall_s, cpu_s, engine, points)
             VALUES (?, ?, ?, ?, ?, ?, ?, ?) RETURNING seq",
        )
        .bind(job.seq)
        .bind(attempt.seq)
        .bind(i64::try_from(bytes).unwrap_or(i64::MAX))
        .bind(&sent.sha256)
        .bind(sent.wall_s)
        .bind(sent.cpu_s)
        .bind(&attempt.engine)
        // a worker sends a checkpoint after all points before it
        .bind(attempt.points)
        .fetch_one(&mut self.connection)
        .await?;
        query(
            "INSERT INTO checkpoint_files (checkpoint, name, bytes, sha256)
             SELECT ?, name, bytes, sha256 FROM attempt_files WHERE attempt = ?",
        )
        .bind(seq)
        .bind(attempt.seq)
        .execute(&mut self.connection)
        .await?;
        let oldest: Option<i64> = query_scalar(
            "SELECT seq FROM checkpoints WHERE job = ? ORDER BY seq DESC LIMIT 1 OFFSET ?",
        )
        .bind(job.seq)
        .bind(KEPT)
        .fetch_optional(&mut self.connection)
        .await?;
        if oldest.is_some() {
            self.remove_checkpoints(job.seq, oldest).await?;
        }
        self.newest_info(&attempt, job.seq).await
    }

    async fn newest_info(&mut self, attempt: &LeasedAttempt, job: i64) -> Result<CheckpointInfo> {
        let newest =
            CheckpointRow::newest(&mut self.connection, job, &attempt.engine, None).await?;
        let newest = newest.ok_or(StoreError::Unavailable)?;
        newest.info(&mut self.connection).await
    }

    /// Whether the attempt has left this checkpoint or a later one already: a message that was sent again, or
    /// was under way for long.
    async fn is_late(
        &mut self,
        attempt: &LeasedAttempt,
        job: i64,
        query: &CheckpointQuery,
    ) -> Result<bool> {
        let is_late = query_scalar(
            "SELECT EXISTS (SELECT 1 FROM checkpoints
                            WHERE job = ? AND attempt = ? AND (wall_s > ? OR sha256 = ?))",
        )
        .bind(job)
        .bind(attempt.seq)
        .bind(query.wall_s)
        .bind(&query.sha256)
        .fetch_one(&mut self.connection)
        .await?;
        Ok(is_late)
    }

    /// What has come further since may have been the machines' fault, not the job's. One that begins
    /// anew has to pass what it had before.
    async fn forgive_if_further(&mut self, job: i64, wall_s: f64) -> Result<()> {
        let before: Option<f64> = query_scalar("SELECT MAX(wall_s) FROM checkpoints WHERE job = ?")
            .bind(job)
            .fetch_one(&mut self.connection)
            .await?;
        if before.is_some_and(|before| wall_s <= before) {
            return Ok(());
        }
        for statement in [
            "UPDATE jobs SET losses = 0 WHERE seq = ? AND losses > 0",
            "DELETE FROM job_faults WHERE job = ?",
        ] {
            query(statement)
                .bind(job)
                .execute(&mut self.connection)
                .await?;
        }
        Ok(())
    }

    /// Removes one checkpoint of a job, or all.
    pub(super) async fn remove_checkpoints(&mut self, job: i64, one: Option<i64>) -> Result<()> {
        let files = checkpoint_contents(job, one)
            .fetch_all(&mut self.connection)
            .await?;
        self.remove_found_checkpoints(job, one, &files).await
    }

    /// The same where what [`checkpoint_contents`] gives is known.
    pub(super) async fn remove_found_checkpoints(
        &mut self,
        job: i64,
        one: Option<i64>,
        files: &[Row],
    ) -> Result<()> {
        if !files.is_empty() {
            self.garbage(first_column::<String>(files)?);
            query("DELETE FROM checkpoints WHERE job = ?1 AND (?2 IS NULL OR seq = ?2)")
                .bind(job)
                .bind(one)
                .execute(&mut self.connection)
                .await?;
        }
        Ok(())
    }
}
