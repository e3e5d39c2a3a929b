//! `loadframe scrub`: are all files that jobs name there, and what they were?
use std::path::PathBuf;

use clap::Args;
use loadframe_server::store::{Store, StoreOptions};

use super::backup::refuse_lost;
use super::database::DatabaseOptions;
use super::failure::Failure;
use super::files::FilesOptions;
use super::terminal::{print_json, print_line, size};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Data folder of the server
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    #[command(flatten)]
    database: DatabaseOptions,
    #[command(flatten)]
    files: FilesOptions,
    /// End the wait of files that no job names: a server removes them within the hour
    #[arg(long)]
    remove_unnamed: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let Arguments {
        data,
        database,
        files,
        remove_unnamed,
        json,
    } = arguments;
    let options = StoreOptions {
        database: database.place()?,
        files: files.place()?,
        ..StoreOptions::new(&data)
    };
    let store = Store::open_beside(options).await;
    let store = store.map_err(|error| Failure::of(&error))?;
    let report = store.scrub(None).await;
    let report = report.map_err(|error| Failure::of(&error))?;
    if remove_unnamed {
        let released = store.release_unnamed().await;
        released.map_err(|error| Failure::of(&error))?;
    }
    if json {
        print_json(&report)?;
    } else {
        let bytes = size(report.bytes as f64 / 1e6);
        print_line(&format!(
            "{} stored files, {bytes}, were held against their SHA-256; {} more are named by no job.",
            report.files, report.unnamed
        ));
    }
    refuse_lost(&report.lost)
}
