//! Files in a bucket that speaks S3: the folder's layout as keys, below the prefix of the store.
//!
//! `blobs/ab/abcd…` are the bytes under their SHA-256, `blobs/store.json` and `blobs/unnamed.json` the
//! notes beside them, `incoming/` is what workers send by themselves ([`direct`]), `set-aside/` what was
//! not what its name says. An object is there whole or not at all, and a put of the same content is the
//! same object: keys are hashes, so nothing hangs on conditional puts, which not every server knows.
//!
//! Bytes that this server sends are signed with their SHA-256, which the bucket's server holds them
//! against. Bytes that it reads are held against their name as in a folder, and an object that was held
//! against it is known by its `ETag` from there on.
pub(super) mod direct;
mod settings;
mod unfinished;

use std::ops::Range;
use std::path::Path as LocalPath;
use std::sync::Arc;
use std::time::Duration;

use backon::{ConstantBuilder, Retryable};
use bytes::Bytes;
use futures_util::stream::{self, BoxStream};
use futures_util::{StreamExt, TryStreamExt};
use loadframe_api::Timestamp;
use object_store::aws::{AmazonS3, AmazonS3Builder};
use object_store::buffered::BufWriter;
use object_store::path::Path;
use object_store::{
    ClientOptions, Error, GetOptions, GetRange, ObjectMeta, ObjectStore, ObjectStoreExt,
    RetryConfig,
};
use sha2::{Digest, Sha256};
use tokio::fs::File;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWriteExt};

pub use settings::{BucketKeys, BucketSettings};

use super::disk::{CHUNK, hexadecimal};
use super::error::{Loss, Result, StoreError};

/// Bytes of a file that are sent in one request; of a larger one so many a part.
const AT_ONCE: usize = 16 << 20;
/// How long the bucket's server may take to be connected to, and may be silent within an answer.
const CONNECT: Duration = Duration::from_secs(5);
const SILENCE: Duration = Duration::from_secs(30);
/// The same where it puts a large object together or copies one: S3's documentation speaks of several minutes.
const LONG_SILENCE: Duration = Duration::from_secs(300);
/// How often, and how long, a request that failed by the other side's fault is repeated.
const TRIES: usize = 6;
const TRYING: Duration = Duration::from_secs(30);
/// How soon, and how often, a list is asked for again whose answer broke off.
const LISTED_AGAIN: Duration = Duration::from_millis(200);
const LISTED_TIMES: usize = 3;

/// A bucket, below the prefix of one store.
#[derive(Clone, Debug)]
pub(super) struct Bucket {
    store: AmazonS3,
    /// As `store`, for what a bucket may think about for long.
    patient: AmazonS3,
    /// For what the crate does not ask: see [`unfinished`].
    http: reqwest::Client,
    prefix: Path,
    settings: BucketSettings,
}

/// What a bucket tells of an object without its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) bytes: u64,
    pub(super) tag: Option<String>,
}

impl Bucket {
    /// Prepares a client; nothing is asked yet.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] when the settings do not fit together.
    pub(super) fn open(settings: &BucketSettings) -> Result<Self> {
        // a second installation finds the first
        let _ = rustls::crypto::ring::default_provider().install_default();
        let client = |silence| {
            ClientOptions::new()
                .with_connect_timeout(CONNECT)
                .with_read_timeout(silence)
                .with_timeout_disabled()
                .with_allow_http(true)
        };
        let mut builder = AmazonS3Builder::new()
            .with_bucket_name(&settings.bucket)
            .with_region(&settings.region)
            .with_retry(RetryConfig {
                max_retries: TRIES,
                retry_timeout: TRYING,
                ..RetryConfig::default()
            });
        if let Some(endpoint) = &settings.endpoint {
            builder = builder.with_endpoint(endpoint);
        }
        if let Some(keys) = &settings.keys {
            builder = builder
                .with_access_key_id(&keys.id)
                .with_secret_access_key(&keys.secret);
            if let Some(token) = &keys.session {
                builder = builder.with_token(token);
            }
        }
        let build = |silence| {
            let builder = builder.clone().with_client_options(client(silence));
            let built = builder.build();
            built.map_err(|error| StoreError::Invalid(format!("{settings}: {error}")))
        };
        let http = reqwest::Client::builder()
            .connect_timeout(CONNECT)
            .read_timeout(SILENCE)
            .build()
            .map_err(|error| StoreError::Invalid(format!("{settings}: {error}")))?;
        Ok(Self {
            store: build(SILENCE)?,
            patient: build(LONG_SILENCE)?,
            http,
            prefix: Path::from(settings.prefix.as_str()),
            settings: settings.clone(),
        })
    }

    /// The address, for people.
    pub(super) fn settings(&self) -> &BucketSettings {
        &self.settings
    }

    fn key(&self, parts: &[&str]) -> Path {
        let own = parts.iter().map(|part| (*part).into());
        self.prefix.parts().chain(own).collect()
    }

    /// Key of the bytes of `sha256`.
    fn place(&self, sha256: &str) -> Path {
        self.key(&["blobs", sha256.get(..2).unwrap_or_default(), sha256])
    }

    fn failed(&self) -> impl Fn(Error) -> StoreError + use<> {
        let place = self.settings.to_string();
        move |source| StoreError::Bucket {
            place: place.clone(),
            source: Box::new(source),
        }
    }

    /// Sends the bytes of a file of this machine to the place of `sha256`.
    pub(super) async fn place_file(
        &self,
        sha256: &str,
        bytes: u64,
        file: &LocalPath,
    ) -> Result<()> {
        let unreadable = |error| StoreError::file(file)(error);
        let mut source = File::open(file).await.map_err(unreadable)?;
        let store = if bytes > AT_ONCE as u64 {
            &self.patient
        } else {
            &self.store
        };
        let sent = self.send(store, &mut source, sha256, unreadable).await?;
        if sent == bytes {
            Ok(())
        } else {
            Err(unreadable(std::io::ErrorKind::UnexpectedEof.into()))
        }
    }

    /// Sends what `source` gives to the place of `sha256`; tells how many bytes that was.
    async fn send(
        &self,
        store: &AmazonS3,
        source: &mut (impl AsyncRead + Unpin),
        sha256: &str,
        unreadable: impl Fn(std::io::Error) -> StoreError,
    ) -> Result<u64> {
        let place = self.place(sha256);
        // up to so many bytes it is one put, and in parts beyond; what fails is aborted
        let mut writer = BufWriter::with_capacity(Arc::new(store.clone()), place, AT_ONCE)
            .with_max_concurrency(2);
        let mut chunk = vec![0; CHUNK];
        let mut sent = 0;
        loop {
            let failed = match source.read(&mut chunk).await {
                Ok(0) => break,
                Ok(count) => {
                    sent += count as u64;
                    let written = writer.write_all(&chunk[..count]).await;
                    written.err().map(|error| self.failed()(generic(error)))
                }
                Err(error) => Some(unreadable(error)),
            };
            if let Some(error) = failed {
                // best effort: what stays is found by the sweep of unfinished uploads
                let _ = writer.abort().await;
                return Err(error);
            }
        }
        if let Err(error) = writer.shutdown().await {
            // a bucket that takes long to put parts together may have done it when nobody listened any more;
            // whatever lies there is read back before it is named
            let found = self.look(sha256).await?;
            if found.is_none_or(|found| found.bytes != sent) {
                return Err(self.failed()(generic(error)));
            }
        }
        Ok(sent)
    }

    /// Reads an object and sends it to the place of `sha256`.
    async fn send_on(&self, key: &Path, sha256: &str) -> Result<()> {
        let got = self.store.get(key).await.map_err(self.failed())?;
        let chunks = got.into_stream().map_err(std::io::Error::other);
        let mut reader = tokio_util::io::StreamReader::new(chunks.boxed());
        let unread = |error| self.failed()(generic(error));
        self.send(&self.patient, &mut reader, sha256, unread)
            .await
            .map(|_| ())
    }

    /// What the bucket tells of a stored object; `None` when there is none.
    pub(super) async fn look(&self, sha256: &str) -> Result<Option<Found>> {
        self.look_at(&self.place(sha256)).await
    }

    async fn look_at(&self, key: &Path) -> Result<Option<Found>> {
        match self.store.head(key).await {
            Ok(meta) => Ok(Some(Found {
                bytes: meta.size,
                tag: meta.e_tag,
            })),
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(self.failed()(error)),
        }
    }

    /// SHA-256 and length of an object, read back; `None` when there is none.
    async fn hash_of(&self, key: &Path) -> Result<Option<(String, u64)>> {
        let got = match self.store.get(key).await {
            Ok(got) => got,
            Err(Error::NotFound { .. }) => return Ok(None),
            Err(error) => return Err(self.failed()(error)),
        };
        let (mut hash, mut length) = (Sha256::new(), 0);
        let mut chunks = got.into_stream();
        while let Some(chunk) = chunks.try_next().await.map_err(self.failed())? {
            hash.update(&chunk);
            length += chunk.len() as u64;
        }
        Ok(Some((hexadecimal(hash), length)))
    }

    /// Holds a stored object against its name and sets it aside if it is another; tells what is wrong.
    pub(super) async fn examine(&self, sha256: &str, bytes: u64) -> Result<Option<Loss>> {
        match self.hash_of(&self.place(sha256)).await? {
            None => Ok(Some(Loss::Missing)),
            Some((found, length)) if found == sha256 && length == bytes => Ok(None),
            Some(_) => {
                self.set_aside(sha256).await?;
                Ok(Some(Loss::Changed))
            }
        }
    }

    async fn set_aside(&self, sha256: &str) -> Result<()> {
        let name = format!("{sha256}-{}", Timestamp::now().as_millis());
        tracing::error!(sha256, bucket = %self.settings, "a stored file is not what its name says; it is set aside");
        let (place, aside) = (self.place(sha256), self.key(&["set-aside", &name]));
        self.store
            .copy(&place, &aside)
            .await
            .map_err(self.failed())?;
        self.store.delete(&place).await.map_err(self.failed())
    }

    /// The bytes of a stored object from `begin` to `end`, as they were when it had this tag.
    pub(super) async fn read(
        &self,
        sha256: &str,
        tag: Option<String>,
        range: Range<u64>,
    ) -> Result<BoxStream<'static, std::io::Result<Bytes>>> {
        if range.is_empty() {
            return Ok(stream::empty().boxed());
        }
        let options = GetOptions {
            range: Some(GetRange::Bounded(range)),
            if_match: tag,
            ..GetOptions::default()
        };
        let got = self.store.get_opts(&self.place(sha256), options).await;
        let got = got.map_err(self.failed())?;
        Ok(got.into_stream().map_err(std::io::Error::other).boxed())
    }

    /// Copies a stored object to a file of this machine; whether it was there.
    pub(super) async fn copy_to(&self, sha256: &str, to: &LocalPath) -> Result<bool> {
        let got = match self.store.get(&self.place(sha256)).await {
            Ok(got) => got,
            Err(Error::NotFound { .. }) => return Ok(false),
            Err(error) => return Err(self.failed()(error)),
        };
        let unwritable = |error| StoreError::file(to)(error);
        let mut file = File::create(to).await.map_err(unwritable)?;
        let mut chunks = got.into_stream();
        while let Some(chunk) = chunks.try_next().await.map_err(self.failed())? {
            file.write_all(&chunk).await.map_err(unwritable)?;
        }
        file.flush().await.map_err(unwritable)?;
        Ok(true)
    }

    /// Names of all stored objects.
    pub(super) async fn names(&self) -> Result<Vec<String>> {
        let below = self.key(&["blobs"]);
        self.listed(|| async {
            let objects = self.store.list(Some(&below));
            let names = objects.try_filter_map(|object| async move { Ok(name_of(&object)) });
            names.try_collect().await
        })
        .await
    }

    /// Whether any file lies there.
    pub(super) async fn has_files(&self) -> Result<bool> {
        let below = self.key(&["blobs"]);
        self.listed(|| async {
            let mut objects = self.store.list(Some(&below));
            while let Some(object) = objects.try_next().await? {
                if name_of(&object).is_some() {
                    return Ok(true);
                }
            }
            Ok(false)
        })
        .await
    }

    /// Asks again for a list that broke off within an answer, which the crate does for objects alone.
    async fn listed<T, F>(&self, list: impl Fn() -> F) -> Result<T>
    where
        F: Future<Output = object_store::Result<T>>,
    {
        let pauses = ConstantBuilder::new()
            .with_delay(LISTED_AGAIN)
            .with_max_times(LISTED_TIMES);
        let list = list.retry(pauses);
        let list = list.when(|error| matches!(error, Error::Generic { .. }));
        list.await.map_err(self.failed())
    }

    pub(super) async fn remove(&self, names: Vec<String>) -> Result<()> {
        let keys: Vec<_> = names.iter().map(|name| Ok(self.place(name))).collect();
        let mut removed = self.store.delete_stream(stream::iter(keys).boxed());
        let mut failed = Ok(());
        while let Some(one) = removed.next().await {
            match one {
                Ok(_) | Err(Error::NotFound { .. }) => {}
                // one that cannot be removed keeps no other
                Err(error) => failed = failed.and(Err(self.failed()(error))),
            }
        }
        failed
    }

    /// A note of the store beside the files, if it is there.
    pub(super) async fn note(&self, name: &str) -> Result<Option<String>> {
        let got = match self.store.get(&self.key(&["blobs", name])).await {
            Ok(got) => got,
            Err(Error::NotFound { .. }) => return Ok(None),
            Err(error) => return Err(self.failed()(error)),
        };
        let text = got.bytes().await.map_err(self.failed())?;
        let text = String::from_utf8(text.into()).map_err(StoreError::corrupt("note"))?;
        Ok(Some(text))
    }

    pub(super) async fn leave_note(&self, name: &str, text: &str) -> Result<()> {
        let key = self.key(&["blobs", name]);
        let put = self.store.put(&key, text.as_bytes().to_vec().into()).await;
        put.map(|_| ()).map_err(self.failed())
    }

    /// Writes and removes a small object, to find out whether a write works.
    pub(super) async fn try_write(&self) -> Result<()> {
        let key = self.key(&["incoming", &format!("trial-{}", uuid::Uuid::new_v4())]);
        let put = self.store.put(&key, vec![0x5a; 64].into()).await;
        put.map_err(self.failed())?;
        self.store.delete(&key).await.map_err(self.failed())
    }
}

/// SHA-256 of a stored object; `None` of a note beside them.
fn name_of(object: &ObjectMeta) -> Option<String> {
    let name = object.location.filename().unwrap_or_default();
    (name.len() == 64).then(|| name.to_owned())
}

/// An error that came through an interface of input and output.
fn generic(error: std::io::Error) -> Error {
    Error::Generic {
        store: "S3",
        source: Box::new(error),
    }
}
