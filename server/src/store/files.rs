//! Result files: taken in from workers, given out to everybody.
use loadframe_api::{FileEntry, PARTIAL_FOLDER, check_file_name};
use tokio::io::AsyncRead;
use uuid::Uuid;

use super::arriving::Received;
use super::blobs::FileGuard;
use super::database::{first_column, query, query_as, query_scalar};
use super::encoding::entry;
use super::error::{Result, StoreError};
use super::lease::LeasedAttempt;
use super::reserve::admit;
use super::state::LifecycleRow;
use super::storage::Content;
use super::writer::Change;
use super::{LeaseKey, Store};

/// Largest result file [bytes].
pub(super) const LARGEST_FILE: u64 = 8 << 30;

/// Accepts names of result files but for those in the folder of failed attempts, where an attempt that fails has its
/// files put: two would have one name.
pub(super) fn check_upload_name(name: &str) -> Result<()> {
    check_file_name(name).map_err(|error| StoreError::Invalid(error.to_string()))?;
    if name.starts_with(PARTIAL_FOLDER) {
        let sentence = format!("{name}: {PARTIAL_FOLDER} is for the files of failed attempts");
        return Err(StoreError::Invalid(sentence));
    }
    Ok(())
}

impl Store {
    /// Takes in a result file. It belongs to the attempt, and to the job only after `complete`.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`]; [`StoreError::Invalid`] for a bad name or another content than
    /// `sha256` says; [`StoreError::TooLarge`]; [`StoreError::Interrupted`].
    pub async fn upload(
        &self,
        key: LeaseKey,
        name: &str,
        sha256: &str,
        body: impl AsyncRead + Send + Unpin,
    ) -> Result<FileEntry> {
        self.upload_rest(key, name, sha256, 0, body).await
    }

    /// The same of a file whose first `from` bytes have arrived before ([`Self::uploaded_part`]).
    ///
    /// # Errors
    /// As [`Self::upload`]; [`StoreError::Unavailable`] when not so many bytes of it are kept.
    pub async fn upload_rest(
        &self,
        key: LeaseKey,
        name: &str,
        sha256: &str,
        from: u64,
        body: impl AsyncRead + Send + Unpin,
    ) -> Result<FileEntry> {
        check_upload_name(name)?;
        self.check_lease(key).await?;
        let arriving = Some((key.id, from));
        let received = self
            .received("a file", sha256, LARGEST_FILE, arriving, body)
            .await?;
        let entry = FileEntry {
            name: name.to_owned(),
            bytes: received.bytes,
            sha256: received.sha256.clone(),
        };
        let guard = self.blobs().keep(received).await;
        let guard = guard.map_err(|error| self.noted(error))?;
        self.name_file(key, &entry, guard).await?;
        Ok(entry)
    }

    /// Names a file whose bytes are in their place.
    pub(super) async fn name_file(
        &self,
        key: LeaseKey,
        entry: &FileEntry,
        guard: FileGuard,
    ) -> Result<()> {
        let (row, lease) = (entry.clone(), self.lease_millis());
        let guard = self
            .write(move |change| {
                Box::pin(async move {
                    change.add_file(key, lease, &row).await?;
                    Ok(guard)
                })
            })
            .await?;
        guard.named();
        Ok(())
    }

    /// Bytes that are kept of an upload of this content that broke off under this lease.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`].
    pub async fn uploaded_part(&self, key: LeaseKey, sha256: &str) -> Result<u64> {
        self.check_lease(key).await?;
        if sha256.len() != 64 || !sha256.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return Ok(0);
        }
        Ok(self.blobs().incoming.part_bytes(key.id, sha256).await)
    }

    /// Files of the job's result, or of the failure that ended it, which are in a folder that says
    /// so; none before its end.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] when there is no such job.
    pub async fn files(&self, id: Uuid) -> Result<Vec<FileEntry>> {
        let mut snapshot = self.reads().begin().await?;
        let job = LifecycleRow::of(&mut snapshot, id).await?;
        let files: Vec<(String, i64, String)> = query_as(
            "SELECT f.name, f.bytes, f.sha256
             FROM jobs j LEFT JOIN results r ON r.job = j.seq
             JOIN attempts a ON a.job = j.seq
                AND a.number = COALESCE(r.attempt, CASE WHEN j.outcome IN ('failed', 'timed_out') THEN j.attempt END)
             JOIN attempt_files f ON f.attempt = a.seq
             WHERE j.seq = ? AND f.removed_at IS NULL ORDER BY f.name",
        )
        .bind(job.seq)
        .fetch_all(&mut snapshot)
        .await?;
        Ok(files.into_iter().map(entry).collect())
    }

    /// The bytes of a file of the job's result, having held them against its SHA-256.
    ///
    /// # Errors
    /// [`StoreError::Lost`] when they are missing or have changed.
    pub async fn content(&self, id: Uuid, file: &FileEntry) -> Result<Content> {
        let verified = self.blobs().verified(&file.sha256, file.bytes).await?;
        verified.map_err(|loss| StoreError::Lost {
            job: id,
            file: file.name.clone(),
            loss,
        })
    }

    /// One of these files.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn file(&self, id: Uuid, name: &str) -> Result<FileEntry> {
        let found: Option<(String, i64, String)> = query_as(
            "SELECT f.name, f.bytes, f.sha256
             FROM jobs j LEFT JOIN results r ON r.job = j.seq
             JOIN attempts a ON a.job = j.seq
                AND a.number = COALESCE(r.attempt, CASE WHEN j.outcome IN ('failed', 'timed_out') THEN j.attempt END)
             JOIN attempt_files f ON f.attempt = a.seq
             WHERE j.id = ? AND f.name = ? AND f.removed_at IS NULL",
        )
        .bind(id)
        .bind(name)
        .fetch_optional(self.reads())
        .await?;
        let found =
            found.ok_or_else(|| StoreError::NotFound(format!("file {name} of job {id}")))?;
        Ok(entry(found))
    }

    /// `outcome.json` of a succeeded job.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn outcome(&self, id: Uuid) -> Result<String> {
        query_scalar("SELECT r.outcome FROM results r JOIN jobs j ON j.seq = r.job WHERE j.id = ?")
            .bind(id)
            .fetch_optional(self.reads())
            .await?
            .ok_or_else(|| StoreError::NotFound(format!("outcome of job {id}")))
    }

    /// Takes in a body while there is room for it; `part` is the lease under which its rest may follow,
    /// and how many of its bytes came before.
    pub(super) async fn received(
        &self,
        what: &'static str,
        sha256: &str,
        limit: u64,
        part: Option<(Uuid, u64)>,
        body: impl AsyncRead + Send + Unpin,
    ) -> Result<Received> {
        admit(&self.0.reserve)?;
        let received = self.blobs().receive(what, sha256, limit, part, body).await;
        received.map_err(|error| self.noted(error))
    }

    /// Refuses a stale worker before its body is taken in.
    pub(super) async fn check_lease(&self, key: LeaseKey) -> Result<()> {
        let mut connection = self.lookups().acquire().await?;
        LeasedAttempt::live(&mut connection, key).await?;
        Ok(())
    }
}

impl Change {
    async fn add_file(&mut self, key: LeaseKey, lease: i64, file: &FileEntry) -> Result<()> {
        let replaced = query(
            "SELECT f.sha256 FROM attempt_files f JOIN attempts a ON a.seq = f.attempt
             WHERE a.id = ?1 AND a.token = ?2 AND a.ended_at IS NULL AND f.name = ?3",
        )
        .bind(key.id)
        .bind(key.token)
        .bind(&file.name);
        let added = query(
            "INSERT INTO attempt_files (attempt, name, bytes, sha256)
             SELECT seq, ?3, ?4, ?5 FROM attempts WHERE id = ?1 AND token = ?2 AND ended_at IS NULL",
        )
        .bind(key.id)
        .bind(key.token)
        .bind(&file.name)
        .bind(i64::try_from(file.bytes).unwrap_or(i64::MAX))
        .bind(&file.sha256);
        let (_, _, rows) = self.extend_and(key, lease, [replaced, added]).await?;
        for rows in &rows {
            self.garbage(first_column::<String>(rows)?);
        }
        Ok(())
    }
}
