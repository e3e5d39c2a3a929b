//! Sends what a run gives to the server, in the order in which it appeared.
//!
//! The run puts items into a bounded queue and waits when it is full, unless the server is away
//! ([`super::backlog`]). Order is what makes checkpoints whole: a
//! checkpoint is sent after every file and point that came before it.
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use loadframe_api::FileEntry;
use loadframe_client::ServerError;
use loadframe_run::{Destination, Progress, SavedRun};
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval};

use super::backlog::{Backlog, Item};
use super::batch::Batch;
use super::contact::Contact;
use super::lease_client::LeaseClient;

/// Time between reports; people see a curve grow at four steps a second as moving.
const REPORT_EVERY: Duration = Duration::from_millis(250);
/// Items that may wait: several reports' worth of points.
const WAITING_ITEMS: usize = 4096;

/// The run's end of the queue.
#[derive(Debug)]
pub(super) struct UploadQueue {
    items: mpsc::Sender<Item>,
    backlog: Backlog,
    contact: Arc<Contact>,
    /// Where files wait, each under its number: a run may write the same name again before the
    /// first version has left.
    outgoing: PathBuf,
    files: u64,
    /// Bytes of each file so far, and their sum for others.
    sizes: BTreeMap<String, u64>,
    bytes: Arc<AtomicU64>,
    progress: watch::Sender<Progress>,
    checkpoint_is_under_way: Arc<AtomicBool>,
}

/// The server's end of the queue.
#[derive(Debug)]
pub(super) struct Uploader {
    items: mpsc::Receiver<Item>,
    progress: watch::Receiver<Progress>,
    checkpoint_is_under_way: Arc<AtomicBool>,
    batch: Batch,
    reported: Progress,
}

/// Both ends of a queue whose files wait in the folder `outgoing`; it adds up their `bytes`. So many first
/// points of the curve the server has already.
pub(super) fn queue(
    outgoing: PathBuf,
    bytes: Arc<AtomicU64>,
    contact: Arc<Contact>,
    known_points: u64,
) -> (UploadQueue, Uploader) {
    let (items, waiting) = mpsc::channel(WAITING_ITEMS);
    let (progress, seen) = watch::channel(Progress::default());
    let checkpoint_is_under_way = Arc::new(AtomicBool::new(false));
    let queue = UploadQueue {
        items,
        backlog: Backlog::default(),
        contact,
        outgoing,
        files: 0,
        sizes: BTreeMap::new(),
        bytes,
        progress,
        checkpoint_is_under_way: Arc::clone(&checkpoint_is_under_way),
    };
    let uploader = Uploader {
        items: waiting,
        progress: seen,
        checkpoint_is_under_way,
        batch: Batch::after(known_points),
        reported: Progress::default(),
    };
    (queue, uploader)
}

impl Uploader {
    /// Uploads until the run drops its end and everything has arrived.
    pub(super) async fn upload(mut self, lease: &LeaseClient) -> Result<(), ServerError> {
        let mut report = interval(REPORT_EVERY);
        report.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                item = self.items.recv() => match item {
                    Some(item) => self.send(item, lease).await?,
                    None => return self.report(lease).await,
                },
                _ = report.tick() => self.report(lease).await?,
            }
        }
    }

    async fn send(&mut self, item: Item, lease: &LeaseClient) -> Result<(), ServerError> {
        match item {
            Item::Columns(columns) => self.batch.columns(columns),
            Item::Points(numbers) => self.batch.points(&numbers),
            Item::Log(message) => self.batch.log(message),
            Item::File(entry, path) => {
                lease.upload(&entry, &path).await?;
                // its place on this disk is not needed any more; the attempt's folder goes anyway
                let _ = tokio::fs::remove_file(path).await;
            }
            Item::Checkpoint(saved) => {
                self.report(lease).await?;
                lease.save_checkpoint(&saved).await?;
                self.checkpoint_is_under_way.store(false, Ordering::Relaxed);
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

impl UploadQueue {
    fn put(&mut self, item: Item) -> io::Result<()> {
        self.backlog.send(item, &self.items, &self.contact)
    }

    /// Sends what is still waiting, however long that takes.
    pub(super) fn finish(&mut self) {
        // the uploader knows why nobody takes it
        let _ = self.backlog.finish(&self.items);
    }
}

impl Destination for UploadQueue {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        let names = names.iter().map(|name| (*name).to_owned());
        self.put(Item::Columns(names.collect()))
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        self.put(Item::Points(values.to_vec()))
    }

    fn file(&mut self, entry: &FileEntry, path: &Path) -> io::Result<()> {
        let waiting = self.outgoing.join(self.files.to_string());
        self.files += 1;
        let before = self.sizes.insert(entry.name.clone(), entry.bytes);
        self.bytes.fetch_add(entry.bytes, Ordering::Relaxed);
        self.bytes.fetch_sub(before.unwrap_or(0), Ordering::Relaxed);
        std::fs::rename(path, &waiting)?;
        self.put(Item::File(entry.clone(), waiting))
    }

    fn progress(&mut self, progress: Progress) {
        self.progress.send_replace(progress);
    }

    fn log(&mut self, message: &str) {
        // a lost channel ends the run at its next point or file
        let _ = self.put(Item::Log(message.to_owned()));
    }

    fn checkpoint(&mut self, saved: SavedRun) -> io::Result<()> {
        self.checkpoint_is_under_way.store(true, Ordering::Relaxed);
        self.put(Item::Checkpoint(Box::new(saved)))
    }

    fn takes_checkpoint(&self) -> bool {
        !self.checkpoint_is_under_way.load(Ordering::Relaxed)
    }
}
