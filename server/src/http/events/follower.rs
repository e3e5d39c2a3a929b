//! One connection's way through the events.
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use loadframe_api::people::Named;
use loadframe_api::{Event, Timestamp};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, watch};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::super::AppState;
use super::super::permit::Call;
use super::super::problem::{ApiError, Result};
use super::announcements::Announced;
use crate::access::Sight;
use crate::store::{Store, StoreError, StoredEvent};

/// Events read from the store at once.
const BATCH: u32 = 200;

/// Waits for this moment, or for ever.
async fn until(moment: Option<Timestamp>) {
    let Some(moment) = moment else {
        return std::future::pending().await;
    };
    let wait = moment.as_millis() - Timestamp::now().as_millis();
    tokio::time::sleep(Duration::from_millis(wait.max(0).unsigned_abs())).await;
}

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
    /// Who follows, and what of all jobs it sees.
    call: Arc<Call>,
    sight: Sight,
    access: watch::Receiver<u64>,
    stopping: CancellationToken,
}

impl Follower {
    /// Starts after event `last`, or else with the present state of the named jobs.
    pub(super) async fn start(
        state: &AppState,
        call: &Arc<Call>,
        jobs: Option<Vec<Uuid>>,
        last: Option<u64>,
    ) -> Result<Self> {
        // listen before looking, so that nothing falls in between
        let announced = state.announcements.listen();
        let access = state.store.access_changes();
        let sight = call.sight(&state.store).await?;
        let present = state.store.last_event().await;
        // a number from before the store was replaced says nothing
        let last = last.filter(|last| *last <= present);
        let mut waiting = VecDeque::new();
        if last.is_none() {
            for id in jobs.iter().flatten() {
                match state.store.job(*id).await {
                    Ok(job) => {
                        let id = |of: &Option<Named>| of.as_ref().map(|of| of.id);
                        let (owner, project) = (id(&job.owner), id(&job.project));
                        if !sight.shows(job.id, owner, project) {
                            continue;
                        }
                        let event = Announced::new(&StoredEvent {
                            number: present,
                            event: Event::Job(Box::new(job)),
                            owner,
                            project,
                        });
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
            call: call.clone(),
            sight,
            access,
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
            let end = until(self.call.caller.expires_at);
            tokio::select! {
                () = self.stopping.cancelled() => return None,
                () = end => return None,
                _ = self.access.changed() => self.look_again().await?,
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
        for event in events {
            let number = event.number;
            self.seen = number;
            if !self
                .sight
                .shows(event.event.job_id(), event.owner, event.project)
            {
                continue;
            }
            match Announced::new(&event) {
                Ok(event) => self.waiting.push_back(Arc::new(event)),
                Err(error) => tracing::error!(%error, number, "an event could not be written"),
            }
        }
        Some(())
    }

    fn wants(&self, event: &Announced) -> bool {
        let is_named = |jobs: &Vec<Uuid>| jobs.contains(&event.job);
        self.jobs.as_ref().is_none_or(is_named)
            && self.sight.shows(event.job, event.owner, event.project)
    }

    /// Looks at who follows as it is now: a stream ends with its token, and shows what its follower sees.
    async fn look_again(&mut self) -> Option<()> {
        let caller = self.store.caller_again(&self.call.caller).await;
        let caller = match caller {
            Ok(caller) => caller?,
            Err(error) => {
                tracing::error!(%error, "who follows could not be read");
                return None;
            }
        };
        let call = Call {
            caller,
            trace: self.call.trace,
            versions: None,
        };
        self.sight = call.sight(&self.store).await.ok()?;
        self.call = Arc::new(call);
        Some(())
    }
}
