//! The folder of files: bytes under their SHA-256, written once, removed when no row names them.
//!
//! A file arrives under a temporary name, is hashed on its way, made durable, renamed, and its
//! folder made durable; only then may a row name it. Between the renaming and the commit of that
//! row the bytes look forgotten, so whoever stores a file holds a [`FileGuard`] until its row is safe,
//! and the collector removes nothing while anybody does.
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};
use sqlx::SqlitePool;
use tempfile::{NamedTempFile, TempPath};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWriteExt};
use tokio::sync::{OwnedRwLockReadGuard, RwLock, mpsc, oneshot};
use tokio::task::spawn_blocking;

use super::encoding::json;
use super::error::{Result, StoreError};

/// Bytes read and written at a time.
const CHUNK: usize = 256 << 10;
/// Names looked up at a time.
const NAMES_AT_ONCE: usize = 500;

/// The folder.
#[derive(Clone, Debug)]
pub(super) struct Blobs {
    root: PathBuf,
    incoming: PathBuf,
    in_use: Arc<RwLock<()>>,
    garbage: mpsc::UnboundedSender<Garbage>,
}

/// Work for the collector.
#[derive(Debug)]
pub(super) enum Garbage {
    /// These may be named by no row any more.
    Perhaps(Vec<String>),
    /// Any of all the files may be.
    PerhapsAny,
    /// Tell when all before is done.
    Barrier(oneshot::Sender<()>),
}

/// A file that has arrived whole, still under its temporary name.
#[derive(Debug)]
pub(super) struct Received {
    path: TempPath,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

/// While it lives, no file is removed.
#[derive(Debug)]
pub(super) struct FileGuard(#[allow(dead_code)] OwnedRwLockReadGuard<()>);

impl Blobs {
    /// Prepares the folders in `data`.
    pub(super) async fn open(data: &Path, garbage: mpsc::UnboundedSender<Garbage>) -> Result<Self> {
        let blobs = Self {
            root: data.join("blobs"),
            incoming: data.join("incoming"),
            in_use: Arc::default(),
            garbage,
        };
        let (root, incoming) = (blobs.root.clone(), blobs.incoming.clone());
        blocking(data, move || {
            std::fs::create_dir_all(&incoming)?;
            // all folders at once, so that storing a file makes no folder durable but its own
            for byte in 0..=u8::MAX {
                std::fs::create_dir_all(root.join(format!("{byte:02x}")))?;
            }
            sync_folder(&root)
        })
        .await?;
        Ok(blobs)
    }

    /// Removes what a crash left: half-received files now, stored ones without a row soon.
    pub(super) async fn recover(&self) -> Result<()> {
        let incoming = self.incoming.clone();
        blocking(&self.incoming, move || {
            for entry in std::fs::read_dir(incoming)? {
                std::fs::remove_file(entry?.path())?;
            }
            Ok(())
        })
        .await?;
        let _ = self.garbage.send(Garbage::PerhapsAny);
        Ok(())
    }

    /// Where the bytes of `sha256` are.
    pub(super) fn path(&self, sha256: &str) -> PathBuf {
        let folder = sha256.get(..2).unwrap_or_default();
        self.root.join(folder).join(sha256)
    }

    /// Takes in a body of at most `limit` bytes that must hash to `sha256`.
    ///
    /// # Errors
    /// [`StoreError::Invalid`], [`StoreError::TooLarge`], [`StoreError::Interrupted`] by the
    /// sender's fault; [`StoreError::File`] by the disk's.
    pub(super) async fn receive(
        &self,
        what: &'static str,
        sha256: &str,
        limit: u64,
        mut body: impl AsyncRead + Send + Unpin,
    ) -> Result<Received> {
        if sha256.len() != 64
            || !sha256
                .bytes()
                .all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
        {
            let sentence = "sha256 is 64 lower-case hexadecimal digits";
            return Err(StoreError::Invalid(sentence.to_owned()));
        }
        let folder = self.incoming.clone();
        let (file, path) = blocking(&self.incoming, || NamedTempFile::new_in(folder))
            .await?
            .into_parts();
        let failed = || StoreError::file(&self.incoming);
        let mut file = tokio::fs::File::from_std(file);
        let mut hash = Sha256::new();
        let mut bytes = 0;
        let mut chunk = vec![0; CHUNK];
        loop {
            let count = body
                .read(&mut chunk)
                .await
                .map_err(StoreError::Interrupted)?;
            if count == 0 {
                break;
            }
            bytes += count as u64;
            if bytes > limit {
                return Err(StoreError::TooLarge { what, limit });
            }
            hash.update(&chunk[..count]);
            file.write_all(&chunk[..count]).await.map_err(failed())?;
        }
        let found: String = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        if found != sha256 {
            let sentence = format!("the body's SHA-256 is {found}, the query says {sha256}");
            return Err(StoreError::Invalid(sentence));
        }
        file.flush().await.map_err(failed())?;
        file.sync_all().await.map_err(failed())?;
        Ok(Received {
            path,
            bytes,
            sha256: found,
        })
    }

    /// Puts a received file in its place. It stays there while the [`FileGuard`] is held.
    pub(super) async fn keep(&self, received: Received) -> Result<FileGuard> {
        let guard = FileGuard(self.in_use.clone().read_owned().await);
        let place = self.path(&received.sha256);
        blocking(&self.path(&received.sha256), move || {
            // the same content may be there already, and then it is as durable as this
            if !place.exists() {
                received.path.persist(&place)?;
                sync_folder(place.parent().unwrap_or(&place))?;
            }
            Ok(())
        })
        .await?;
        Ok(guard)
    }

    /// Reports files that may be named by no row.
    pub(super) fn report_unnamed(&self, names: Vec<String>) {
        // without a collector the store is closing, and the next start collects
        let _ = self.garbage.send(Garbage::Perhaps(names));
    }

    /// Waits until what was reported as garbage before is removed.
    pub(super) async fn collected(&self) {
        let (done, wait) = oneshot::channel();
        if self.garbage.send(Garbage::Barrier(done)).is_ok() {
            let _ = wait.await;
        }
    }

    /// Removes what no row names, as it is reported; ends with the last reporter.
    pub(super) fn collector(
        &self,
        reads: SqlitePool,
        mut reports: mpsc::UnboundedReceiver<Garbage>,
    ) -> impl Future<Output = ()> + Send + use<> {
        // not the whole of `self`: that can report, and would keep the collector alive
        let (root, in_use) = (self.root.clone(), self.in_use.clone());
        async move {
            while let Some(report) = reports.recv().await {
                let names = match report {
                    Garbage::Perhaps(names) => Ok(names),
                    Garbage::PerhapsAny => every_name(&root).await,
                    Garbage::Barrier(done) => {
                        // whoever waited may have gone
                        let _ = done.send(());
                        continue;
                    }
                };
                let removed = match names {
                    Ok(names) => remove_unnamed(&root, &reads, &in_use, &names).await,
                    Err(error) => Err(error),
                };
                if let Err(error) = removed {
                    tracing::error!(%error, "files without a row stay for now");
                }
            }
        }
    }
}

/// Names of all files in the folder.
async fn every_name(root: &Path) -> Result<Vec<String>> {
    let folder = root.to_owned();
    blocking(root, move || {
        let mut names = Vec::new();
        for folder in std::fs::read_dir(folder)? {
            for file in std::fs::read_dir(folder?.path())? {
                names.extend(file?.file_name().into_string());
            }
        }
        Ok(names)
    })
    .await
}

/// Removes those of the files that no row names.
async fn remove_unnamed(
    root: &Path,
    reads: &SqlitePool,
    in_use: &RwLock<()>,
    names: &[String],
) -> Result<()> {
    for names in names.chunks(NAMES_AT_ONCE) {
        let alone = in_use.write().await;
        remove_unnamed_alone(root, reads, names).await?;
        drop(alone);
    }
    Ok(())
}

/// The same while nobody stores a file.
async fn remove_unnamed_alone(root: &Path, reads: &SqlitePool, names: &[String]) -> Result<()> {
    let forgotten: Vec<String> = sqlx::query_scalar(
        "SELECT value FROM json_each(?)
         WHERE NOT EXISTS (SELECT 1 FROM attempt_files WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM checkpoint_files WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM checkpoints WHERE sha256 = value)",
    )
    .bind(json(&names)?)
    .fetch_all(reads)
    .await?;
    let folder = root.to_owned();
    blocking(root, move || {
        for name in forgotten {
            let path = folder.join(name.get(..2).unwrap_or_default()).join(name);
            match std::fs::remove_file(path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    })
    .await
}

/// Makes the names in a folder durable.
fn sync_folder(folder: &Path) -> std::io::Result<()> {
    std::fs::File::open(folder)?.sync_all()
}

/// Runs file work where it may block.
async fn blocking<T: Send + 'static>(
    path: &Path,
    work: impl FnOnce() -> std::io::Result<T> + Send + 'static,
) -> Result<T> {
    match spawn_blocking(work).await {
        Ok(done) => done.map_err(StoreError::file(path)),
        Err(_) => Err(StoreError::Unavailable),
    }
}
