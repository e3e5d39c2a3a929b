//! The store: jobs, attempts, curves, files, events, workers and tokens. Every SQL statement of
//! the system is in this folder; nothing outside it knows that there is a database.
//!
//! In `data` lie `loadframe.db` (SQLite: write-ahead log, durable at every commit), `blobs/` (files
//! under their SHA-256, with the name of the store), `incoming/` (files on their way), `set-aside/` (files
//! that were not what their names say) and `lock` (one server a folder).
//!
//! A change goes `Store::…` → [`writer`] (one connection, group commit) → the command's method on
//! [`writer::Change`] → for steps of a job's lifecycle [`state`], which asks [`crate::queue`] → events →
//! commit → answer. Reads go to a pool of connections that cannot write, beside it.
//!
//! The worker's side in the order of a job: [`claim`], [`lease`] with [`curve`] and [`log`],
//! [`files`] over [`blobs`], [`ending`]; if the worker falls silent, [`sweep`]. Whose things are, and what
//! was done by whom: [`people`].
//!
//! That nothing is lost unseen: [`identity`] tells whether database and files belong together, the
//! [`collector`] removes what no row names, [`scrub`] finds what is missing or has changed, and [`backup`]
//! copies both in the right order.
mod backup;
mod blobs;
mod claim;
mod collector;
mod curve;
mod encoding;
mod ending;
mod error;
mod events;
mod files;
mod identity;
mod jobs;
mod lease;
mod log;
mod migrations;
mod open;
pub mod people;
mod private;
mod row;
mod scrub;
mod state;
mod submit;
mod sweep;
mod types;
mod workers;
mod writer;

use std::fs::File;
use std::sync::Arc;
use std::time::Duration;

use sqlx::SqlitePool;
use tokio::sync::watch;

pub use backup::{BackupReport, backup, restore};
use blobs::Blobs;
pub use blobs::Loss;
use error::Result;
pub use error::StoreError;
pub use events::StoredEvent;
use people::{AccessState, Actor};
pub use scrub::{LostFile, ScrubReport};
pub use types::*;
use writer::{Change, Work, Writer};

/// The store; a clone is another handle on the same one. What is changed through a handle is written
/// down as done by its actor, if it has one.
#[derive(Clone, Debug)]
pub struct Store(Arc<Inner>, Option<Arc<Actor>>);

#[derive(Debug)]
struct Inner {
    options: StoreOptions,
    writer: Writer,
    reads: SqlitePool,
    blobs: Blobs,
    last_event: watch::Receiver<u64>,
    queued: watch::Receiver<u64>,
    /// Who a caller is and whose things are: never behind long reads.
    access_reads: SqlitePool,
    access: Arc<AccessState>,
    /// Held as long as the store is open, by a server's store.
    _lock: Option<File>,
}

impl Store {
    /// What the store was opened with.
    pub fn options(&self) -> &StoreOptions {
        &self.0.options
    }

    /// Wakes after every commit that put a job into the queue.
    pub fn queued(&self) -> watch::Receiver<u64> {
        self.0.queued.clone()
    }

    fn last_event_receiver(&self) -> watch::Receiver<u64> {
        self.0.last_event.clone()
    }

    fn reads(&self) -> &SqlitePool {
        &self.0.reads
    }

    fn blobs(&self) -> &Blobs {
        &self.0.blobs
    }

    fn access_reads(&self) -> &SqlitePool {
        &self.0.access_reads
    }

    fn access_state(&self) -> &Arc<AccessState> {
        &self.0.access
    }

    async fn write<T, F>(&self, command: F) -> Result<T>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
    {
        let actor = self.1.clone();
        self.0
            .writer
            .write(move |change| {
                change.actor = actor;
                command(change)
            })
            .await
    }
}

/// A duration in the database's unit.
fn millis(duration: Duration) -> i64 {
    i64::try_from(duration.as_millis()).unwrap_or(i64::MAX)
}
