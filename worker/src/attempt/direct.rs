//! Large contents that go to the server's bucket without going through the server.
//!
//! The server signs an address for each part. What has arrived is known here by the bucket's answers, so
//! after a break, of whichever side, only the missing parts are sent. Where the bucket cannot be reached from
//! here, the content goes through the server after all.
use std::sync::Arc;

use loadframe_api::worker::UploadedPart;
use loadframe_client::ServerError;
use loadframe_client::direct::{Becomes, DirectEnd, DirectRequest, DirectUpload};
use reqwest::{Method, header};
use tokio::sync::Semaphore;
use tokio::task::JoinSet;

use super::content::Content;
use super::lease_client::LeaseClient;

/// Parts on their way at once, each of which is in memory.
const AT_ONCE: usize = 3;
/// A bucket that has taken nothing in so many tries cannot be reached from here.
const TRIES_WITHOUT_A_PART: u32 = 3;

/// After so many ends that the server could not carry out, everything is sent anew.
const ENDS_WITHOUT_SUCCESS: u32 = 5;

/// How far an upload is.
#[derive(Debug, Default)]
struct Progress {
    upload: Option<String>,
    /// The bucket's answers, by part.
    parts: Vec<Option<String>>,
    tries_without: u32,
    /// Ends that the server could not carry out, with the parts that there are.
    ends_without: u32,
}

impl LeaseClient {
    /// Sends a content to the bucket, and has the server take it for what it `becomes`. `false` where it is
    /// to be sent through the server.
    pub(super) async fn send_directly(
        &self,
        content: &Content<'_>,
        becomes: &Becomes,
    ) -> Result<bool, ServerError> {
        if self.direct_from.is_none_or(|from| content.bytes < from) {
            return Ok(false);
        }
        let progress = tokio::sync::Mutex::new(Progress::default());
        self.with_retries(|| async {
            let mut progress = progress.lock().await;
            match self.send_parts(content, &mut progress).await {
                Err(error @ ServerError::Elsewhere { .. })
                    if progress.tries_without >= TRIES_WITHOUT_A_PART =>
                {
                    tracing::warn!(%error, "a file goes through the server instead");
                    return Ok(false);
                }
                sent => sent?,
            }
            let end = DirectEnd {
                upload: progress.upload.clone().unwrap_or_default(),
                bytes: content.bytes,
                parts: progress.parts.iter().flatten().cloned().collect(),
                becomes: becomes.clone(),
            };
            let route = format!("/uploads/{}", content.sha256);
            let request = self.request(Method::POST, &route).json(&end);
            let answer = match self.send_once(request).await {
                Err(error @ ServerError::Unavailable { .. }) => {
                    progress.ends_without += 1;
                    // perhaps the bucket has other parts than this worker believes
                    if progress.ends_without >= ENDS_WITHOUT_SUCCESS {
                        *progress = Progress::default();
                    }
                    return Err(error);
                }
                answer => answer?,
            };
            let ended = answer.json::<UploadedPart>().await;
            let ended = ended.map_err(|error| self.server.unreachable(&error))?;
            if ended.bytes != content.bytes {
                *progress = Progress::default();
                let reason = "the upload is gone and begins anew".to_owned();
                return Err(ServerError::Elsewhere { reason });
            }
            Ok(true)
        })
        .await
    }

    /// Sends the parts that are missing.
    async fn send_parts(
        &self,
        content: &Content<'_>,
        progress: &mut Progress,
    ) -> Result<(), ServerError> {
        let request = DirectRequest {
            sha256: content.sha256.to_owned(),
            bytes: content.bytes,
            upload: progress.upload.clone(),
        };
        let request = self.request(Method::POST, "/uploads").json(&request);
        let answer = self.send_once(request).await?;
        let signed = answer.json::<DirectUpload>().await;
        let signed = signed.map_err(|error| self.server.unreachable(&error))?;
        progress.upload = Some(signed.upload);
        progress.parts.resize(signed.addresses.len(), None);

        let mut sending = JoinSet::new();
        let places = Arc::new(Semaphore::new(AT_ONCE));
        let missing = progress.parts.iter().enumerate();
        let missing: Vec<usize> = missing
            .filter_map(|(index, part)| part.is_none().then_some(index))
            .collect();
        let mut failed = None;
        let mut taken = 0;
        for index in missing {
            let place = Arc::clone(&places).acquire_owned().await;
            while let Some(sent) = sending.try_join_next() {
                taken += note(sent, progress, &mut failed);
            }
            if failed.is_some() {
                break;
            }
            let begin = index as u64 * signed.part_bytes;
            let body = content.read(begin, signed.part_bytes).await?;
            let (server, address) = (self.server.clone(), signed.addresses[index].clone());
            sending.spawn(async move {
                let _place = place;
                let answer = server.put_elsewhere(&address, body).await?;
                let tag = answer.headers().get(header::ETAG);
                let tag = tag.and_then(|tag| tag.to_str().ok());
                let tag = tag.ok_or_else(|| ServerError::Elsewhere {
                    reason: "its answer to a part has no ETag".to_owned(),
                })?;
                Ok((index, tag.to_owned()))
            });
        }
        while let Some(sent) = sending.join_next().await {
            taken += note(sent, progress, &mut failed);
        }
        match failed {
            None => Ok(()),
            Some(error) => {
                progress.tries_without = match taken {
                    0 => progress.tries_without + 1,
                    _ => 0,
                };
                Err(error)
            }
        }
    }
}

/// Notes what became of a part; whether it was taken.
fn note(
    sent: Result<Result<(usize, String), ServerError>, tokio::task::JoinError>,
    progress: &mut Progress,
    failed: &mut Option<ServerError>,
) -> u32 {
    match sent {
        Ok(Ok((index, tag))) => {
            progress.parts[index] = Some(tag);
            1
        }
        Ok(Err(error)) => {
            *failed = Some(error);
            0
        }
        Err(error) => {
            *failed = Some(ServerError::Elsewhere {
                reason: error.to_string(),
            });
            0
        }
    }
}
