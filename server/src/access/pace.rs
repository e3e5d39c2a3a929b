//! How many requests a second may come from one token, or from one address that has none.
//!
//! Each has a bucket that fills at the rate and holds [`BURST`] of it; a request takes one from it. Of a bucket
//! the moment is kept at which it is full again, and of a full one nothing. (A crate for this would bring a
//! dozen others, for these lines.)
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What a full bucket holds: as many as come in this time. So a page that is opened, or a script that begins,
/// asks all it wants at once.
const BURST: Duration = Duration::from_secs(2);
/// Buckets remembered; beyond it those that are full by now are forgotten, and if need be all.
const REMEMBERED: usize = 10_000;

/// The buckets, by key.
#[derive(Debug)]
pub struct Pace<K> {
    per_s: u32,
    full_at: Mutex<HashMap<K, Instant>>,
}

impl<K: Eq + Hash> Pace<K> {
    /// Of so many requests a second, of one at least.
    pub fn new(per_s: u32) -> Self {
        Self {
            per_s: per_s.max(1),
            full_at: Mutex::default(),
        }
    }

    /// Requests a second.
    pub fn per_s(&self) -> u32 {
        self.per_s
    }

    /// Takes a request from the bucket of `key`.
    ///
    /// # Errors
    /// When it is empty; how long until it is not.
    pub fn take(&self, key: K, now: Instant) -> Result<(), Duration> {
        let mut full_at = self.full_at.lock().unwrap_or_else(PoisonError::into_inner);
        if full_at.len() >= REMEMBERED {
            full_at.retain(|_, moment| *moment > now);
        }
        if full_at.len() >= REMEMBERED {
            full_at.clear();
        }
        let moment = full_at.entry(key).or_insert(now);
        let next = (*moment).max(now) + Duration::from_secs(1) / self.per_s;
        let missing = next.duration_since(now);
        if missing > BURST {
            return Err(missing - BURST);
        }
        *moment = next;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_gives_its_burst_and_then_the_rate() {
        let pace = Pace::new(10);
        let start = Instant::now();
        let given = |key, now| (0..100).take_while(|_| pace.take(key, now).is_ok()).count();
        assert_eq!(given("one", start), 20);
        let wait = pace.take("one", start).expect_err("it is empty");
        assert_eq!(wait, Duration::from_millis(100));
        // who is refused is not set back by it
        assert_eq!(given("one", start + wait), 1);
        assert_eq!(given("other", start), 20);
        assert_eq!(given("one", start + wait + Duration::from_secs(1)), 10);
        assert_eq!(given("one", start + Duration::from_secs(60)), 20);
    }

    #[test]
    fn of_many_keys_those_that_have_something_to_wait_for_are_remembered() {
        let pace = Pace::new(1);
        let start = Instant::now() + Duration::from_secs(60);
        for _ in 0..2 {
            assert_eq!(pace.take(0, start), Ok(()));
        }
        assert!(pace.take(0, start).is_err());
        let later = start + Duration::from_millis(1_500);
        for key in 1..REMEMBERED {
            let _ = pace.take(key, start - Duration::from_secs(60));
        }
        assert_eq!(pace.take(REMEMBERED, later), Ok(()));
        assert_eq!(pace.full_at.lock().expect("nobody panics").len(), 2);
    }
}
