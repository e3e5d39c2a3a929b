//! What can go wrong in the store, by whose fault.
use std::path::PathBuf;

use serde::Serialize;
use uuid::Uuid;

use super::database::refuses_text;
use crate::tasks::NotDone;

/// What the store gives, or why not.
pub(super) type Result<T, E = StoreError> = std::result::Result<T, E>;

/// Why the store did not do what it was asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// 404: there is no such job, file, curve, outcome or token.
    #[error("there is no {0}")]
    NotFound(String),
    /// 409: the state of the job does not allow it; the sentence says what would help.
    #[error("{0}")]
    Conflict(String),
    /// 412: somebody else has edited the job since.
    #[error(
        "its name, notes, tags or priority have been changed since you read the job; read it again, and change what should still be changed"
    )]
    Edited,
    /// 409: the worker no longer holds the lease it writes under.
    #[error(
        "the lease is no longer held: the attempt has ended or belongs to another worker; stop the work and claim anew"
    )]
    LeaseLost,
    /// 422: the key was used before with another body or project.
    #[error("the Idempotency-Key was used before with another body or project; use a fresh key")]
    KeyReused,
    /// 422: what was sent cannot be taken; the sentence says why.
    #[error("{0}")]
    Invalid(String),
    /// 422: what is wrong with what was sent, each thing with its place.
    #[error("{} violations", .0.len())]
    Refused(Vec<loadframe_api::Violation>),
    /// 413: larger than the store takes.
    #[error("{what} is larger than {limit} bytes")]
    TooLarge { what: &'static str, limit: u64 },
    /// 400: the body broke off before its end.
    #[error("the upload broke off")]
    Interrupted(#[source] std::io::Error),
    /// 503: the writer has stopped or its transaction was rolled back; trying again may help.
    #[error("the store did not take the change; try again")]
    Unavailable,
    /// 507: the disk is full; what frees or saves something is still taken.
    #[error(
        "the server's disk is full: jobs, results and claims have to wait, cancels still work; it heals by itself when there is room again"
    )]
    Full,
    /// 503: the data folder belongs to a running server.
    #[error("{} is in use by another loadframe server", .0.display())]
    InUse(PathBuf),
    /// The data folder is on a network file system, on which SQLite does not work.
    #[error(
        "{} is on {system}, a network file system, where SQLite's locks and shared memory do not hold and the database would break; give --data a folder on a local disk of the server (backups may go to {system})", folder.display()
    )]
    NetworkDisk {
        folder: PathBuf,
        system: &'static str,
    },
    /// The database and the folder of files are not those of one store.
    #[error("{0}")]
    NotTogether(String),
    /// 500: a stored file is missing, or is not what was stored.
    #[error("{file} of job {job} {loss}")]
    Lost { job: Uuid, file: String, loss: Loss },
    /// 500: the database refused a statement.
    #[error("the database failed")]
    Database(#[source] sqlx::Error),
    /// The database has been brought up to date by a newer version.
    #[error(
        "the database is of a newer version of loadframe: it has step {found} of its schema, this version knows {known}; start the newer version, or put back a backup from before it"
    )]
    Newer { found: i64, known: i64 },
    /// 500: the database cannot be brought to this version's schema.
    #[error("the database could not be migrated")]
    Migration(#[from] sqlx::migrate::MigrateError),
    /// 500: a file could not be read or written.
    #[error("{} could not be used", path.display())]
    File {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    /// 503: the bucket of files does not do what it should; trying again may help.
    #[error("the bucket of files, {place}, could not be used")]
    Bucket {
        place: String,
        #[source]
        source: Box<object_store::Error>,
    },
    /// 500: something stored cannot be read back.
    #[error("stored {what} cannot be read")]
    Corrupt {
        what: &'static str,
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl From<NotDone> for StoreError {
    fn from(_: NotDone) -> Self {
        Self::Unavailable
    }
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        if refuses_text(&error) {
            let sentence = "a text holds a zero byte, which this server's database does not keep";
            return Self::Invalid(sentence.to_owned());
        }
        Self::Database(error)
    }
}

impl StoreError {
    /// For `map_err`: a stored thing that cannot be read back.
    pub(super) fn corrupt<E>(what: &'static str) -> impl FnOnce(E) -> Self
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        move |source| Self::Corrupt {
            what,
            source: source.into(),
        }
    }

    /// For `map_err`: a file that could not be used.
    pub(super) fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::File { path, source }
    }
}

/// An error with all its causes.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}

/// Why a stored file cannot be given out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// It is not there.
    Missing,
    /// It was not what its SHA-256 says, and has been set aside.
    Changed,
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Missing => "is missing from the folder of files",
            Self::Changed => "is not what was stored; what was found is in the folder set-aside",
        })
    }
}
