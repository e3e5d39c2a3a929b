//! Removing files that no row names.
//!
//! What a change of this database has just let go of is removed at once. What lies there without a row
//! when the folder is looked through may be what a crash left, or what only another database knows: it
//! waits, is counted, and is removed when nobody has claimed it for days. Beside an older database that
//! was put back it waits until a person says so. While a backup is taken, nothing is removed: what is reported
//! waits for its end, but nobody who reports it does.
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use loadframe_api::Timestamp;
use serde::{Deserialize, Serialize};
use tokio::sync::{RwLock, mpsc, oneshot};

use super::clock::millis;
use super::database::{Pool, Sharing, query_scalar};
use super::encoding::{json, parsed};
use super::error::{Result, chain};
use super::removal::Removal;
use super::storage::Storage;
use super::supervision::{Restarts, caught};

/// Names looked up at a time.
const NAMES_AT_ONCE: usize = 500;
/// How often it is asked whether a backup has ended.
const ASK_EVERY: Duration = Duration::from_secs(1);

/// Work for the collector.
#[derive(Debug)]
pub(super) enum Garbage {
    /// These may be named by no row any more, since this moment.
    Perhaps(Vec<String>, Moment),
    /// Any of all the files may be.
    PerhapsAny,
    /// Tell when all before is done.
    Barrier(oneshot::Sender<()>),
}

/// What is counted up before a row that names files goes, so that it tells what went before what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Moment(u64);

/// Where garbage is reported.
#[derive(Clone, Debug)]
pub(super) struct Reports {
    sender: mpsc::UnboundedSender<Garbage>,
    moments: Arc<AtomicU64>,
}

impl Reports {
    /// Those for a collector, and what it receives.
    pub(super) fn channel() -> (Self, mpsc::UnboundedReceiver<Garbage>) {
        let (sender, receiver) = mpsc::unbounded_channel();
        let moments = Arc::default();
        (Self { sender, moments }, receiver)
    }

    /// A moment after all before.
    pub(super) fn next_moment(&self) -> Moment {
        Moment(self.moments.fetch_add(1, Ordering::SeqCst) + 1)
    }

    /// The last moment, for who looks.
    pub(super) fn moments(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.moments)
    }

    /// Whether there is a collector.
    pub(super) fn send(&self, garbage: Garbage) -> bool {
        self.sender.send(garbage).is_ok()
    }
}

/// What was last found, for people.
#[derive(Debug, Default)]
pub(super) struct Faults {
    pub(super) unnamed: AtomicU64,
    pub(super) lost: AtomicU64,
}

/// How a file without a row waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Waits {
    /// Since this moment [ms since 1970].
    Since(i64),
    /// Until a person removes it.
    ForAPerson,
}

/// The collector of one store.
#[derive(Debug)]
pub(super) struct Collector {
    pub(super) storage: Storage,
    pub(super) in_use: Arc<RwLock<()>>,
    pub(super) sharing: Sharing,
    pub(super) faults: Arc<Faults>,
    pub(super) reads: Pool,
    /// How long a file without a row waits.
    pub(super) wait: Duration,
    /// Whether what is found first waits for a person.
    pub(super) is_behind: bool,
    pub(super) restarts: Arc<Restarts>,
    pub(super) removal: Removal,
    pub(super) moments: Arc<AtomicU64>,
    pub(super) postponed: Postponed,
    /// What this collector found first of all that waits, and the moment at which it had no row.
    pub(super) found: BTreeMap<String, Moment>,
}

/// What was reported during a backup.
#[derive(Debug, Default)]
pub(super) struct Postponed {
    names: Vec<(String, Moment)>,
    any: bool,
}

impl Collector {
    /// Removes what no row names, as it is reported; ends with the last reporter.
    pub(super) async fn run(mut self, mut reports: mpsc::UnboundedReceiver<Garbage>) {
        loop {
            let waits = self.postponed.any || !self.postponed.names.is_empty();
            let report = tokio::select! {
                report = reports.recv() => match report {
                    Some(report) => report,
                    // what waits is found when the next server looks through the folder
                    None => return,
                },
                () = tokio::time::sleep(ASK_EVERY), if waits => Garbage::Perhaps(Vec::new(), Moment::default()),
            };
            let restarts = Arc::clone(&self.restarts);
            let work = async {
                match report {
                    Garbage::Perhaps(names, moment) => {
                        let names = names.into_iter().map(|name| (name, moment));
                        self.postponed.names.extend(names);
                        self.remove().await
                    }
                    Garbage::PerhapsAny => {
                        self.postponed.any = true;
                        self.remove().await
                    }
                    Garbage::Barrier(done) => {
                        // whoever waited may have gone
                        let _ = done.send(());
                        Ok(())
                    }
                }
            };
            // a panic leaves files without a row, which are found when the folder is looked through
            let removed = caught("collector", &restarts.collector, work).await;
            if let Ok(Err(error)) = removed {
                tracing::error!(%error, "files without a row stay for now");
            }
        }
    }

    /// Does all that was reported, unless a backup is being taken.
    async fn remove(&mut self) -> Result<()> {
        let Some(turn) = self.removal.begin()? else {
            return Ok(());
        };
        let Postponed { names, any } = std::mem::take(&mut self.postponed);
        self.remove_unnamed(names).await?;
        if any {
            self.found = self.look_through().await?;
            self.is_behind = false;
        }
        drop(turn);
        Ok(())
    }

    /// Removes those of the files that no row names, other than those that wait. What was found without a row
    /// because its row had just gone does not wait; what was found, got a row and lost it again does.
    async fn remove_unnamed(&self, names: Vec<(String, Moment)>) -> Result<()> {
        let waiting = waiting(&self.storage).await?;
        let is_ours = |name: &String, gone: Moment| match waiting.get(name) {
            None => true,
            Some(Waits::Since(_)) => self.found.get(name).is_some_and(|found| gone <= *found),
            Some(Waits::ForAPerson) => false,
        };
        let names = names.into_iter();
        let names: Vec<_> = names
            .filter(|(name, gone)| is_ours(name, *gone))
            .map(|(name, _)| name)
            .collect();
        for names in names.chunks(NAMES_AT_ONCE) {
            // nobody stores a file meanwhile, here or on another server
            let alone = self.in_use.write().await;
            let alone_of_all = self.sharing.removing_files().await?;
            let unnamed = unnamed(&self.reads, names).await?;
            let removed = self.storage.remove(unnamed).await;
            drop((alone, alone_of_all));
            stays(&removed);
        }
        Ok(())
    }

    /// Finds all files without a row, and removes those that have waited long enough; from then on, none that
    /// is found waits for a person by that alone. Returns what waits since this collector found it.
    async fn look_through(&self) -> Result<BTreeMap<String, Moment>> {
        let names = self.storage.names().await?;
        let known = waiting(&self.storage).await?;
        let now = Timestamp::now().as_millis();
        let (mut still, mut found, mut removed) = (BTreeMap::new(), BTreeMap::new(), 0);
        for names in names.chunks(NAMES_AT_ONCE) {
            let alone = self.in_use.write().await;
            let alone_of_all = self.sharing.removing_files().await?;
            let mut over = Vec::new();
            let unnamed = unnamed(&self.reads, names).await?;
            // nobody stores a file yet: what gets a row from now on loses it at a later moment
            let moment = Moment(self.moments.load(Ordering::SeqCst));
            for name in unnamed {
                // it may be looked for twice before it is told that its row has gone
                let before = self.found.get(&name).copied();
                if let Some(moment) = before.or((!known.contains_key(&name)).then_some(moment)) {
                    found.insert(name.clone(), moment);
                }
                let first = if self.is_behind {
                    Waits::ForAPerson
                } else {
                    Waits::Since(now)
                };
                match known.get(&name).copied().unwrap_or(first) {
                    Waits::Since(since) if now - since >= millis(self.wait) => {
                        over.push((name, since));
                    }
                    waits => {
                        still.insert(name, waits);
                    }
                }
            }
            let done = self
                .storage
                .remove(over.iter().map(|(name, _)| name.clone()).collect());
            let done = done.await;
            drop((alone, alone_of_all));
            stays(&done);
            match done {
                Ok(()) => removed += over.len(),
                // their time is over next time, too
                Err(_) => {
                    still.extend(
                        over.into_iter()
                            .map(|(name, since)| (name, Waits::Since(since))),
                    );
                }
            }
        }
        if still != known {
            keep_waiting(&self.storage, &still).await?;
        }
        self.faults
            .unnamed
            .store(still.len() as u64, Ordering::Relaxed);
        if removed > 0 || !still.is_empty() {
            let waits_s = self.wait.as_secs();
            tracing::warn!(
                removed,
                waiting = still.len(),
                waits_s,
                "files that no job names"
            );
        }
        Ok(found)
    }
}

/// Tells of files that could not be removed; the others are.
fn stays(removed: &Result<()>) {
    if let Err(error) = removed {
        tracing::error!(error = %chain(error), "a file without a row stays for now");
    }
}

/// Of these names those that no row has.
async fn unnamed(reads: &Pool, names: &[String]) -> Result<Vec<String>> {
    let unnamed = query_scalar(
        "SELECT value FROM json_each(?)
         WHERE NOT EXISTS (SELECT 1 FROM attempt_files WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM checkpoint_files WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM checkpoints WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM trashed_attempt_files WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM trashed_checkpoint_files WHERE sha256 = value)
           AND NOT EXISTS (SELECT 1 FROM trashed_checkpoints WHERE sha256 = value)",
    );
    Ok(unnamed.bind(json(&names)?).fetch_all(reads).await?)
}

/// The list of files that wait lies beside them: it outlives the database.
const LIST: &str = "unnamed.json";

async fn waiting(storage: &Storage) -> Result<BTreeMap<String, Waits>> {
    match storage.note(LIST).await? {
        Some(text) => parsed(&text, "list of files without a row"),
        None => Ok(BTreeMap::new()),
    }
}

async fn keep_waiting(storage: &Storage, waiting: &BTreeMap<String, Waits>) -> Result<()> {
    storage.leave_note(LIST, &json(waiting)?).await
}

/// How many stored files no row names.
pub(super) async fn count_unnamed(storage: &Storage, reads: &Pool) -> Result<u64> {
    let mut count = 0;
    for names in storage.names().await?.chunks(NAMES_AT_ONCE) {
        count += unnamed(reads, names).await?.len() as u64;
    }
    Ok(count)
}

/// Ends the wait of all files that no row names.
pub(super) async fn release(storage: &Storage, reads: &Pool) -> Result<()> {
    let mut over = BTreeMap::new();
    for names in storage.names().await?.chunks(NAMES_AT_ONCE) {
        let unnamed = unnamed(reads, names).await?.into_iter();
        over.extend(unnamed.map(|name| (name, Waits::Since(0))));
    }
    keep_waiting(storage, &over).await
}
