//! Files on their way in, and what is kept of one that broke off.
//!
//! A part is named for its sender's lease and for the whole content's SHA-256. It waits among the files
//! on their way, which a server that starts removes; who asks is then told that there is nothing.
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use sha2::{Digest, Sha256};
use tempfile::{NamedTempFile, TempPath};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWriteExt};
use uuid::Uuid;

use super::database::Sharing;
use super::disk::{CHUNK, blocking, hashed, hexadecimal};
use super::error::{Result, StoreError};

/// Of an upload that broke off, this many bytes are worth keeping; fewer are soon sent again.
pub(super) const SMALLEST_PART: u64 = 1 << 20;
/// How long they wait for the rest, and how their files are called.
const PARTS_KEPT: Duration = Duration::from_secs(3600);
const PART: &str = "part-";

/// How the folder of a server among others is known to be in use.
const LOCK: &str = "lock";

/// The folder of files on their way; servers that share a data folder have one each in it.
#[derive(Clone, Debug)]
pub(super) struct Incoming {
    pub(super) folder: PathBuf,
    /// The folder of all of them, and that this one's is in use, where there are others.
    among: Option<(PathBuf, Arc<File>)>,
}

/// A file that has arrived whole and is what its SHA-256 says.
#[derive(Debug)]
pub(super) struct Received {
    content: Whole,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

/// All bytes of a file.
#[derive(Debug)]
enum Whole {
    /// Of a small one, of which nothing is on disk yet.
    InMemory(Vec<u8>),
    /// Durable, under a temporary name.
    OnDisk(TempPath),
}

impl Received {
    /// A small file with this content, which must hash to `sha256`.
    ///
    /// # Errors
    /// [`StoreError::Invalid`].
    pub(super) fn in_memory(content: Vec<u8>, sha256: &str) -> Result<Self> {
        let found = hexadecimal(Sha256::new_with_prefix(&content));
        check_content(&found, sha256)?;
        Ok(Self {
            bytes: content.len() as u64,
            content: Whole::InMemory(content),
            sha256: found,
        })
    }

    /// Where it is on disk, durable under a temporary name: in `folder`, if it was not yet; blocks.
    pub(super) fn on_disk(self, folder: &Path) -> std::io::Result<TempPath> {
        match self.content {
            Whole::InMemory(content) => {
                let mut file = NamedTempFile::new_in(folder)?;
                file.write_all(&content)?;
                file.as_file().sync_all()?;
                Ok(file.into_temp_path())
            }
            Whole::OnDisk(path) => Ok(path),
        }
    }
}

/// Refuses a content that is another than was said.
fn check_content(found: &str, sha256: &str) -> Result<()> {
    if found == sha256 {
        return Ok(());
    }
    let sentence = format!("the body's SHA-256 is {found}, the query says {sha256}");
    Err(StoreError::Invalid(sentence))
}

/// A file as far as it has arrived.
#[derive(Debug)]
pub(super) struct Arriving {
    file: tokio::fs::File,
    path: TempPath,
    hash: Sha256,
    pub(super) bytes: u64,
}

impl Arriving {
    /// Takes in what comes, to its end.
    pub(super) async fn take_in(
        &mut self,
        body: &mut (impl AsyncRead + Send + Unpin),
        what: &'static str,
        limit: u64,
    ) -> Result<()> {
        let mut chunk = vec![0; CHUNK];
        loop {
            let count = body
                .read(&mut chunk)
                .await
                .map_err(StoreError::Interrupted)?;
            if count == 0 {
                return Ok(());
            }
            self.add(&chunk[..count], what, limit).await?;
        }
    }

    /// Adds bytes that have come.
    pub(super) async fn add(&mut self, bytes: &[u8], what: &'static str, limit: u64) -> Result<()> {
        if self.bytes + bytes.len() as u64 > limit {
            return Err(StoreError::TooLarge { what, limit });
        }
        let written = self.file.write_all(bytes).await;
        written.map_err(StoreError::file(&*self.path))?;
        self.hash.update(bytes);
        self.bytes += bytes.len() as u64;
        Ok(())
    }

    /// Makes what has arrived durable; it must hash to `sha256`.
    ///
    /// # Errors
    /// [`StoreError::Invalid`], [`StoreError::File`].
    pub(super) async fn whole(self, sha256: &str) -> Result<Received> {
        let Self {
            mut file,
            path,
            hash,
            bytes,
        } = self;
        let found = hexadecimal(hash);
        check_content(&found, sha256)?;
        let failed = || StoreError::file(&*path);
        file.flush().await.map_err(failed())?;
        file.sync_all().await.map_err(failed())?;
        Ok(Received {
            content: Whole::OnDisk(path),
            bytes,
            sha256: found,
        })
    }
}

impl Incoming {
    /// That of a server in `data`.
    pub(super) fn of(data: &Path, sharing: &Sharing) -> Result<Self> {
        let all = data.join("incoming");
        let make = |folder: &Path| {
            std::fs::create_dir_all(folder).map_err(StoreError::file(folder.to_owned()))
        };
        let Sharing::Among { server, .. } = sharing else {
            make(&all)?;
            return Ok(Self {
                folder: all,
                among: None,
            });
        };
        let folder = all.join(server.simple().to_string());
        make(&folder)?;
        let path = folder.join(LOCK);
        let lock = || -> std::io::Result<File> {
            let file = File::create(&path)?;
            file.lock()?;
            Ok(file)
        };
        let lock = lock().map_err(StoreError::file(&path))?;
        Ok(Self {
            folder,
            among: Some((all, Arc::new(lock))),
        })
    }

    /// Removes what a crash left: of servers among others, the folders of those that are not there any more.
    pub(super) async fn remove_left(&self) -> Result<()> {
        let all = self.among.as_ref().map(|(all, _)| all.clone());
        let incoming = self.folder.clone();
        blocking(&self.folder, move || {
            let Some(all) = all else {
                // folders are of servers that shared it before
                for entry in std::fs::read_dir(incoming)? {
                    let entry = entry?;
                    if entry.file_type()?.is_dir() {
                        std::fs::remove_dir_all(entry.path())?;
                    } else {
                        std::fs::remove_file(entry.path())?;
                    }
                }
                return Ok(());
            };
            for entry in std::fs::read_dir(all)? {
                let folder = entry?.path();
                let lock = File::options().write(true).open(folder.join(LOCK));
                let is_left = lock.is_ok_and(|lock| lock.try_lock().is_ok());
                if is_left && folder != incoming {
                    std::fs::remove_dir_all(folder)?;
                }
            }
            Ok(())
        })
        .await
    }

    pub(super) async fn begin(&self) -> Result<Arriving> {
        let folder = self.folder.clone();
        let file = blocking(&self.folder, || NamedTempFile::new_in(folder)).await?;
        let (file, path) = file.into_parts();
        Ok(Arriving {
            file: tokio::fs::File::from_std(file),
            path,
            hash: Sha256::new(),
            bytes: 0,
        })
    }

    /// Where a file is on disk, once it is.
    pub(super) async fn on_disk(&self, received: Received) -> Result<TempPath> {
        let folder = self.folder.clone();
        blocking(&self.folder, move || received.on_disk(&folder)).await
    }

    /// Goes on with a part. It has a name of its own from here on: of two who go on with it, one does.
    pub(super) async fn go_on(&self, sender: Uuid, sha256: &str, from: u64) -> Result<Arriving> {
        let (part, folder) = (self.part(sender, sha256), self.folder.clone());
        let taken = blocking(&self.folder, move || {
            let (_, path) = NamedTempFile::new_in(folder)?.into_parts();
            match std::fs::rename(&part, &path) {
                Ok(()) => {}
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
                Err(error) => return Err(error),
            }
            let (hash, bytes) = hashed(&path)?;
            let file = std::fs::File::options().append(true).open(&path)?;
            Ok(Some((file, path, hash, bytes)))
        });
        match taken.await? {
            Some((file, path, hash, bytes)) if bytes == from => Ok(Arriving {
                file: tokio::fs::File::from_std(file),
                path,
                hash,
                bytes,
            }),
            // a server that was started again keeps no parts: who asks begins anew
            _ => Err(StoreError::Unavailable),
        }
    }

    pub(super) async fn keep_part(
        &self,
        mut arriving: Arriving,
        sender: Uuid,
        sha256: &str,
    ) -> Result<()> {
        let flushed = arriving.file.flush().await;
        flushed.map_err(StoreError::file(&self.folder))?;
        let part = self.part(sender, sha256);
        blocking(&self.folder, move || Ok(arriving.path.persist(part)?)).await
    }

    /// Bytes of a content that `sender` has sent and that are kept.
    pub(super) async fn part_bytes(&self, sender: Uuid, sha256: &str) -> u64 {
        let part = tokio::fs::metadata(self.part(sender, sha256)).await;
        part.map_or(0, |part| part.len())
    }

    /// Forgets parts with which nobody went on for a while.
    pub(super) async fn forget_parts(&self) -> Result<()> {
        let incoming = self.folder.clone();
        blocking(&self.folder, move || {
            for entry in std::fs::read_dir(incoming)? {
                let entry = entry?;
                let is_part = entry
                    .file_name()
                    .as_encoded_bytes()
                    .starts_with(PART.as_bytes());
                let age = entry.metadata()?.modified()?.elapsed().unwrap_or_default();
                if is_part && age > PARTS_KEPT {
                    std::fs::remove_file(entry.path())?;
                }
            }
            Ok(())
        })
        .await
    }

    fn part(&self, sender: Uuid, sha256: &str) -> PathBuf {
        self.folder
            .join(format!("{PART}{}-{sha256}", sender.simple()))
    }
}
