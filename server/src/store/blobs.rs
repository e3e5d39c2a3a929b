//! Stored files: bytes under their SHA-256, written once, removed when no row names them, wherever they
//! lie ([`super::storage`]).
//!
//! A file arrives under a temporary name on this machine (a small one: in memory), is hashed on its way, made
//! durable, and put in its place, durably; only then may a row name it. Between that and the commit of the
//! row the bytes look forgotten, so whoever stores a file holds a [`FileGuard`] until its row is safe,
//! and the collector removes nothing while anybody does. Whatever becomes of the sender meanwhile (a request
//! ends with its connection), the bytes get their place or none, and the collector hears of what got no row.
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::sync::{OwnedRwLockReadGuard, RwLock, oneshot};
use uuid::Uuid;

use super::arriving::{Incoming, Received, SMALLEST_PART};
use super::bucket::Found;
use super::collector::{Collector, Faults, Garbage, Postponed, Reports};
use super::database::{Held, Pool, Sharing};
use super::disk::{CHUNK, blocking};
use super::error::{Loss, Result, StoreError};
use super::removal::Removal;
use super::storage::{Content, Storage};
use super::supervision::Restarts;

/// A file up to this many bytes in a folder is verified whenever it is given out; a larger one, which takes a
/// moment, or one in a bucket, when it was not for a while.
const SMALL: u64 = 64 << 20;
const TRUSTED_FOR: Duration = Duration::from_secs(3600);
/// Files whose verification is remembered.
const REMEMBERED: usize = 10_000;

/// The stored files.
#[derive(Clone, Debug)]
pub(super) struct Blobs {
    pub(super) storage: Storage,
    pub(super) incoming: Incoming,
    in_use: Arc<RwLock<()>>,
    sharing: Sharing,
    garbage: Reports,
    pub(super) faults: Arc<Faults>,
    /// Files that were verified: when, and as which object of a bucket.
    verified: Arc<Mutex<BTreeMap<String, (Instant, Found)>>>,
}

/// While it lives, no file is removed: not by this server, and by no other on the database. Dropped before
/// its file is [`Self::named`], it has the collector look at the file.
#[derive(Debug)]
pub(super) struct FileGuard {
    unnamed: Option<(String, Reports)>,
    #[allow(dead_code)]
    held: (OwnedRwLockReadGuard<()>, Held),
}

impl FileGuard {
    /// The row that names the file is safe.
    pub(super) fn named(mut self) {
        self.unnamed = None;
    }
}

impl Drop for FileGuard {
    fn drop(&mut self) {
        if let Some((sha256, garbage)) = self.unnamed.take() {
            // without a collector the store is closing, and the next start collects
            garbage.send(Garbage::Perhaps(vec![sha256], garbage.next_moment()));
        }
    }
}

impl Blobs {
    /// Prepares the place of files, and the folder in `data` for those on their way to it.
    pub(super) async fn open(
        data: &Path,
        storage: Storage,
        garbage: Reports,
        sharing: Sharing,
    ) -> Result<Self> {
        let blobs = Self {
            storage,
            incoming: Incoming::of(data, &sharing)?,
            in_use: Arc::default(),
            sharing,
            garbage,
            faults: Arc::default(),
            verified: Arc::default(),
        };
        blobs.storage.prepare().await?;
        Ok(blobs)
    }

    /// Removes half-received files that a crash left, and has stored ones without a row found.
    pub(super) async fn recover(&self) -> Result<()> {
        self.incoming.remove_left().await?;
        self.look_through();
        Ok(())
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
        check_sha256(sha256)?;
        let mut arriving = match part {
            Some((sender, from @ 1..)) => self.incoming.go_on(sender, sha256, from).await?,
            _ => {
                // most files are small: their bytes are in memory already, and go to the disk in one go
                let mut first = Vec::new();
                let mut beginning = (&mut body).take(CHUNK as u64);
                let read = beginning.read_to_end(&mut first).await;
                let count = read.map_err(StoreError::Interrupted)?;
                if count as u64 > limit {
                    return Err(StoreError::TooLarge { what, limit });
                }
                if count < CHUNK {
                    return Received::in_memory(first, sha256);
                }
                let mut arriving = self.incoming.begin().await?;
                arriving.add(&first, what, limit).await?;
                arriving
            }
        };
        match arriving.take_in(&mut body, what, limit).await {
            Ok(()) => arriving.whole(sha256).await,
            Err(error) => {
                if let (StoreError::Interrupted(_), Some((sender, _))) = (&error, part)
                    && arriving.bytes >= SMALLEST_PART
                {
                    self.incoming.keep_part(arriving, sender, sha256).await?;
                }
                Err(error)
            }
        }
    }

    /// Puts a received file in its place, even when nobody waits for it any more. It stays there while the
    /// [`FileGuard`] is held.
    pub(super) async fn keep(&self, received: Received) -> Result<FileGuard> {
        let blobs = self.clone();
        to_the_end(async move { blobs.place(received).await }).await
    }

    async fn place(&self, received: Received) -> Result<FileGuard> {
        let (sha256, bytes) = (received.sha256.clone(), received.bytes);
        match &self.storage {
            Storage::Folder(folder) => {
                let guard = self.guard(&sha256).await?;
                folder.keep(received, &self.incoming.folder).await?;
                Ok(guard)
            }
            Storage::Bucket(bucket) => {
                let path = self.incoming.on_disk(received).await?;
                // sending takes a while, in which the collector has no need to wait; when it does, the
                // object is looked at again
                if self.verified(&sha256, bytes).await?.is_err() {
                    bucket.place_file(&sha256, bytes, &path).await?;
                }
                let guard = self.guard(&sha256).await?;
                if self.verified(&sha256, bytes).await?.is_err() {
                    bucket.place_file(&sha256, bytes, &path).await?;
                    let again = self.verified(&sha256, bytes).await?;
                    again.map_err(|_| StoreError::Unavailable)?;
                }
                Ok(guard)
            }
        }
    }

    /// Keeps the collector from its work until the file has a row, or will get none.
    pub(super) async fn guard(&self, sha256: &str) -> Result<FileGuard> {
        let here = self.in_use.clone().read_owned().await;
        let held = (here, self.sharing.storing_a_file().await?);
        let unnamed = Some((sha256.to_owned(), self.garbage.clone()));
        Ok(FileGuard { unnamed, held })
    }

    /// Holds a stored file against its name and sets it aside if it is another; tells what is wrong.
    pub(super) async fn examine(&self, sha256: &str, bytes: u64) -> Result<Option<Loss>> {
        self.storage.examine(sha256, bytes).await
    }

    /// A stored file, having held it against its name.
    pub(super) async fn verified(&self, sha256: &str, bytes: u64) -> Result<Result<Content, Loss>> {
        let is_remembered = self.storage.bucket().is_some() || bytes > SMALL;
        if !is_remembered {
            let loss = self.examine(sha256, bytes).await?;
            return Ok(loss.map_or_else(|| Ok(self.storage.content(sha256, None)), Err));
        }
        let Some(found) = self.storage.look(sha256).await? else {
            return Ok(Err(Loss::Missing));
        };
        let known = self.remembered().get(sha256).cloned();
        let is_known =
            known.is_some_and(|(since, before)| since.elapsed() < TRUSTED_FOR && found == before);
        if !(is_known && found.bytes == bytes) {
            if let Some(loss) = self.examine(sha256, bytes).await? {
                self.remembered().remove(sha256);
                return Ok(Err(loss));
            }
            self.remember(sha256, found.clone());
        }
        Ok(Ok(self.storage.content(sha256, Some(found))))
    }

    /// Notes that a stored file was held against its name just now.
    pub(super) fn remember(&self, sha256: &str, found: Found) {
        let mut remembered = self.remembered();
        if remembered.len() >= REMEMBERED {
            remembered.clear();
        }
        remembered.insert(sha256.to_owned(), (Instant::now(), found));
    }

    fn remembered(&self) -> MutexGuard<'_, BTreeMap<String, (Instant, Found)>> {
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
        .await?;
        match self.storage.bucket() {
            Some(bucket) => bucket.try_write().await,
            None => Ok(()),
        }
    }

    /// Has the whole folder looked through for files without a row.
    pub(super) fn look_through(&self) {
        self.garbage.send(Garbage::PerhapsAny);
    }

    /// Waits until what was reported as garbage before is removed.
    pub(super) async fn collected(&self) {
        let (done, wait) = oneshot::channel();
        if self.garbage.send(Garbage::Barrier(done)) {
            let _ = wait.await;
        }
    }

    /// The collector of this folder.
    pub(super) fn collector(
        &self,
        reads: Pool,
        wait: Duration,
        is_behind: bool,
        restarts: Arc<Restarts>,
        removal: Removal,
    ) -> Collector {
        // not the whole of `self`: that can report, and would keep the collector alive
        Collector {
            storage: self.storage.clone(),
            in_use: self.in_use.clone(),
            sharing: self.sharing.clone(),
            faults: self.faults.clone(),
            reads,
            wait,
            is_behind,
            restarts,
            removal,
            moments: self.garbage.moments(),
            postponed: Postponed::default(),
            found: BTreeMap::new(),
        }
    }
}

/// Works on when the caller has gone.
pub(super) async fn to_the_end<T: Send + 'static>(
    work: impl Future<Output = Result<T>> + Send + 'static,
) -> Result<T> {
    let worked = tokio::spawn(work).await;
    worked.unwrap_or_else(|error| match error.try_into_panic() {
        Ok(panic) => std::panic::resume_unwind(panic),
        // the runtime ends
        Err(_) => Err(StoreError::Unavailable),
    })
}

/// Refuses what is no SHA-256.
pub(super) fn check_sha256(text: &str) -> Result<()> {
    let is_digit = |digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f');
    if text.len() == 64 && text.bytes().all(is_digit) {
        return Ok(());
    }
    let sentence = "sha256 is 64 lower-case hexadecimal digits";
    Err(StoreError::Invalid(sentence.to_owned()))
}

#[cfg(test)]
mod tests {
    use sha2::{Digest, Sha256};

    use super::super::disk::hexadecimal;
    use super::super::{Store, StoreOptions};
    use super::*;

    impl Blobs {
        /// Stores a file as if a row named it.
        async fn name(&self, text: &'static str) -> Result<(String, FileGuard)> {
            let sha256 = hexadecimal(Sha256::new_with_prefix(text));
            let received = self.receive("a file", &sha256, 100, None, text.as_bytes());
            let guard = self.keep(received.await?).await?;
            Ok((sha256, guard))
        }

        /// Tells that a row that named it has just gone.
        fn let_go(&self, sha256: &str) {
            let moment = self.garbage.next_moment();
            let report = Garbage::Perhaps(vec![sha256.to_owned()], moment);
            assert!(self.garbage.send(report), "there is a collector");
        }

        async fn has(&self, sha256: &String) -> Result<bool> {
            self.collected().await;
            Ok(self.storage.names().await?.contains(sha256))
        }
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn what_is_let_go_while_the_folder_is_looked_through_is_removed() -> Result<()> {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(StoreOptions::new(folder.path())).await?;
        let blobs = store.blobs();

        // until the guard goes, the collector stands before the question which files have rows; it is asked
        // twice, as by a start and by a person
        let (file, guard) = blobs.name("let go").await?;
        blobs.look_through();
        blobs.look_through();
        blobs.let_go(&file);
        guard.named();
        assert!(!blobs.has(&file).await?);

        // found without a row, it may be what another database knows; that it had one here changes nothing
        let (file, guard) = blobs.name("found").await?;
        guard.named();
        blobs.look_through();
        blobs.collected().await;
        let (_, guard) = blobs.name("found").await?;
        guard.named();
        blobs.let_go(&file);
        assert!(blobs.has(&file).await?);
        Ok(())
    }
}
