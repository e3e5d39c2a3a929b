//! Files that workers send to the bucket by themselves.
//!
//! A worker gets an address for each part, signed for an hour, that takes this part of this upload and
//! nothing else. The parts lie where no name leads: an upload in parts is an object only when this server,
//! which alone has the keys, puts them together. It then reads the object back, holds it against the
//! SHA-256 that the worker gave, and copies it to the place of that hash. Nothing is kept here meanwhile:
//! the key is that of the lease and the hash, and the worker remembers the upload and its parts, so that
//! either side may be started again in between.
use std::time::Duration;

use object_store::multipart::{MultipartStore, PartId};
use object_store::path::Path;
use object_store::signer::{Method, SignedUrlOptions, Signer};
use object_store::{Error, ObjectStoreExt};
use uuid::Uuid;

use super::super::error::{Result, StoreError};
use super::{Bucket, Found};

/// Bytes of a part: S3 takes 10 000 of 5 MB or more, the last of any size.
pub(in super::super) const PART: u64 = 16 << 20;
/// How long the addresses of parts are good for.
const GOOD_FOR: Duration = Duration::from_secs(3600);
/// How long the address of a download is good for: it is followed at once.
const DOWNLOAD_GOOD_FOR: Duration = Duration::from_secs(300);
/// S3 copies objects up to 5 GB in one request (CopyObject); larger ones are read and sent.
const COPIED_AT_ONCE: u64 = 5_000_000_000;

/// Where the parts of an upload go.
#[derive(Clone, Debug)]
pub(in super::super) struct Signed {
    pub(in super::super) upload: String,
    pub(in super::super) addresses: Vec<String>,
    pub(in super::super) good_for: Duration,
}

/// What has come of an upload in parts.
#[derive(Clone, Debug)]
pub(in super::super) enum Together {
    /// It is in its place; as this object, where it is a copy of what was read back.
    There(Option<Found>),
    /// There is neither such an upload nor what came of it.
    Gone,
}

impl Bucket {
    fn arriving(&self, lease: Uuid, sha256: &str) -> Path {
        self.key(&["incoming", &format!("{}-{sha256}", lease.simple())])
    }

    /// Addresses for the parts of a content of so many bytes, of a new upload or of one that was begun.
    pub(in super::super) async fn sign_parts(
        &self,
        lease: Uuid,
        sha256: &str,
        bytes: u64,
        begun: Option<String>,
    ) -> Result<Signed> {
        let key = self.arriving(lease, sha256);
        let upload = match begun {
            Some(upload) => upload,
            None => {
                let created = self.store.create_multipart(&key).await;
                created.map_err(self.failed())?
            }
        };
        let mut addresses = Vec::new();
        for part in 1..=bytes.div_ceil(PART) {
            let query = [
                ("partNumber", part.to_string()),
                ("uploadId", upload.clone()),
            ];
            let options = SignedUrlOptions::default().with_query(query);
            let signed = self
                .store
                .signed_url_opts(Method::PUT, &key, GOOD_FOR, &options);
            addresses.push(signed.await.map_err(self.failed())?.into());
        }
        Ok(Signed {
            upload,
            addresses,
            good_for: GOOD_FOR,
        })
    }

    /// Puts the parts together, holds the object against its hash, and puts it in its place. May be
    /// repeated after it broke off anywhere.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] when the content is another; the bucket's.
    pub(in super::super) async fn put_together(
        &self,
        lease: Uuid,
        sha256: &str,
        bytes: u64,
        upload: &str,
        parts: Vec<String>,
    ) -> Result<Together> {
        let key = self.arriving(lease, sha256);
        let parts = parts.into_iter().map(|content_id| PartId { content_id });
        let id = upload.to_owned();
        let completed = self.patient.complete_multipart(&key, &id, parts.collect());
        // it may have been completed before, by a message whose answer was lost
        let completed = completed.await;
        let found = match self.hash_of(&key).await? {
            Some(found) => found,
            None => {
                let length = self.look(sha256).await?.map(|found| found.bytes);
                return match completed {
                    // copied and removed before
                    _ if length == Some(bytes) => Ok(Together::There(None)),
                    Ok(_) | Err(Error::NotFound { .. }) => Ok(Together::Gone),
                    // the parts may well be there
                    Err(error) => Err(self.failed()(error)),
                };
            }
        };
        if found != (sha256.to_owned(), bytes) {
            self.store.delete(&key).await.map_err(self.failed())?;
            let sentence = format!(
                "what was sent has {} bytes and the SHA-256 {}, not {bytes} and {sha256}",
                found.1, found.0
            );
            return Err(StoreError::Invalid(sentence));
        }
        let copy = self.move_to_place(&key, sha256, bytes).await?;
        Ok(Together::There(copy))
    }

    /// Nobody can change the object any more: its upload is over, and no address for it was ever signed.
    async fn move_to_place(&self, key: &Path, sha256: &str, bytes: u64) -> Result<Option<Found>> {
        let copy = if bytes <= COPIED_AT_ONCE {
            let copied = self.patient.copy(key, &self.place(sha256)).await;
            copied.map_err(self.failed())?;
            self.look(sha256).await?
        } else {
            self.send_on(key, sha256).await?;
            None
        };
        match self.store.delete(key).await {
            Ok(()) | Err(Error::NotFound { .. }) => Ok(copy),
            Err(error) => Err(self.failed()(error)),
        }
    }

    /// A signed address from which `sha256` is downloaded for the next minutes.
    pub(in super::super) async fn signed_download(
        &self,
        sha256: &str,
        media_type: &str,
        disposition: &str,
    ) -> Result<String> {
        let options = SignedUrlOptions::default().with_query([
            ("response-content-type", media_type),
            ("response-content-disposition", disposition),
        ]);
        let place = self.place(sha256);
        let signed = self
            .store
            .signed_url_opts(Method::GET, &place, DOWNLOAD_GOOD_FOR, &options);
        Ok(signed.await.map_err(self.failed())?.into())
    }
}
