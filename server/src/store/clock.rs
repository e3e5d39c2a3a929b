//! What the store takes for the time.
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;

use loadframe_api::Timestamp;

/// The clock of leases, limits and whatever else time does in the store.
#[derive(Clone, Debug, Default)]
pub enum Clock {
    /// The system's.
    #[default]
    System,
    /// The system's, as far as it is from the one of a database that servers share [ms]: theirs may differ,
    /// and a lease that one of them gives must not look over to another.
    Shared(Arc<AtomicI64>),
    /// One that goes as it is told [ms since 1970], for simulations.
    Told(Arc<AtomicI64>),
}

impl Clock {
    /// This moment.
    pub fn now(&self) -> Timestamp {
        match self {
            Self::System => Timestamp::now(),
            Self::Shared(difference) => {
                let here = Timestamp::now().as_millis();
                Timestamp(here + difference.load(Ordering::Relaxed))
            }
            Self::Told(millis) => Timestamp(millis.load(Ordering::SeqCst)),
        }
    }

    /// Takes the moment that the database has just told.
    pub(super) fn follow(&self, moment: i64) {
        if let Self::Shared(difference) = self {
            let here = Timestamp::now().as_millis();
            difference.store(moment - here, Ordering::Relaxed);
        }
    }
}

/// A duration in the database's unit.
pub(super) fn millis(duration: Duration) -> i64 {
    i64::try_from(duration.as_millis()).unwrap_or(i64::MAX)
}
