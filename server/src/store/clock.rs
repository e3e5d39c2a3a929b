//! What the store takes for the time.
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use loadframe_api::Timestamp;

/// The clock of leases, limits and whatever else time does in the store.
#[derive(Clone, Debug, Default)]
pub enum Clock {
    /// The system's.
    #[default]
    System,
    /// One that goes as it is told [ms since 1970], for simulations.
    Told(Arc<AtomicI64>),
}

impl Clock {
    /// This moment.
    pub fn now(&self) -> Timestamp {
        match self {
            Self::System => Timestamp::now(),
            Self::Told(millis) => Timestamp(millis.load(Ordering::SeqCst)),
        }
    }
}
