//! Large files and checkpoints that a worker sends to the bucket by itself ([`super::bucket`]), and that
//! become the attempt's when they have arrived whole and right.
use loadframe_api::FileEntry;
use loadframe_api::worker::{CheckpointQuery, UploadedPart};
use loadframe_client::direct::{Becomes, DirectEnd, DirectRequest, DirectUpload};

use super::blobs::{check_sha256, to_the_end};
use super::bucket::direct::{PART, Together};
use super::checkpoints::{LARGEST_CHECKPOINT, check_times};
use super::error::{Result, StoreError};
use super::files::{LARGEST_FILE, check_upload_name};
use super::reserve::admit;
use super::{LeaseKey, Store};

impl Store {
    /// Files of so many bytes or more are sent to the bucket by workers themselves; `None` where none are.
    pub fn direct_from(&self) -> Option<u64> {
        self.blobs().storage.bucket()?.settings().direct_from
    }

    /// Signed addresses for the parts of a content, of a new upload or one that was begun under this lease.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`]; [`StoreError::Invalid`] where files are not sent so;
    /// [`StoreError::TooLarge`]; the bucket's.
    pub async fn begin_direct(
        &self,
        key: LeaseKey,
        request: DirectRequest,
    ) -> Result<DirectUpload> {
        check_sha256(&request.sha256)?;
        admit(&self.0.reserve)?;
        let from = self.direct_from().unwrap_or(u64::MAX);
        let bucket = self.blobs().storage.bucket();
        let (Some(bucket), true) = (bucket, request.bytes >= from.max(1)) else {
            let sentence = "a file of this size is sent through the server";
            return Err(StoreError::Invalid(sentence.to_owned()));
        };
        if request.bytes > LARGEST_CHECKPOINT {
            let (what, limit) = ("a file", LARGEST_CHECKPOINT);
            return Err(StoreError::TooLarge { what, limit });
        }
        self.check_lease(key).await?;
        let signed = bucket.sign_parts(key.id, &request.sha256, request.bytes, request.upload);
        let signed = signed.await?;
        Ok(DirectUpload {
            upload: signed.upload,
            part_bytes: PART,
            addresses: signed.addresses,
            good_for_s: signed.good_for.as_secs_f64(),
        })
    }

    /// Puts the parts together, holds the content against its SHA-256 by reading it back, and makes it what
    /// it is to be, even when nobody waits for it any more; no bytes are kept when it has to be sent anew. The
    /// same message may be repeated.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`]; [`StoreError::Invalid`] for a bad name or another content; the bucket's.
    pub async fn end_direct(
        &self,
        key: LeaseKey,
        sha256: &str,
        end: DirectEnd,
    ) -> Result<UploadedPart> {
        let (store, sha256) = (self.clone(), sha256.to_owned());
        to_the_end(async move { store.put_together(key, &sha256, end).await }).await
    }

    async fn put_together(
        &self,
        key: LeaseKey,
        sha256: &str,
        end: DirectEnd,
    ) -> Result<UploadedPart> {
        check_sha256(sha256)?;
        let (what, limit) = match &end.becomes {
            Becomes::File { name } => {
                check_upload_name(name)?;
                ("a file", LARGEST_FILE)
            }
            Becomes::Checkpoint { .. } => ("a checkpoint", LARGEST_CHECKPOINT),
        };
        if end.bytes > limit {
            return Err(StoreError::TooLarge { what, limit });
        }
        let Some(bucket) = self.blobs().storage.bucket() else {
            let sentence = "files are sent through this server";
            return Err(StoreError::Invalid(sentence.to_owned()));
        };
        self.check_lease(key).await?;
        let together = bucket.put_together(key.id, sha256, end.bytes, &end.upload, end.parts);
        match together.await? {
            Together::There(Some(copy)) => self.blobs().remember(sha256, copy),
            Together::There(None) => {}
            Together::Gone => return Ok(UploadedPart { bytes: 0 }),
        }
        let guard = self.blobs().guard(sha256).await?;
        // what the collector removed just before is sent again
        if self.blobs().verified(sha256, end.bytes).await?.is_err() {
            return Ok(UploadedPart { bytes: 0 });
        }
        match end.becomes {
            Becomes::File { name } => {
                let entry = FileEntry {
                    name,
                    bytes: end.bytes,
                    sha256: sha256.to_owned(),
                };
                self.name_file(key, &entry, guard).await?;
            }
            Becomes::Checkpoint { wall_s, cpu_s } => {
                let query = CheckpointQuery {
                    sha256: sha256.to_owned(),
                    wall_s,
                    cpu_s,
                };
                check_times(&query)?;
                self.name_checkpoint(key, &query, end.bytes, guard).await?;
            }
        }
        Ok(UploadedPart { bytes: end.bytes })
    }
}
