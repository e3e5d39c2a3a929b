//! Brings what a run gives to the server, in the order in which it appeared.
//!
//! The run puts parcels into a bounded channel and waits when it is full, so that a slow server
//! slows the run instead of filling the memory. Order is what makes checkpoints whole: a
//! checkpoint is sent after every file and point that came before it.
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use loadframe_api::FileEntry;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval};

use super::batch::Batch;
use super::lease_client::LeaseClient;
use crate::client::ServerError;
use crate::run::{Destination, Progress, SavedRun};

/// Time between reports; people see a curve grow at four steps a second as moving.
const REPORT_EVERY: Duration = Duration::from_millis(250);
/// Parcels that may wait: several reports' worth of points.
const WAITING_PARCELS: usize = 4096;

#[derive(Debug)]
enum Parcel {
    Columns(Vec<String>),
    Point(Vec<f64>),
    Log(String),
    File(FileEntry, PathBuf),
    Checkpoint(Box<SavedRun>),
}

/// The run's end of the channel.
#[derive(Debug)]
pub(super) struct Sender {
    parcels: mpsc::Sender<Parcel>,
    /// Where files wait, each under its number: a run may write the same name again before the
    /// first version has left.
    outgoing: PathBuf,
    files: u64,
    progress: watch::Sender<Progress>,
    checkpoint_is_on_its_way: Arc<AtomicBool>,
}

/// The server's end of the channel.
#[derive(Debug)]
pub(super) struct Courier {
    parcels: mpsc::Receiver<Parcel>,
    progress: watch::Receiver<Progress>,
    checkpoint_is_on_its_way: Arc<AtomicBool>,
    batch: Batch,
    reported: Progress,
}

/// Both ends of a channel whose files wait in the folder `outgoing`.
pub(super) fn channel(outgoing: PathBuf) -> (Sender, Courier) {
    let (parcels, waiting) = mpsc::channel(WAITING_PARCELS);
    let (progress, seen) = watch::channel(Progress::default());
    let checkpoint_is_on_its_way = Arc::new(AtomicBool::new(false));
    let sender = Sender {
        parcels,
        outgoing,
        files: 0,
        progress,
        checkpoint_is_on_its_way: Arc::clone(&checkpoint_is_on_its_way),
    };
    let courier = Courier {
        parcels: waiting,
        progress: seen,
        checkpoint_is_on_its_way,
        batch: Batch::default(),
        reported: Progress::default(),
    };
    (sender, courier)
}

impl Courier {
    /// Delivers until the run drops its end and everything has arrived.
    pub(super) async fn deliver(mut self, lease: &LeaseClient) -> Result<(), ServerError> {
        let mut report = interval(REPORT_EVERY);
        report.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                parcel = self.parcels.recv() => match parcel {
                    Some(parcel) => self.hand_over(parcel, lease).await?,
                    None => return self.report(lease).await,
                },
                _ = report.tick() => self.report(lease).await?,
            }
        }
    }

    async fn hand_over(&mut self, parcel: Parcel, lease: &LeaseClient) -> Result<(), ServerError> {
        match parcel {
            Parcel::Columns(columns) => self.batch.columns(columns),
            Parcel::Point(row) => self.batch.point(row),
            Parcel::Log(message) => self.batch.log(message),
            Parcel::File(entry, path) => {
                lease.upload(&entry, &path).await?;
                // its place on this disk is not needed any more; the attempt's folder goes anyway
                let _ = tokio::fs::remove_file(path).await;
            }
            Parcel::Checkpoint(saved) => {
                self.report(lease).await?;
                lease.save_checkpoint(&saved).await?;
                self.checkpoint_is_on_its_way
                    .store(false, Ordering::Relaxed);
            }
        }
        if self.batch.is_full() {
            self.report(lease).await?;
        }
        Ok(())
    }

    async fn report(&mut self, lease: &LeaseClient) -> Result<(), ServerError> {
        let progress = self.progress.borrow().clone();
        if self.batch.is_empty() && progress == self.reported {
            return Ok(());
        }
        lease.progress(&self.batch.take(&progress)).await?;
        self.reported = progress;
        Ok(())
    }
}

impl Sender {
    fn put(&self, parcel: Parcel) -> io::Result<()> {
        self.parcels
            .blocking_send(parcel)
            .map_err(|_| io::Error::other("the server takes no more results of this run"))
    }
}

impl Destination for Sender {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        let names = names.iter().map(|name| (*name).to_owned());
        self.put(Parcel::Columns(names.collect()))
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        self.put(Parcel::Point(values.to_vec()))
    }

    fn file(&mut self, entry: &FileEntry, path: &Path) -> io::Result<()> {
        let waiting = self.outgoing.join(self.files.to_string());
        self.files += 1;
        std::fs::rename(path, &waiting)?;
        self.put(Parcel::File(entry.clone(), waiting))
    }

    fn progress(&mut self, progress: Progress) {
        self.progress.send_replace(progress);
    }

    fn log(&mut self, message: &str) {
        // a lost channel ends the run at its next point or file
        let _ = self.put(Parcel::Log(message.to_owned()));
    }

    fn checkpoint(&mut self, saved: SavedRun) -> io::Result<()> {
        self.checkpoint_is_on_its_way.store(true, Ordering::Relaxed);
        self.put(Parcel::Checkpoint(Box::new(saved)))
    }

    fn takes_checkpoint(&self) -> bool {
        !self.checkpoint_is_on_its_way.load(Ordering::Relaxed)
    }
}
