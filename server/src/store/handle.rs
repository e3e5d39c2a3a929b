//! The store as it is held: what all its parts have in common, and the two ways to write.
use std::fs::File;
use std::sync::{Arc, Mutex};

use loadframe_api::{Calibration, Timestamp};
use tokio::sync::{OnceCell, watch};

use super::blobs::Blobs;
use super::calls::Calls;
use super::database::{Pool, Sharing};
use super::error::{Result, StoreError};
use super::people::{AccessState, Actor};
use super::pulses::Pulses;
use super::reserve::{self, Reserve};
use super::supervision::Restarts;
use super::types::StoreOptions;
use super::writer::{Answer, Change, Run, Size, Work, Writer, boxed, unboxed};

/// The store; a clone is another handle on the same one. What is changed through a handle is written
/// down as done by its actor, if it has one.
#[derive(Clone, Debug)]
pub struct Store(pub(super) Arc<Inner>, pub(super) Option<Arc<Actor>>);

#[derive(Debug)]
pub(super) struct Inner {
    pub(super) options: StoreOptions,
    pub(super) writer: Writer,
    pub(super) reserve: Arc<Reserve>,
    pub(super) restarts: Arc<Restarts>,
    pub(super) reads: Pool,
    /// For what a worker or a health check waits for, who a caller is, and one job: never behind a list.
    pub(super) lookups: Pool,
    pub(super) blobs: Blobs,
    /// Heartbeats that are not written down yet.
    pub(super) pulses: Arc<Pulses>,
    pub(super) last_event: watch::Receiver<u64>,
    pub(super) queued: watch::Receiver<u64>,
    pub(super) calls: Arc<Calls>,
    /// The speed of workers, and when it was read [ms since 1970].
    pub(super) speed: Mutex<Option<(i64, Option<Calibration>)>>,
    pub(super) access: Arc<AccessState>,
    /// The key that secrets of webhooks follow from, once it is known.
    pub(super) webhook_key: OnceCell<[u8; 32]>,
    pub(super) sharing: Sharing,
    /// Held as long as the store is open, by a server's store.
    pub(super) _lock: Option<File>,
}

impl Store {
    /// A handle whose changes are written down as those of `actor`.
    #[must_use]
    pub fn acting(&self, actor: Actor) -> Self {
        Self(Arc::clone(&self.0), Some(Arc::new(actor)))
    }

    /// What the store was opened with.
    pub fn options(&self) -> &StoreOptions {
        &self.0.options
    }

    /// This moment, by the store's clock.
    pub(crate) fn now(&self) -> Timestamp {
        self.0.options.clock.now()
    }

    /// Wakes after every commit that put a job into the queue.
    pub fn queued(&self) -> watch::Receiver<u64> {
        self.0.queued.clone()
    }

    pub(super) fn last_event_receiver(&self) -> watch::Receiver<u64> {
        self.0.last_event.clone()
    }

    pub(super) fn reads(&self) -> &Pool {
        &self.0.reads
    }

    pub(super) fn lookups(&self) -> &Pool {
        &self.0.lookups
    }

    pub(super) fn pulses(&self) -> &Arc<Pulses> {
        &self.0.pulses
    }

    pub(super) fn blobs(&self) -> &Blobs {
        &self.0.blobs
    }

    pub(super) fn access_state(&self) -> &Arc<AccessState> {
        &self.0.access
    }

    /// Writes what has to wait while the disk is full.
    ///
    /// # Errors
    /// [`StoreError::Full`], and those of the command and its commit.
    pub(super) async fn write<T, F>(&self, command: F) -> Result<T>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
    {
        reserve::admit(&self.0.reserve)?;
        unboxed(self.write_sized(Size::Usual, boxed(command)).await?)
    }

    /// Writes what frees or saves something (a cancel, a heartbeat, an end), whatever room there is.
    pub(super) async fn write_from_reserve<T, F>(&self, command: F) -> Result<T>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
    {
        unboxed(self.write_sized(Size::Usual, boxed(command)).await?)
    }

    /// [`Self::write`] of what may change all jobs there are.
    pub(super) async fn write_large<T, F>(&self, command: F) -> Result<T>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
    {
        reserve::admit(&self.0.reserve)?;
        unboxed(self.write_sized(Size::Large, boxed(command)).await?)
    }

    async fn write_sized(&self, size: Size, run: Run) -> Result<Answer> {
        let written = self.0.writer.write(size, self.1.clone(), run);
        written.await.map_err(
            |error| match (self.0.reserve.note(error), self.0.reserve.full()) {
                // the transaction it was in did not fit
                (StoreError::Unavailable, Some(_)) => StoreError::Full,
                (error, _) => error,
            },
        )
    }

    /// An error of the disk, looked at.
    pub(super) fn noted(&self, error: StoreError) -> StoreError {
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
