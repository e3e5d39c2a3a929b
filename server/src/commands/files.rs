//! Where a server's files are: options of `serve`, `lab`, `scrub`, `backup` and `restore`.
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use loadframe_server::store::{BucketKeys, BucketSettings, FilesPlace};

use super::failure::{Code, Failure};
use super::number::positive;

/// Variables that hold keys, as other programs that speak S3 know them.
const KEY_ID: &str = "AWS_ACCESS_KEY_ID";
const KEY_SECRET: &str = "AWS_SECRET_ACCESS_KEY";
const KEY_SESSION: &str = "AWS_SESSION_TOKEN";

/// A bucket, where the files are in one.
#[derive(Clone, Debug, Args)]
pub(crate) struct FilesOptions {
    /// Keep files in a bucket that speaks S3 instead of the data folder; its keys come from --files-keys or
    /// from `AWS_ACCESS_KEY_ID` and `AWS_SECRET_ACCESS_KEY`
    #[arg(long, env = "LOADFRAME_FILES", value_name = "s3://BUCKET/PREFIX")]
    files: Option<String>,
    /// Address of the bucket's server; Amazon's when left out
    #[arg(long, env = "LOADFRAME_FILES_ENDPOINT", value_name = "URL")]
    files_endpoint: Option<String>,
    /// Region of the bucket
    #[arg(
        long,
        env = "LOADFRAME_FILES_REGION",
        value_name = "REGION",
        default_value = "us-east-1"
    )]
    files_region: String,
    /// File of two lines, the id of the bucket's key and its secret, which others must not be able to read
    #[arg(long, env = "LOADFRAME_FILES_KEYS", value_name = "FILE")]
    files_keys: Option<PathBuf>,
}

/// How files go to and from a bucket, for a server.
#[derive(Clone, Debug, Args)]
pub(crate) struct WaysOptions {
    /// How workers send large files to a bucket
    #[arg(
        long,
        env = "LOADFRAME_UPLOADS",
        value_enum,
        default_value_t = Way::Direct
    )]
    uploads: Way,
    /// From so many megabytes on a file is sent directly
    #[arg(long, env = "LOADFRAME_DIRECT_FROM_MB", value_name = "MB", default_value_t = 16.8, value_parser = positive)]
    direct_from_mb: f64,
    /// How files come from a bucket to whoever fetches them; what the page shows always goes through the server
    #[arg(
        long,
        env = "LOADFRAME_DOWNLOADS",
        value_enum,
        default_value_t = Way::Through
    )]
    downloads: Way,
}

/// A way between the bucket and others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Way {
    /// By addresses that the server signs, for which the bucket's server must be within their reach
    Direct,
    /// Through the server
    Through,
}

impl FilesOptions {
    /// Where the files are.
    ///
    /// # Errors
    /// When the options do not fit, or there are no keys.
    pub(crate) fn place(&self) -> Result<FilesPlace, Failure> {
        let refuse = |sentence: String| Failure::new(Code::Usage, sentence);
        // an empty variable is none
        let given = |option: &Option<String>| option.clone().filter(|text| !text.is_empty());
        let Some(address) = given(&self.files) else {
            return Ok(FilesPlace::Folder);
        };
        let endpoint = given(&self.files_endpoint);
        let settings = BucketSettings::at(&address, endpoint.as_deref(), &self.files_region);
        let keys = match &self.files_keys {
            Some(file) => BucketKeys::read(file).map_err(refuse)?,
            None => keys_of_environment().ok_or_else(|| {
                refuse(format!(
                    "the bucket's keys are missing: give --files-keys FILE, or {KEY_ID} and {KEY_SECRET}"
                ))
            })?,
        };
        Ok(FilesPlace::Bucket(BucketSettings {
            keys: Some(keys),
            ..settings.map_err(refuse)?
        }))
    }
}

impl WaysOptions {
    /// The same place, used in these ways.
    pub(crate) fn of(&self, place: FilesPlace) -> FilesPlace {
        match place {
            FilesPlace::Folder => FilesPlace::Folder,
            FilesPlace::Bucket(settings) => FilesPlace::Bucket(BucketSettings {
                direct_from: (self.uploads == Way::Direct)
                    .then_some((self.direct_from_mb * 1e6).ceil() as u64),
                redirects: self.downloads == Way::Direct,
                ..settings
            }),
        }
    }
}

fn keys_of_environment() -> Option<BucketKeys> {
    let variable = |name| std::env::var(name).ok().filter(|text| !text.is_empty());
    Some(BucketKeys {
        id: variable(KEY_ID)?,
        secret: variable(KEY_SECRET)?,
        session: variable(KEY_SESSION),
    })
}
