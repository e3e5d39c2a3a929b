//! How much of bodies is in memory at once.
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use super::problem::{ApiError, Result};

/// Largest submission [bytes]: an explicit network of about half a million bonds.
pub(super) const LARGEST: usize = 32 << 20;
/// Bodies up to this many bytes are small; they do not wait behind large ones.
pub(super) const SMALL: usize = 64 << 10;
/// Small bodies read at once.
const SMALL_AT_ONCE: usize = 512;
/// A large body counts in these units [bytes]; all at once may have as many as the largest one.
const UNIT: usize = 1 << 10;
/// How long a body waits to be admitted.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// Room for bodies.
#[derive(Clone, Debug)]
pub(super) struct BodyBudget {
    small: Arc<Semaphore>,
    large: Arc<Semaphore>,
}

impl Default for BodyBudget {
    fn default() -> Self {
        Self {
            small: Arc::new(Semaphore::new(SMALL_AT_ONCE)),
            large: Arc::new(Semaphore::new(LARGEST / UNIT)),
        }
    }
}

impl BodyBudget {
    /// Waits for room for a body of `length` bytes.
    pub(super) async fn admit(&self, length: usize) -> Result<OwnedSemaphorePermit> {
        let (room, units) = if length <= SMALL {
            (&self.small, 1)
        } else {
            (&self.large, length.div_ceil(UNIT))
        };
        let units = u32::try_from(units).unwrap_or(u32::MAX);
        match timeout(LONGEST_WAIT, room.clone().acquire_many_owned(units)).await {
            Ok(Ok(permit)) => Ok(permit),
            _ => Err(ApiError::busy("too many large bodies are on their way", 5)),
        }
    }
}
