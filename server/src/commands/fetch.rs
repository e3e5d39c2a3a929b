//! `loadframe fetch`: result files into a folder, going on where an earlier fetch broke off.
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use futures_util::StreamExt;
use loadframe_api::{FileEntry, JobView, Page, check_file_name};
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::{OUTCOME_FILE, sha256_of_file};
use reqwest::{Method, StatusCode, header};
use tokio::fs::File;
use tokio::io::AsyncWriteExt;
use uuid::Uuid;

use super::connection::Connection;
use super::failure::{Code, Failure};
use super::terminal::{print_json, print_line, size};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Id of the job
    id: Uuid,
    /// Folder to fetch into; files that are there already are not fetched again
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the list of files as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let server = arguments.connection.client()?;
    let path = format!("/v1/jobs/{}", arguments.id);
    let job: JobView = server.json(server.request(Method::GET, &path)).await?;
    let files: Page<FileEntry> = server
        .json(server.request(Method::GET, &job.links.files))
        .await?;
    if files.items.is_empty() {
        let message = format!("the job has no files: {}", job.reason);
        return Err(Failure::new(Code::Failed, message));
    }
    require_own(&arguments.out, &files.items)?;
    // first what tells whose result the folder holds, should this break off
    let mut in_order: Vec<&FileEntry> = files.items.iter().collect();
    in_order.sort_by_key(|entry| entry.name != OUTCOME_FILE);
    let mut fetched = 0;
    for entry in in_order {
        let fetch = Fetch {
            server: &server,
            address: format!("{}/{}", job.links.files, entry.name),
            entry,
            path: place(&arguments.out, entry)?,
        };
        fetched += u64::from(fetch.perform().await?);
    }
    if arguments.json {
        return print_json(&files.items);
    }
    let bytes: u64 = files.items.iter().map(|entry| entry.bytes).sum();
    print_line(&format!(
        "{} files ({}) in {}, {fetched} of them fetched now",
        files.items.len(),
        size(bytes as f64 / 1e6),
        arguments.out.display()
    ));
    Ok(())
}

/// A folder with the result of another job would hold something of both.
fn require_own(folder: &Path, files: &[FileEntry]) -> Result<(), Failure> {
    let there = folder.join(OUTCOME_FILE);
    let of_job = files.iter().find(|entry| entry.name == OUTCOME_FILE);
    let is_own =
        |entry: &FileEntry| sha256_of_file(&there).is_ok_and(|sha256| sha256 == entry.sha256);
    if !there.exists() || of_job.is_some_and(is_own) {
        return Ok(());
    }
    let folder = folder.display();
    let message = format!("{folder} holds another result ({OUTCOME_FILE}); choose another folder");
    Err(Failure::new(Code::Usage, message))
}

/// Where a file goes. A name that leads out of the folder is refused, whoever sent it.
fn place(folder: &Path, entry: &FileEntry) -> Result<PathBuf, Failure> {
    check_file_name(&entry.name)
        .map_err(|error| Failure::new(Code::Failed, format!("{:?}: {error}", entry.name)))?;
    Ok(folder.join(&entry.name))
}

/// One file on its way.
struct Fetch<'a> {
    server: &'a ServerClient,
    address: String,
    entry: &'a FileEntry,
    path: PathBuf,
}

impl Fetch<'_> {
    /// Fetches the file unless it is there; whether it did.
    async fn perform(&self) -> Result<bool, Failure> {
        if self.is_whole(&self.path) {
            return Ok(false);
        }
        if let Some(parent) = self.path.parent() {
            std::fs::create_dir_all(parent).map_err(|error| self.unwritable(&error))?;
        }
        let mut partial = self.path.clone().into_os_string();
        partial.push(".partial");
        let partial = PathBuf::from(partial);
        self.go_on(&partial).await?;
        if !self.is_whole(&partial) {
            // what an earlier fetch left was of something else
            std::fs::remove_file(&partial).map_err(|error| self.unwritable(&error))?;
            self.go_on(&partial).await?;
        }
        if !self.is_whole(&partial) {
            let message = format!("{} arrived damaged", self.entry.name);
            return Err(Failure::new(Code::Failed, message));
        }
        std::fs::rename(&partial, &self.path).map_err(|error| self.unwritable(&error))?;
        Ok(true)
    }

    /// Appends to `partial` what it lacks.
    async fn go_on(&self, partial: &Path) -> Result<(), Failure> {
        let open = File::options()
            .append(true)
            .create(true)
            .open(partial)
            .await;
        let mut file = open.map_err(|error| self.unwritable(&error))?;
        let metadata = file
            .metadata()
            .await
            .map_err(|error| self.unwritable(&error))?;
        let there = metadata.len();
        if there >= self.entry.bytes && there > 0 {
            return Ok(());
        }
        let mut request = self.server.request(Method::GET, &self.address);
        if there > 0 {
            request = request
                .header(header::RANGE, format!("bytes={there}-"))
                .header(header::IF_RANGE, format!("\"{}\"", self.entry.sha256));
        }
        let answer = self.server.send(request).await?;
        if there > 0 && answer.status() != StatusCode::PARTIAL_CONTENT {
            file.set_len(0)
                .await
                .map_err(|error| self.unwritable(&error))?;
        }
        let mut pieces = answer.bytes_stream();
        while let Some(piece) = pieces.next().await {
            let piece = piece.map_err(|error| self.server.unreachable(&error))?;
            file.write_all(&piece)
                .await
                .map_err(|error| self.unwritable(&error))?;
        }
        file.flush().await.map_err(|error| self.unwritable(&error))
    }

    fn is_whole(&self, path: &Path) -> bool {
        sha256_of_file(path).is_ok_and(|sha256| sha256 == self.entry.sha256)
    }

    fn unwritable(&self, error: &io::Error) -> Failure {
        ServerError::File {
            path: self.path.display().to_string(),
            reason: error.to_string(),
        }
        .into()
    }
}
