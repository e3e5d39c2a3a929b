//! Tokens found good a moment ago, so that not every request asks the database.
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long a good token is taken for good without asking the database; a revoked one ends as late.
const LIFETIME: Duration = Duration::from_secs(2);
/// Tokens in use are few; more than this many are forgotten together.
const CAPACITY: usize = 1000;

/// When tokens were found good, by their hash.
#[derive(Debug, Default)]
pub(super) struct TokenCache(Mutex<HashMap<String, Instant>>);

impl TokenCache {
    pub(super) fn contains(&self, hash: &str) -> bool {
        let found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        found
            .get(hash)
            .is_some_and(|since| since.elapsed() < LIFETIME)
    }

    pub(super) fn insert(&self, hash: String) {
        let mut found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if found.len() >= CAPACITY {
            found.clear();
        }
        found.insert(hash, Instant::now());
    }

    pub(super) fn clear(&self) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clear();
    }
}
