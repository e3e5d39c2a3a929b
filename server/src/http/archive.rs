//! Everything a job left, as a zip that is written while it is sent.
use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use futures_util::TryStreamExt;
use futures_util::stream::{self, BoxStream};
use loadframe_api::{FileEntry, JobView, check_file_name};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

use super::AppState;
use super::permit::{JobPermit, ReadFiles};
use super::problem::{ApiError, Result};
use crate::tasks::blocking;

/// What is written at a time [bytes].
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
    let folder = folder_name(&job);
    let disposition = HeaderValue::try_from(format!("attachment; filename=\"{folder}.zip\""))
        .map_err(|error| ApiError::internal(&error))?;

    let archive = Archive::new(state, id, folder, entries);
    let pieces = stream::try_unfold(archive, move |archive| async move {
        let next = archive.next().await;
        next.inspect_err(|error| tracing::info!(job_id = %id, %error, "an archive was broken off"))
    });
    let headers = [
        (
            header::CONTENT_TYPE,
            HeaderValue::from_static("application/zip"),
        ),
        (header::CONTENT_DISPOSITION, disposition),
    ];
    Ok((headers, Body::from_stream(pieces)).into_response())
}

/// An archive as far as it is written.
///
/// It is written a piece at a time, when its client has taken the one before: a client that does not
/// read holds no thread and no turn of others.
struct Archive {
    state: AppState,
    id: Uuid,
    folder: String,
    entries: std::vec::IntoIter<FileEntry>,
    /// What is being added.
    file: Option<BoxStream<'static, io::Result<Bytes>>>,
    written: Written,
}

/// What a thread that compresses takes along.
struct Written {
    /// `None` after the end.
    zip: Option<ZipWriter<StreamWriter<Piece>>>,
    piece: Piece,
    /// A piece of the file that is being added.
    read: Option<Bytes>,
}

impl Archive {
    fn new(state: AppState, id: Uuid, folder: String, entries: Vec<FileEntry>) -> Self {
        let piece = Piece::default();
        Self {
            state,
            id,
            folder,
            entries: entries.into_iter(),
            file: None,
            written: Written {
                zip: Some(ZipWriter::new_stream(piece.clone())),
                piece,
                read: None,
            },
        }
    }

    /// The next piece and the rest; `None` after the end. An error breaks the connection: the client
    /// must not take a part for the whole.
    async fn next(mut self) -> io::Result<Option<(Bytes, Self)>> {
        while self.written.zip.is_some() && self.written.piece.len() < PIECE {
            if self.file.is_none()
                && let Some(entry) = self.entries.next()
            {
                let content = self.state.store.content(self.id, &entry).await;
                let content = content.map_err(io::Error::other)?;
                let bytes = content.read(0..entry.bytes).await;
                self.file = Some(bytes.map_err(io::Error::other)?);
                let name = format!("{}/{}", self.folder, entry.name);
                self.written.begin(&name, entry.bytes)?;
            }
            if let Some(file) = &mut self.file {
                self.written.read = file.try_next().await?;
                if self.written.read.is_none() {
                    self.file = None;
                    continue;
                }
            }
            let turn = self.state.archives.clone().acquire_owned().await;
            let _turn = turn.map_err(io::Error::other)?;
            let written = self.written;
            let worked = blocking(move || written.go_on()).await;
            self.written = worked.map_err(io::Error::other)??;
        }
        let piece = self.written.piece.take();
        Ok((!piece.is_empty()).then_some((piece, self)))
    }
}

impl Written {
    /// Begins a file of the archive.
    fn begin(&mut self, name: &str, bytes: u64) -> io::Result<()> {
        // snapshots are compressed inside
        let method = match name.rsplit_once('.') {
            Some((_, "vtp" | "vtu")) => CompressionMethod::Stored,
            _ => CompressionMethod::Deflated,
        };
        let options = SimpleFileOptions::default()
            .compression_method(method)
            .large_file(bytes > LARGE);
        if let Some(zip) = &mut self.zip {
            zip.start_file(name, options).map_err(io::Error::other)?;
        }
        Ok(())
    }

    /// Writes what was read; when there is nothing more, the end.
    fn go_on(mut self) -> io::Result<Self> {
        match self.read.take() {
            Some(read) => {
                if let Some(zip) = &mut self.zip {
                    zip.write_all(&read)?;
                }
            }
            None => {
                if let Some(zip) = self.zip.take() {
                    zip.finish().map_err(io::Error::other)?;
                }
            }
        }
        Ok(self)
    }
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

/// What is written and not sent yet; a clone is another handle on the same.
#[derive(Clone, Debug, Default)]
struct Piece(Arc<Mutex<Vec<u8>>>);

impl Piece {
    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn len(&self) -> usize {
        self.bytes().len()
    }

    fn take(&self) -> Bytes {
        std::mem::take(&mut *self.bytes()).into()
    }
}

impl Write for Piece {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
