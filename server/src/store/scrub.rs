//! Holding every stored file against its SHA-256: what is missing, what has changed.
use std::sync::atomic::Ordering;
use std::time::Duration;

use futures_util::future::BoxFuture;
use serde::Serialize;
use uuid::Uuid;

use super::Store;
use super::collector;
use super::database::{Connection, query_as, row};
use super::error::Loss;
use super::error::Result;

/// Files looked up at a time.
const FILES_AT_ONCE: u32 = 500;
/// The first look after a start, so that those who start are not held up.
const FIRST: Duration = Duration::from_secs(600);
/// Between two looks through everything.
const BETWEEN: Duration = Duration::from_secs(24 * 3600);
/// How fast files are read in the background [bytes/s]: a terabyte takes a day.
const PACE: f64 = 12e6;

/// A file of a job that cannot be given out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LostFile {
    pub job: Uuid,
    /// Its name, or `checkpoint`.
    pub file: String,
    pub sha256: String,
    pub loss: Loss,
}

/// What a look through all files found.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ScrubReport {
    /// Stored files that were held against their names, and their bytes.
    pub files: u64,
    pub bytes: u64,
    pub lost: Vec<LostFile>,
    /// Stored files that no job names.
    pub unnamed: u64,
}

row! {
    /// Content that rows name, once however many do.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub(super) struct Content {
        pub(super) sha256: String,
        pub(super) bytes: i64,
    }
}

impl Content {
    /// Those after `last` in order, some at a time.
    pub(super) async fn after(connection: &mut Connection, last: &str) -> Result<Vec<Self>> {
        let all = query_as(
            "SELECT sha256, bytes FROM (
                SELECT sha256, bytes FROM attempt_files WHERE sha256 > ?1
                UNION SELECT sha256, bytes FROM checkpoint_files WHERE sha256 > ?1
                UNION SELECT sha256, bytes FROM checkpoints WHERE sha256 > ?1
                UNION SELECT sha256, bytes FROM trashed_attempt_files WHERE sha256 > ?1
                UNION SELECT sha256, bytes FROM trashed_checkpoint_files WHERE sha256 > ?1
                UNION SELECT sha256, bytes FROM trashed_checkpoints WHERE sha256 > ?1) contents
             ORDER BY sha256 LIMIT ?2",
        );
        let all = all.bind(last).bind(FILES_AT_ONCE);
        Ok(all.fetch_all(connection).await?)
    }

    /// Jobs and names of files with this content.
    pub(super) async fn owners(&self, connection: &mut Connection) -> Result<Vec<(Uuid, String)>> {
        let owners = query_as(
            "SELECT j.id, f.name FROM attempt_files f JOIN attempts a ON a.seq = f.attempt
                JOIN jobs j ON j.seq = a.job WHERE f.sha256 = ?1
             UNION SELECT j.id, f.name FROM checkpoint_files f
                JOIN checkpoints k ON k.seq = f.checkpoint JOIN jobs j ON j.seq = k.job
                WHERE f.sha256 = ?1
             UNION SELECT j.id, 'checkpoint' FROM checkpoints c JOIN jobs j ON j.seq = c.job
                WHERE c.sha256 = ?1
             UNION SELECT j.id, f.name FROM trashed_attempt_files f
                JOIN trashed_attempts a ON a.seq = f.attempt JOIN trash j ON j.job = a.job
                WHERE f.sha256 = ?1
             UNION SELECT j.id, f.name FROM trashed_checkpoint_files f
                JOIN trashed_checkpoints k ON k.seq = f.checkpoint JOIN trash j ON j.job = k.job
                WHERE f.sha256 = ?1
             UNION SELECT j.id, 'checkpoint' FROM trashed_checkpoints c
                JOIN trash j ON j.job = c.job WHERE c.sha256 = ?1
             ORDER BY 1, 2",
        );
        Ok(owners.bind(&self.sha256).fetch_all(connection).await?)
    }

    /// Its owners, as having lost it.
    pub(super) async fn lost(
        &self,
        connection: &mut Connection,
        loss: Loss,
    ) -> Result<Vec<LostFile>> {
        let owners = self.owners(connection).await?.into_iter();
        let lost = owners.map(|(job, file)| LostFile {
            job,
            file,
            sha256: self.sha256.clone(),
            loss,
        });
        Ok(lost.collect())
    }
}

impl Store {
    /// Holds every stored file that a job names against its SHA-256, sets aside those that have changed,
    /// and tells whose they are. Reads at most `pace` [bytes/s] where one is given.
    ///
    /// # Errors
    /// The database's and the folder's.
    pub fn scrub(&self, pace: Option<f64>) -> BoxFuture<'_, Result<ScrubReport>> {
        // boxed, it is compiled once and not again in everything that awaits it
        Box::pin(async move {
            let mut report = ScrubReport::default();
            let mut last = String::new();
            loop {
                let mut connection = self.reads().acquire().await?;
                let contents = Content::after(&mut connection, &last).await?;
                drop(connection);
                let Some(end) = contents.last() else {
                    break;
                };
                last.clone_from(&end.sha256);
                for content in contents {
                    let bytes = content.bytes.unsigned_abs();
                    let found = self.blobs().examine(&content.sha256, bytes).await?;
                    report.files += 1;
                    report.bytes += bytes;
                    if let Some(loss) = found {
                        // what was deleted meanwhile has no owners any more
                        let mut connection = self.reads().acquire().await?;
                        report
                            .lost
                            .extend(content.lost(&mut connection, loss).await?);
                    }
                    if let Some(pace) = pace {
                        tokio::time::sleep(Duration::from_secs_f64(bytes as f64 / pace)).await;
                    }
                }
            }
            let storage = &self.blobs().storage;
            report.unnamed = collector::count_unnamed(storage, self.reads()).await?;
            let lost = report.lost.len() as u64;
            self.blobs().faults.lost.store(lost, Ordering::Relaxed);
            Ok(report)
        })
    }

    /// Lets files that no job names, and that wait for days or for a person, be removed when the folder
    /// is next looked through: by a running server within the hour, or when one starts.
    ///
    /// # Errors
    /// The database's and the folder's.
    pub async fn release_unnamed(&self) -> Result<()> {
        collector::release(&self.blobs().storage, self.reads()).await
    }

    /// Scrubs slowly and again and again, until dropped.
    pub async fn keep_scrubbing(self) {
        tokio::time::sleep(FIRST).await;
        loop {
            match self.scrub(Some(PACE)).await {
                Ok(report) => {
                    for lost in &report.lost {
                        let LostFile {
                            job, file, loss, ..
                        } = lost;
                        tracing::error!(job_id = %job, file, "a stored file {loss}");
                    }
                    let (files, lost) = (report.files, report.lost.len());
                    tracing::info!(
                        files,
                        lost,
                        unnamed = report.unnamed,
                        "all stored files were read"
                    );
                }
                Err(error) => tracing::error!(%error, "the stored files could not be read"),
            }
            tokio::time::sleep(BETWEEN).await;
        }
    }
}
