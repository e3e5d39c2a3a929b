//! The folder of files: bytes under their SHA-256, written once, removed when no row names them.
//!
//! A file arrives under a temporary name, is hashed on its way, made durable, renamed, and its
//! folder made durable; only then may a row name it. Between the renaming and the commit of that
//! row the bytes look forgotten, so whoever stores a file holds a [`FileGuard`] until its row is safe,
//! and the collector removes nothing while anybody does.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use sqlx::SqlitePool;
use tempfile::TempPath;
use tokio::io::{AsyncRead, AsyncWriteExt};
use tokio::sync::{OwnedRwLockReadGuard, RwLock, mpsc, oneshot};
use uuid::Uuid;

use super::arriving::{Arriving, Incoming, SMALLEST_PART};
use super::collector::{Collector, Faults, Garbage};
use super::disk::{blocking, hash_of, hexadecimal, sync_folder};
use super::error::{Loss, Result, StoreError};
use super::supervision::Restarts;

/// A file up to this many bytes is verified whenever it is given out; a larger one, which takes a
/// moment, when it was not for a while.
const SMALL: u64 = 64 << 20;
const TRUSTED_FOR: Duration = Duration::from_secs(3600);
/// Larger files whose verification is remembered.
const REMEMBERED: usize = 10_000;

/// The folder.
#[derive(Clone, Debug)]
pub(super) struct Blobs {
    root: PathBuf,
    pub(super) incoming: Incoming,
    /// What is not what its name says is moved here.
    set_aside: PathBuf,
    in_use: Arc<RwLock<()>>,
    garbage: mpsc::UnboundedSender<Garbage>,
    pub(super) faults: Arc<Faults>,
    /// When larger files were verified.
    verified: Arc<Mutex<BTreeMap<String, Instant>>>,
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
            incoming: Incoming::new(data.join("incoming")),
            set_aside: data.join("set-aside"),
            in_use: Arc::default(),
            garbage,
            faults: Arc::default(),
            verified: Arc::default(),
        };
        let (root, incoming) = (blobs.root.clone(), blobs.incoming.folder.clone());
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

    /// Removes half-received files that a crash left, and has stored ones without a row found.
    pub(super) async fn recover(&self) -> Result<()> {
        let incoming = self.incoming.folder.clone();
        blocking(&self.incoming.folder, move || {
            for entry in std::fs::read_dir(incoming)? {
                std::fs::remove_file(entry?.path())?;
            }
            Ok(())
        })
        .await?;
        self.look_through();
        Ok(())
    }

    /// The folder.
    pub(super) fn root(&self) -> &Path {
        &self.root
    }

    /// Where the bytes of `sha256` are.
    pub(super) fn path(&self, sha256: &str) -> PathBuf {
        let folder = sha256.get(..2).unwrap_or_default();
        self.root.join(folder).join(sha256)
    }

    /// Takes in a body of at most `limit` bytes that must hash to `sha256`; with a `part`, after so many
    /// bytes that the same sender has sent before, and what has arrived when it breaks off is kept.
    ///
    /// # Errors
    /// [`StoreError::Invalid`], [`StoreError::TooLarge`], [`StoreError::Interrupted`] by the
    /// sender's fault; [`StoreError::Unavailable`] when not so many bytes are kept of it;
    /// [`StoreError::File`] by the disk's.
    pub(super) async fn receive(
        &self,
        what: &'static str,
        sha256: &str,
        limit: u64,
        part: Option<(Uuid, u64)>,
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
        let mut arriving = match part {
            Some((sender, from @ 1..)) => self.incoming.go_on(sender, sha256, from).await?,
            _ => self.incoming.begin().await?,
        };
        match arriving.take_in(&mut body, what, limit).await {
            Ok(()) => {}
            Err(error) => {
                if let (StoreError::Interrupted(_), Some((sender, _))) = (&error, part)
                    && arriving.bytes >= SMALLEST_PART
                {
                    self.incoming.keep_part(arriving, sender, sha256).await?;
                }
                return Err(error);
            }
        }
        let Arriving {
            mut file,
            path,
            hash,
            bytes,
        } = arriving;
        let failed = || StoreError::file(&self.incoming.folder);
        let found = hexadecimal(hash);
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
        // the same content may be there already, and then it is as durable as this: if it still is
        // what its name says
        if self
            .examine(&received.sha256, received.bytes)
            .await?
            .is_some()
        {
            blocking(&self.path(&received.sha256), move || {
                received.path.persist(&place)?;
                sync_folder(place.parent().unwrap_or(&place))
            })
            .await?;
        }
        Ok(guard)
    }

    /// Holds a stored file against its name and sets it aside if it is another; tells what is wrong.
    pub(super) async fn examine(&self, sha256: &str, bytes: u64) -> Result<Option<Loss>> {
        let place = self.path(sha256);
        let expected = sha256.to_owned();
        let found = blocking(&place.clone(), move || match hash_of(&place) {
            Ok((found, length)) if found == expected && length == bytes => Ok(None),
            Ok(_) => Ok(Some(Loss::Changed)),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Some(Loss::Missing)),
            Err(error) => Err(error),
        })
        .await;
        let found = match found {
            Ok(found) => found,
            // a disk that cannot read it back has lost it as well
            Err(StoreError::File { path, source }) => {
                tracing::error!(path = %path.display(), error = %source, "a stored file cannot be read");
                Some(Loss::Changed)
            }
            Err(error) => return Err(error),
        };
        if found == Some(Loss::Changed) {
            self.set_aside(sha256).await?;
        }
        Ok(found)
    }

    async fn set_aside(&self, sha256: &str) -> Result<()> {
        let (place, folder) = (self.path(sha256), self.set_aside.clone());
        let name = format!("{sha256}-{}", loadframe_api::Timestamp::now().as_millis());
        tracing::error!(sha256, folder = %folder.display(), "a stored file is not what its name says; it is set aside");
        blocking(&self.set_aside, move || {
            std::fs::create_dir_all(&folder)?;
            std::fs::rename(&place, folder.join(name))?;
            sync_folder(place.parent().unwrap_or(&place))
        })
        .await
    }

    /// Where a stored file is, having held it against its name.
    pub(super) async fn verified(&self, sha256: &str, bytes: u64) -> Result<Result<PathBuf, Loss>> {
        let path = self.path(sha256);
        if bytes <= SMALL {
            let loss = self.examine(sha256, bytes).await?;
            return Ok(loss.map_or(Ok(path), Err));
        }
        let known = self.remembered().get(sha256).copied();
        let length = tokio::fs::metadata(&path)
            .await
            .map_or(0, |file| file.len());
        if length == bytes && known.is_some_and(|since| since.elapsed() < TRUSTED_FOR) {
            return Ok(Ok(path));
        }
        let loss = self.examine(sha256, bytes).await?;
        let mut remembered = self.remembered();
        if remembered.len() >= REMEMBERED {
            remembered.clear();
        }
        match loss {
            None => remembered.insert(sha256.to_owned(), Instant::now()),
            Some(_) => remembered.remove(sha256),
        };
        Ok(loss.map_or(Ok(path), Err))
    }

    fn remembered(&self) -> MutexGuard<'_, BTreeMap<String, Instant>> {
        self.verified.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes and removes a small file, to find out whether a write works.
    pub(super) async fn try_write(&self) -> Result<()> {
        let folder = self.incoming.folder.clone();
        blocking(&self.incoming.folder, move || {
            let mut file = tempfile::tempfile_in(folder)?;
            std::io::Write::write_all(&mut file, &[0x5a; 4096])?;
            file.sync_all()
        })
        .await
    }

    /// Has the whole folder looked through for files without a row.
    pub(super) fn look_through(&self) {
        let _ = self.garbage.send(Garbage::PerhapsAny);
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

    /// The collector of this folder.
    pub(super) fn collector(
        &self,
        reads: SqlitePool,
        wait: Duration,
        is_behind: bool,
        restarts: Arc<Restarts>,
    ) -> Collector {
        // not the whole of `self`: that can report, and would keep the collector alive
        Collector {
            root: self.root.clone(),
            in_use: self.in_use.clone(),
            faults: self.faults.clone(),
            reads,
            wait,
            is_behind,
            restarts,
        }
    }
}
