//! `loadframe backup` and `loadframe restore`: database and files of a server, in the right order.
use std::path::PathBuf;

use clap::Args;
use loadframe_server::store::{BackupReport, LostFile, backup_from, restore_to};

use super::failure::{Code, Failure};
use super::files::FilesOptions;
use super::terminal::{print_error, print_json, print_line, size};

#[derive(Debug, Args)]
pub(crate) struct BackupArguments {
    /// Data folder of the server
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    #[command(flatten)]
    files: FilesOptions,
    /// Empty folder for the backup
    #[arg(long, value_name = "DIR")]
    to: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RestoreArguments {
    /// Folder of the backup
    #[arg(long, value_name = "DIR")]
    from: PathBuf,
    /// Empty folder that a server is to be started on
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    #[command(flatten)]
    files: FilesOptions,
    /// Restore although files of the backup are missing or have changed
    #[arg(long)]
    even_if_incomplete: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(crate) async fn back_up(arguments: BackupArguments) -> Result<(), Failure> {
    let BackupArguments {
        data,
        files,
        to,
        json,
    } = arguments;
    let report = backup_from(&data, &files.place()?, &to).await;
    let report = report.map_err(|error| Failure::of(&error))?;
    tell(&report, &format!("to {}", to.display()), json)
}

pub(crate) async fn bring_back(arguments: RestoreArguments) -> Result<(), Failure> {
    let RestoreArguments {
        from,
        data,
        files,
        even_if_incomplete,
        json,
    } = arguments;
    let report = restore_to(&from, &data, &files.place()?, even_if_incomplete).await;
    let report = report.map_err(|error| Failure::of(&error))?;
    if !report.lost.is_empty() && !even_if_incomplete {
        print_error("the database was not put in place; --even-if-incomplete does it all the same");
    }
    tell(&report, &format!("to {}", data.display()), json)
}

fn tell(report: &BackupReport, place: &str, json: bool) -> Result<(), Failure> {
    if json {
        print_json(report)?;
    } else {
        let bytes = size(report.bytes as f64 / 1e6);
        print_line(&format!("{} files, {bytes}, {place}.", report.files));
    }
    refuse_lost(&report.lost)
}

/// Names the files that are lost; a command that found any has failed.
pub(super) fn refuse_lost(lost: &[LostFile]) -> Result<(), Failure> {
    for LostFile {
        job, file, loss, ..
    } in lost
    {
        print_error(&format!("{file} of job {job} {loss}"));
    }
    if lost.is_empty() {
        return Ok(());
    }
    let message = format!("{} files of jobs are lost", lost.len());
    Err(Failure::new(Code::Failed, message))
}
