//! One connection's way through the events.
use std::collections::VecDeque;
use std::sync::Arc;

use loadframe_api::Event;
use tokio::sync::broadcast;
use tokio::sync::broadcast::error::RecvError;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::super::AppState;
use super::super::problem::{ApiError, Result};
use super::announcements::Announced;
use crate::store::{Store, StoreError};

/// Events read from the store at once.
const BATCH: u32 = 200;

/// Where a connection stands.
#[derive(Debug)]
pub(super) struct Follower {
    store: Store,
    /// Left out, all jobs.
    jobs: Option<Vec<Uuid>>,
    /// Number of the last event seen.
    seen: u64,
    /// To be sent before anything else.
    waiting: VecDeque<Arc<Announced>>,
    /// There may be events in the store that were not seen.
    is_behind: bool,
    announced: broadcast::Receiver<Arc<Announced>>,
    stopping: CancellationToken,
}

impl Follower {
    /// Starts after event `last`, or else with the present state of the named jobs.
    pub(super) async fn start(
        state: &AppState,
        jobs: Option<Vec<Uuid>>,
        last: Option<u64>,
    ) -> Result<Self> {
        // listen before looking, so that nothing falls in between
        let announced = state.announcements.listen();
        let present = state.store.last_event().await;
        // a number from before the store was replaced says nothing
        let last = last.filter(|last| *last <= present);
        let mut waiting = VecDeque::new();
        if last.is_none() {
            for id in jobs.iter().flatten() {
                match state.store.job(*id).await {
                    Ok(job) => {
                        let event = Event::Job(Box::new(job));
                        let event = Announced::new(present, &event);
                        let event = event.map_err(|error| ApiError::internal(&error))?;
                        waiting.push_back(Arc::new(event));
                    }
                    Err(StoreError::NotFound(_)) => {}
                    Err(error) => return Err(error.into()),
                }
            }
        }
        Ok(Self {
            store: state.store.clone(),
            jobs,
            seen: last.unwrap_or(present),
            waiting,
            is_behind: true,
            announced,
            stopping: state.stopping.clone(),
        })
    }

    /// The next event; `None` ends the stream.
    pub(super) async fn next(&mut self) -> Option<Arc<Announced>> {
        loop {
            if let Some(event) = self.waiting.pop_front() {
                return Some(event);
            }
            if self.is_behind {
                self.catch_up().await?;
                continue;
            }
            tokio::select! {
                () = self.stopping.cancelled() => return None,
                event = self.announced.recv() => match event {
                    Ok(event) if event.number > self.seen && self.wants(&event) => {
                        self.seen = event.number;
                        return Some(event);
                    }
                    Ok(_) => {}
                    Err(RecvError::Lagged(_)) => self.is_behind = true,
                    Err(RecvError::Closed) => return None,
                },
            }
        }
    }

    /// Reads what was missed. On a failure the stream ends, and the client comes back.
    async fn catch_up(&mut self) -> Option<()> {
        let events = self
            .store
            .events_after(self.seen, self.jobs.as_deref(), BATCH);
        let events = match events.await {
            Ok(events) => events,
            Err(error) => {
                tracing::error!(%error, "missed events could not be read");
                return None;
            }
        };
        self.is_behind = !events.is_empty();
        for (number, event) in events {
            self.seen = number;
            match Announced::new(number, &event) {
                Ok(event) => self.waiting.push_back(Arc::new(event)),
                Err(error) => tracing::error!(%error, number, "an event could not be written"),
            }
        }
        Some(())
    }

    fn wants(&self, event: &Announced) -> bool {
        self.jobs
            .as_ref()
            .is_none_or(|jobs| jobs.contains(&event.job))
    }
}
