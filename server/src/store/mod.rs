//! The store: jobs, attempts, curves, files, events, workers and tokens. Every SQL statement of
//! the system is in this folder; nothing outside it knows that there is a database.
//!
//! In `data` lie `loadframe.db` (SQLite: write-ahead log, durable at every commit), `blobs/` (files
//! under their SHA-256, with the name of the store), `incoming/` (files on their way), `set-aside/` (files
//! that were not what their names say), `reserve` (given up when the disk is full) and `lock` (one server
//! a folder, or several that share a database elsewhere). Where `files.json` says so ([`where_files`]),
//! `blobs/` and `set-aside/` are in a [`bucket`] instead; only [`storage`] knows. Whether the database is
//! SQLite's or on a PostgreSQL server, only [`database`] knows, through which every statement goes.
//!
//! A change goes `Store::…` → [`writer`] (one connection, group commit) → the command's method on
//! [`writer::Change`] → for steps of a job's lifecycle [`state`], which asks [`crate::queue`] → events →
//! commit → answer. Reads go to pools of connections that cannot write, beside it: one for lists and
//! results, one for what takes a moment and must not wait behind them.
//!
//! What was deleted lies in the [`trash`] for a while. Lists are [`list`], by values
//! of specs and results [`search`], which are [`kept`] and sorted by a [`key`]; jobs one by one [`jobs`], many side by side [`compared`]. The worker's side in the
//! order of a job: [`claim`], of what [`choice`] decides, [`lease`] (heartbeats in [`pulses`]) with [`curve`] and
//! [`log`], [`files`] and [`checkpoints`] over [`blobs`] and [`arriving`] on the [`disk`] (or sent [`directly`] to the bucket),
//! [`ending`]; if the worker falls silent by the [`clock`], [`sweep`]; if its machine is at fault, [`machines`]. Whose
//! things are, and what was done by whom: [`people`].
//!
//! That nothing is lost unseen: [`identity`] tells whether database and files belong together, the
//! [`collector`] removes what no row names, [`scrub`] finds what is missing or has changed, and [`backup`]
//! copies both in the right order; [`moving`] brings a lab from one database to another. That a full disk or a panic ends nothing: [`reserve`], [`supervision`].
mod arriving;
mod backlog;
mod backup;
mod blobs;
mod bucket;
mod calls;
mod checkpoints;
mod choice;
mod claim;
mod clock;
mod collector;
mod compared;
mod curve;
mod database;
mod directly;
mod disk;
mod encoding;
mod ending;
mod error;
mod events;
mod files;
mod folder;
mod identity;
mod jobs;
mod kept;
mod key;
mod lease;
mod list;
mod log;
mod machines;
mod moving;
mod open;
pub mod people;
mod place;
pub mod pointer;
mod private;
mod pulses;
mod reserve;
mod scrub;
mod search;
mod state;
mod storage;
mod submit;
mod supervision;
mod sweep;
mod texts;
pub mod trash;
mod types;
mod waiting;
mod where_files;
mod workers;
mod writer;

use std::fs::File;
use std::sync::{Arc, Mutex};

use loadframe_api::{Calibration, Timestamp};
use tokio::sync::{OnceCell, watch};

pub use backup::{BackupReport, backup, backup_from, restore, restore_to};
use blobs::Blobs;
pub use bucket::{BucketKeys, BucketSettings};
use calls::Calls;
pub use calls::Waiting;
pub use clock::Clock;
pub use compared::{Compared, CurvePart};
pub use database::{DatabaseAddress, DatabasePlace};
use database::{Pool, Sharing};
use error::Result;
pub(crate) use error::chain;
pub use error::{Loss, StoreError};
pub use events::StoredEvent;
pub use moving::{MoveReport, move_store};
use people::{AccessState, Actor};
use pulses::Pulses;
use reserve::Reserve;
pub use scrub::{LostFile, ScrubReport};
pub use search::Wanted;
pub use storage::Content;
use supervision::Restarts;
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
    reserve: Arc<Reserve>,
    restarts: Arc<Restarts>,
    reads: Pool,
    /// For what a worker or a health check waits for, who a caller is, and one job: never behind a list.
    lookups: Pool,
    blobs: Blobs,
    /// Heartbeats that are not written down yet.
    pulses: Arc<Pulses>,
    last_event: watch::Receiver<u64>,
    queued: watch::Receiver<u64>,
    calls: Arc<Calls>,
    /// The speed of workers, and when it was read [ms since 1970].
    speed: Mutex<Option<(i64, Option<Calibration>)>>,
    access: Arc<AccessState>,
    /// The key that secrets of webhooks follow from, once it is known.
    webhook_key: OnceCell<[u8; 32]>,
    sharing: Sharing,
    /// Held as long as the store is open, by a server's store.
    _lock: Option<File>,
}

impl Store {
    /// What the store was opened with.
    pub fn options(&self) -> &StoreOptions {
        &self.0.options
    }

    /// This moment, by the store's clock.
    pub(super) fn now(&self) -> Timestamp {
        self.0.options.clock.now()
    }

    /// Wakes after every commit that put a job into the queue.
    pub fn queued(&self) -> watch::Receiver<u64> {
        self.0.queued.clone()
    }

    fn last_event_receiver(&self) -> watch::Receiver<u64> {
        self.0.last_event.clone()
    }

    fn reads(&self) -> &Pool {
        &self.0.reads
    }

    fn lookups(&self) -> &Pool {
        &self.0.lookups
    }

    fn pulses(&self) -> &Arc<Pulses> {
        &self.0.pulses
    }

    fn blobs(&self) -> &Blobs {
        &self.0.blobs
    }

    fn access_state(&self) -> &Arc<AccessState> {
        &self.0.access
    }

    /// Writes what has to wait while the disk is full.
    ///
    /// # Errors
    /// [`StoreError::Full`], and those of the command and its commit.
    async fn write<T, F>(&self, command: F) -> Result<T>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
    {
        reserve::admit(&self.0.reserve)?;
        self.write_from_reserve(command).await
    }

    /// Writes what frees or saves something (a cancel, a heartbeat, an end), whatever room there is.
    async fn write_from_reserve<T, F>(&self, command: F) -> Result<T>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
    {
        let actor = self.1.clone();
        let written = self.0.writer.write(move |change| {
            change.actor = actor;
            command(change)
        });
        written.await.map_err(
            |error| match (self.0.reserve.note(error), self.0.reserve.full()) {
                // the transaction it was in did not fit
                (StoreError::Unavailable, Some(_)) => StoreError::Full,
                (error, _) => error,
            },
        )
    }

    /// An error of the disk, looked at.
    fn noted(&self, error: StoreError) -> StoreError {
        self.0.reserve.note(error)
    }

    /// Why the disk is taken for full, if it is.
    pub fn full(&self) -> Option<String> {
        self.0.reserve.full()
    }

    /// Does some work that never ends on one server of the database at a time.
    pub async fn as_duty(&self, name: &'static str, work: impl Future<Output = ()>) {
        self.0.sharing.as_duty(name, work).await;
    }

    /// Looks whether a disk that was full has room again, until dropped.
    pub async fn keep_looking_for_room(self) {
        self.0.reserve.keep_looking().await;
    }
}
