//! What is sent to the server or its bucket, from a file or from memory.
use std::io::SeekFrom;
use std::path::Path;

use bytes::Bytes;
use loadframe_client::ServerError;
use tokio::fs::File;
use tokio::io::{AsyncReadExt, AsyncSeekExt};

/// A content that is to be sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Content<'c> {
    pub(super) sha256: &'c str,
    pub(super) bytes: u64,
    pub(super) source: Source<'c>,
}

/// Where its bytes are.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source<'c> {
    File(&'c Path),
    Memory(&'c Bytes),
}

impl Content<'_> {
    /// Its bytes from `begin` on, so many.
    pub(super) async fn read(&self, begin: u64, length: u64) -> Result<Vec<u8>, ServerError> {
        let path = match self.source {
            Source::Memory(bytes) => {
                let [begin, end] = [begin, begin + length].map(|place| {
                    usize::try_from(place)
                        .unwrap_or(usize::MAX)
                        .min(bytes.len())
                });
                return Ok(bytes[begin..end].to_vec());
            }
            Source::File(path) => path,
        };
        let read = async {
            let mut file = File::open(path).await?;
            file.seek(SeekFrom::Start(begin)).await?;
            let mut part = Vec::new();
            file.take(length).read_to_end(&mut part).await?;
            Ok(part)
        };
        read.await
            .map_err(|error: std::io::Error| ServerError::File {
                path: path.display().to_string(),
                reason: error.to_string(),
            })
    }
}
