//! Where stored files lie: in a folder of this machine, or in a bucket. Only this file knows which; what a
//! file is, who names it and when it goes is the same for both.
use std::ops::Range;
use std::path::{Path, PathBuf};

use bytes::Bytes;
use futures_util::StreamExt;
use futures_util::stream::BoxStream;
use tokio::io::{AsyncReadExt, AsyncSeekExt};
use tokio_util::io::ReaderStream;

use super::bucket::{Bucket, Found};
use super::error::{Loss, Result, StoreError};
use super::folder::Folder;
use super::types::FilesPlace;

/// Bytes that a stored file is read by.
const PIECE: usize = 64 << 10;

/// A place for files.
#[derive(Clone, Debug)]
pub(super) enum Storage {
    Folder(Folder),
    Bucket(Bucket),
}

/// The bytes of a stored file, which were held against its SHA-256.
#[derive(Clone, Debug)]
pub struct Content(Place);

#[derive(Clone, Debug)]
enum Place {
    File(PathBuf),
    Object {
        bucket: Box<Bucket>,
        sha256: String,
        tag: Option<String>,
    },
}

impl Storage {
    /// That of the store in `data`, whose files are at `place`.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] when there is no such place.
    pub(super) fn of(data: &Path, place: &FilesPlace) -> Result<Self> {
        Ok(match place {
            FilesPlace::Folder => Self::Folder(Folder::of(data)),
            FilesPlace::Bucket(settings) => Self::Bucket(Bucket::open(settings)?),
        })
    }

    pub(super) async fn prepare(&self) -> Result<()> {
        match self {
            Self::Folder(folder) => folder.prepare().await,
            Self::Bucket(_) => Ok(()),
        }
    }

    /// The bucket, where it is one.
    pub(super) fn bucket(&self) -> Option<&Bucket> {
        match self {
            Self::Folder(_) => None,
            Self::Bucket(bucket) => Some(bucket),
        }
    }

    /// What can be known of a stored file without reading it; `None` when it is not there.
    pub(super) async fn look(&self, sha256: &str) -> Result<Option<Found>> {
        match self {
            Self::Folder(folder) => Ok(folder
                .length(sha256)
                .await
                .map(|bytes| Found { bytes, tag: None })),
            Self::Bucket(bucket) => bucket.look(sha256).await,
        }
    }

    /// Holds a stored file against its name and sets it aside if it is another; tells what is wrong.
    pub(super) async fn examine(&self, sha256: &str, bytes: u64) -> Result<Option<Loss>> {
        match self {
            Self::Folder(folder) => folder.examine(sha256, bytes).await,
            Self::Bucket(bucket) => bucket.examine(sha256, bytes).await,
        }
    }

    /// The bytes of a file that was found here.
    pub(super) fn content(&self, sha256: &str, found: Option<Found>) -> Content {
        Content(match self {
            Self::Folder(folder) => Place::File(folder.path(sha256)),
            Self::Bucket(bucket) => Place::Object {
                bucket: Box::new(bucket.clone()),
                sha256: sha256.to_owned(),
                tag: found.and_then(|found| found.tag),
            },
        })
    }

    /// Copies a stored file to a file of this machine; whether it was there.
    pub(super) async fn copy_to(&self, sha256: &str, to: &Path) -> Result<bool> {
        match self {
            Self::Folder(folder) => folder.copy_to(sha256, to).await,
            Self::Bucket(bucket) => bucket.copy_to(sha256, to).await,
        }
    }

    /// Names of all stored files.
    pub(super) async fn names(&self) -> Result<Vec<String>> {
        match self {
            Self::Folder(folder) => folder.names().await,
            Self::Bucket(bucket) => bucket.names().await,
        }
    }

    pub(super) async fn remove(&self, names: Vec<String>) -> Result<()> {
        match self {
            _ if names.is_empty() => Ok(()),
            Self::Folder(folder) => folder.remove(names).await,
            Self::Bucket(bucket) => bucket.remove(names).await,
        }
    }

    /// Whether any file lies there.
    pub(super) async fn has_files(&self) -> Result<bool> {
        match self {
            Self::Folder(folder) => folder.has_files(),
            Self::Bucket(bucket) => bucket.has_files().await,
        }
    }

    /// A note of the store beside the files, if it is there.
    pub(super) async fn note(&self, name: &str) -> Result<Option<String>> {
        match self {
            Self::Folder(folder) => folder.note(name),
            Self::Bucket(bucket) => bucket.note(name).await,
        }
    }

    /// Leaves a note, durably.
    pub(super) async fn leave_note(&self, name: &str, text: &str) -> Result<()> {
        match self {
            Self::Folder(folder) => folder.leave_note(name, text),
            Self::Bucket(bucket) => bucket.leave_note(name, text).await,
        }
    }
}

impl std::fmt::Display for Storage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Folder(folder) => write!(f, "{}", folder.root().display()),
            Self::Bucket(bucket) => write!(f, "{}", bucket.settings()),
        }
    }
}

impl Content {
    /// Where the file is, if it is on a disk of this machine.
    pub fn path(&self) -> Option<&Path> {
        match &self.0 {
            Place::File(path) => Some(path),
            Place::Object { .. } => None,
        }
    }

    /// Bytes of the file, piece by piece.
    ///
    /// # Errors
    /// The disk's and the bucket's.
    pub async fn read(
        &self,
        range: Range<u64>,
    ) -> Result<BoxStream<'static, std::io::Result<Bytes>>> {
        match &self.0 {
            Place::File(path) => {
                let failed = || StoreError::file(path);
                let mut file = tokio::fs::File::open(path).await.map_err(failed())?;
                let begin = std::io::SeekFrom::Start(range.start);
                file.seek(begin).await.map_err(failed())?;
                let part = file.take(range.end.saturating_sub(range.start));
                Ok(ReaderStream::with_capacity(part, PIECE).boxed())
            }
            Place::Object {
                bucket,
                sha256,
                tag,
            } => bucket.read(sha256, tag.clone(), range).await,
        }
    }

    /// An address of the bucket from which whoever has it downloads the file for some minutes; `None` where
    /// files are not given out so.
    ///
    /// # Errors
    /// The bucket's.
    pub async fn address(&self, media_type: &str, disposition: &str) -> Result<Option<String>> {
        match &self.0 {
            Place::Object { bucket, sha256, .. } if bucket.settings().redirects => {
                let signed = bucket.signed_download(sha256, media_type, disposition);
                signed.await.map(Some)
            }
            _ => Ok(None),
        }
    }
}
