//! How much of bodies is in memory at once.
//!
//! A body has room for what has come of it, not for what it says will come: one that stalls keeps
//! nobody out. When the room for large ones is all in use, one body at a time may go on beyond it,
//! so that some body always comes to its end.
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use super::problem::{ApiError, Result};

/// Largest submission [bytes]: an explicit network of about half a million bonds.
pub(super) const LARGEST: usize = 32 << 20;
/// Bodies up to this many bytes are small; they do not wait behind large ones.
pub(super) const SMALL: usize = 64 << 10;
/// Room for the beginnings of bodies, up to [`SMALL`] of each [bytes].
const BEGINNINGS: usize = 512 * SMALL;
/// Room for what is beyond them [bytes].
const REST: usize = LARGEST / 2;
/// Room counts in these units [bytes].
const UNIT: usize = 1 << 10;
/// How long a body waits for room.
const LONGEST_WAIT: Duration = Duration::from_secs(10);
/// How long the body that goes on beyond the room may take: the largest at 0.5 MB/s.
pub(super) const LONGEST_BEYOND: Duration = Duration::from_secs(60);

/// Room for bodies.
#[derive(Clone, Debug)]
pub(super) struct BodyBudget {
    beginnings: Arc<Semaphore>,
    rest: Arc<Semaphore>,
    beyond: Arc<Semaphore>,
}

/// Room of one body, until dropped.
#[derive(Debug)]
pub(super) struct Room {
    budget: BodyBudget,
    units: usize,
    beginning: Option<OwnedSemaphorePermit>,
    rest: Option<OwnedSemaphorePermit>,
    beyond: Option<OwnedSemaphorePermit>,
}

impl Default for BodyBudget {
    fn default() -> Self {
        Self {
            beginnings: Arc::new(Semaphore::new(BEGINNINGS / UNIT)),
            rest: Arc::new(Semaphore::new(REST / UNIT)),
            beyond: Arc::new(Semaphore::new(1)),
        }
    }
}

impl BodyBudget {
    /// Room for a body of which nothing has come yet.
    pub(super) fn begin(&self) -> Room {
        Room {
            budget: self.clone(),
            units: 0,
            beginning: None,
            rest: None,
            beyond: None,
        }
    }
}

impl Room {
    /// Waits until there is room for `length` bytes of the body in all.
    ///
    /// # Errors
    /// 503 when there is none in time.
    pub(super) async fn grow(&mut self, length: usize) -> Result<()> {
        let units = length.div_ceil(UNIT);
        if units <= self.units || self.beyond.is_some() {
            return Ok(());
        }
        let small = SMALL / UNIT;
        let beginning = units.min(small) - self.units.min(small);
        let rest = (units - self.units) - beginning;
        let grown = timeout(LONGEST_WAIT, async {
            if beginning > 0 {
                let permit = acquire(&self.budget.beginnings, beginning).await;
                add(&mut self.beginning, permit);
            }
            if rest > 0 {
                match try_acquire(&self.budget.rest, rest) {
                    Some(permit) => add(&mut self.rest, Some(permit)),
                    None => tokio::select! {
                        biased;
                        beyond = acquire(&self.budget.beyond, 1) => self.beyond = beyond,
                        permit = acquire(&self.budget.rest, rest) => add(&mut self.rest, permit),
                    },
                }
            }
        });
        if grown.await.is_err() {
            return Err(ApiError::busy("too many large bodies are on their way", 5));
        }
        self.units = units;
        Ok(())
    }

    /// Whether the body goes on beyond the room, for which others wait.
    pub(super) fn is_beyond(&self) -> bool {
        self.beyond.is_some()
    }
}

async fn acquire(room: &Arc<Semaphore>, units: usize) -> Option<OwnedSemaphorePermit> {
    let units = u32::try_from(units).unwrap_or(u32::MAX);
    room.clone().acquire_many_owned(units).await.ok()
}

fn try_acquire(room: &Arc<Semaphore>, units: usize) -> Option<OwnedSemaphorePermit> {
    let units = u32::try_from(units).unwrap_or(u32::MAX);
    room.clone().try_acquire_many_owned(units).ok()
}

fn add(held: &mut Option<OwnedSemaphorePermit>, permit: Option<OwnedSemaphorePermit>) {
    match (held, permit) {
        (Some(held), Some(permit)) => held.merge(permit),
        (held @ None, permit) => *held = permit,
        (Some(_), None) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn bodies_that_stall_keep_out_neither_small_nor_large_ones() {
        let budget = BodyBudget::default();
        let mut stalled = Vec::new();
        for _ in 0..100 {
            let mut room = budget.begin();
            // a hundred say nothing of their length and stop after 1 kB
            room.grow(1000).await.expect("room");
            stalled.push(room);
        }
        let mut large = budget.begin();
        large.grow(LARGEST).await.expect("room");
        let mut small = budget.begin();
        small.grow(SMALL).await.expect("room");
    }

    #[tokio::test]
    async fn one_body_goes_on_when_the_room_is_in_use() {
        let budget = BodyBudget::default();
        let mut rooms: Vec<Room> = (0..3).map(|_| budget.begin()).collect();
        for room in &mut rooms {
            // 5 MB of each are 15 of 16 MB
            room.grow(5 << 20).await.expect("room");
        }
        let [one, two, _] = &mut rooms[..] else {
            panic!("three")
        };
        one.grow(LARGEST).await.expect("beyond the room");
        assert!(one.is_beyond());
        let moment = Duration::from_millis(50);
        let waited = timeout(moment, two.grow(LARGEST)).await;
        assert!(waited.is_err(), "the room is in use");
        drop(rooms.remove(0));
        rooms[0].grow(LARGEST).await.expect("beyond the room");
        drop(rooms.remove(0));
        rooms[0].grow(LARGEST).await.expect("room");
        drop(rooms);
        assert_eq!(budget.rest.available_permits(), REST / UNIT);
        assert_eq!(budget.beginnings.available_permits(), BEGINNINGS / UNIT);
        assert_eq!(budget.beyond.available_permits(), 1);
    }
}
