//! Everything a job left, as a zip that is written while it is sent.
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::{JobView, check_file_name};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::AppState;
use super::permit::{JobPermit, ReadFiles};
use super::problem::{ApiError, Result};

/// Pieces between the writer and the connection, and their size [bytes].
const PIECES: usize = 4;
const PIECE: usize = 64 << 10;
/// Larger files need the 64-bit form of zip.
const LARGE: u64 = u32::MAX as u64 / 2;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(download))
}

/// Download all result files
///
/// A zip in which every name begins with a folder named for the job.
#[utoipa::path(get, operation_id = "download_archive", path = "/v1/jobs/{id}/archive.zip", tag = "Results",
    params(("id" = uuid::Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The zip, written while it is sent", body = String, content_type = "application/zip",
               headers(("Content-Disposition" = String))),
              (status = 404, description = "There is no such job, or it has no files yet")))]
async fn download(State(state): State<AppState>, permit: JobPermit<ReadFiles>) -> Result<Response> {
    let id = permit.id;
    let job = state.store.job(id).await?;
    let entries = state.store.files(id).await?;
    if entries.is_empty() {
        return Err(ApiError::not_found("file of this job yet"));
    }
    let waiting = Duration::from_secs(10);
    let turn = tokio::time::timeout(waiting, state.archives.clone().acquire_owned()).await;
    let Ok(Ok(turn)) = turn else {
        return Err(ApiError::busy("too many archives are being downloaded", 10));
    };
    let folder = folder_name(&job);
    let disposition = HeaderValue::try_from(format!("attachment; filename=\"{folder}.zip\""))
        .map_err(|error| ApiError::internal(&error))?;

    let (pieces, sent) = mpsc::channel(PIECES);
    let runtime = tokio::runtime::Handle::current();
    tokio::task::spawn_blocking(move || {
        let _turn = turn;
        let mut out = ChunkWriter::new(pieces.clone());
        let mut zip = ZipWriter::new_stream(&mut out);
        let mut write = || -> io::Result<()> {
            for entry in &entries {
                let path = runtime.block_on(state.store.content(id, entry));
                let path = path.map_err(io::Error::other)?;
                add(
                    &mut zip,
                    &format!("{folder}/{}", entry.name),
                    path,
                    entry.bytes,
                )?;
            }
            Ok(())
        };
        let written = write();
        let ended = zip.finish().map(drop).map_err(io::Error::other);
        let sent = out.send();
        if let Err(error) = written.and(ended).and(sent) {
            tracing::info!(job_id = %id, %error, "an archive was broken off");
            // an error as the last piece breaks the connection: the client must not take a part for the whole
            let _ = pieces.blocking_send(Err(error));
        }
    });
    let headers = [
        (
            header::CONTENT_TYPE,
            HeaderValue::from_static("application/zip"),
        ),
        (header::CONTENT_DISPOSITION, disposition),
    ];
    Ok((headers, Body::from_stream(ReceiverStream::new(sent))).into_response())
}

fn add<W: Write>(
    zip: &mut ZipWriter<zip::write::StreamWriter<W>>,
    name: &str,
    path: PathBuf,
    bytes: u64,
) -> io::Result<()> {
    // snapshots are compressed inside
    let method = match name.rsplit_once('.') {
        Some((_, "vtp" | "vtu")) => CompressionMethod::Stored,
        _ => CompressionMethod::Deflated,
    };
    let options = SimpleFileOptions::default()
        .compression_method(method)
        .large_file(bytes > LARGE);
    zip.start_file(name, options).map_err(io::Error::other)?;
    io::copy(&mut File::open(path)?, zip)?;
    Ok(())
}

/// The job's name as a file name, with the beginning of its id.
fn folder_name(job: &JobView) -> String {
    /// Leaves room for the longest file name.
    const LONGEST: usize = 60;
    let mut name = String::new();
    for c in job.name.chars() {
        if name.len() >= LONGEST {
            break;
        }
        if c.is_ascii_alphanumeric() {
            name.push(c.to_ascii_lowercase());
        } else if !name.ends_with('-') {
            name.push('-');
        }
    }
    let id = job.id.simple().to_string();
    let name = format!("{}-{}", name.trim_matches('-'), &id[id.len() - 8..]);
    let name = name.trim_matches('-').to_owned();
    debug_assert!(check_file_name(&name).is_ok());
    name
}

/// A writer whose bytes go to a channel in pieces.
#[derive(Debug)]
struct ChunkWriter {
    sender: mpsc::Sender<io::Result<Bytes>>,
    piece: Vec<u8>,
}

impl ChunkWriter {
    fn new(sender: mpsc::Sender<io::Result<Bytes>>) -> Self {
        Self {
            sender,
            piece: Vec::with_capacity(PIECE),
        }
    }

    fn send(&mut self) -> io::Result<()> {
        let piece = std::mem::replace(&mut self.piece, Vec::with_capacity(PIECE));
        let gone = |_| io::Error::new(io::ErrorKind::BrokenPipe, "the client has gone");
        self.sender.blocking_send(Ok(piece.into())).map_err(gone)
    }
}

impl Write for ChunkWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.piece.extend_from_slice(bytes);
        if self.piece.len() >= PIECE {
            self.send()?;
        }
        Ok(bytes.len())
    }

    /// Deflate flushes often; only a full piece or the end is worth a packet.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
