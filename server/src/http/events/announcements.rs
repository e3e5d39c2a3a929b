//! New events, read from the store once and handed to everybody who listens.
use std::sync::Arc;
use std::time::Duration;

use loadframe_api::Event;
use tokio::sync::broadcast;
use uuid::Uuid;

use crate::store::{Store, StoreError, StoredEvent};

/// Events kept for slow listeners; who falls further behind reads them from the store.
const KEPT: usize = 1024;
/// Events read at once.
const BATCH: u32 = 500;
/// Wait after a failure of the store.
const AFTER_FAILURE: Duration = Duration::from_secs(1);

/// An event, written for the wire once.
#[derive(Debug)]
pub(super) struct Announced {
    pub(super) number: u64,
    pub(super) job: Uuid,
    /// Whose the job is or was.
    pub(super) owner: Option<Uuid>,
    pub(super) project: Option<Uuid>,
    pub(super) name: &'static str,
    pub(super) data: String,
}

impl Announced {
    pub(super) fn new(stored: &StoredEvent) -> serde_json::Result<Self> {
        let event = &stored.event;
        let data = match event {
            Event::Job(job) => serde_json::to_string(job),
            Event::Progress(progress) => serde_json::to_string(progress),
            Event::Points(points) => serde_json::to_string(points),
            Event::Deleted(deleted) => serde_json::to_string(deleted),
        };
        Ok(Self {
            number: stored.number,
            job: event.job_id(),
            owner: stored.owner,
            project: stored.project,
            name: event.name(),
            data: data?,
        })
    }
}

/// Where new events are announced; a clone is another handle on the same place.
#[derive(Clone, Debug)]
pub(in crate::http) struct Announcements(broadcast::Sender<Arc<Announced>>);

impl Default for Announcements {
    fn default() -> Self {
        Self(broadcast::Sender::new(KEPT))
    }
}

impl Announcements {
    /// From now on, every event.
    pub(super) fn listen(&self) -> broadcast::Receiver<Arc<Announced>> {
        self.0.subscribe()
    }

    /// Announces the store's new events until dropped.
    pub(in crate::http) async fn run(self, store: Store) {
        let mut changes = store.changes();
        let mut last = store.last_event().await;
        loop {
            match self.announce(&store, &mut last).await {
                Ok(()) => {
                    if changes.changed().await.is_err() {
                        return;
                    }
                }
                Err(error) => {
                    tracing::error!(%error, "new events could not be read");
                    tokio::time::sleep(AFTER_FAILURE).await;
                }
            }
        }
    }

    /// Announces everything after the event `last`.
    async fn announce(&self, store: &Store, last: &mut u64) -> Result<(), StoreError> {
        loop {
            // in this order: who begins to listen after the count has read a later `present`
            let present = store.last_event().await;
            if self.0.receiver_count() == 0 {
                *last = present;
                return Ok(());
            }
            let events = store.events_after(*last, None, BATCH).await?;
            if events.is_empty() {
                return Ok(());
            }
            for event in events {
                let number = event.number;
                *last = number;
                match Announced::new(&event) {
                    // nobody listening any more is not an error
                    Ok(event) => drop(self.0.send(Arc::new(event))),
                    Err(error) => tracing::error!(%error, number, "an event could not be written"),
                }
            }
        }
    }
}
