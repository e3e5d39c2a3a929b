//! Wrong secrets and passwords, counted by who sent them or whom they were for.
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Wrong ones a key may have in a [`WINDOW`] before it has to wait.
const FREE: u32 = 10;
const WINDOW: Duration = Duration::from_secs(60);
/// Keys remembered; beyond it the old ones are forgotten.
const REMEMBERED: usize = 10_000;

/// How many wrong guesses since when, by key: an address, an account.
#[derive(Debug)]
pub struct Guesses<K>(Mutex<HashMap<K, (u32, Instant)>>);

impl<K> Default for Guesses<K> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Eq + Hash> Guesses<K> {
    /// Counts a wrong guess; `Err` holds how long the key should wait.
    ///
    /// # Errors
    /// When it has had its free ones.
    pub fn count(&self, key: K, now: Instant) -> Result<(), Duration> {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if seen.len() >= REMEMBERED {
            seen.retain(|_, (_, since)| now.duration_since(*since) < WINDOW);
        }
        if seen.len() >= REMEMBERED {
            seen.clear();
        }
        let (count, since) = seen.entry(key).or_insert((0, now));
        let age = now.duration_since(*since);
        if age >= WINDOW {
            (*count, *since) = (0, now);
        }
        *count += 1;
        if *count <= FREE {
            Ok(())
        } else {
            Err(WINDOW.saturating_sub(age))
        }
    }

    /// Takes back one that was counted before it turned out right.
    pub fn forgive(&self, key: &K) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((count, _)) = seen.get_mut(key) {
            *count = count.saturating_sub(1);
        }
    }

    /// Whether the key has to wait, without counting.
    ///
    /// # Errors
    /// How long it has to wait.
    pub fn check(&self, key: &K, now: Instant) -> Result<(), Duration> {
        let seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match seen.get(key) {
            Some((count, since)) if *count >= FREE && now.duration_since(*since) < WINDOW => {
                Err(WINDOW.saturating_sub(now.duration_since(*since)))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guesses_are_free_until_the_limit_and_again_after_the_window() {
        let guesses = Guesses::default();
        let start = Instant::now();
        for _ in 0..FREE {
            assert_eq!(guesses.check(&1, start), Ok(()));
            assert_eq!(guesses.count(1, start), Ok(()));
        }
        assert_eq!(guesses.check(&1, start), Err(WINDOW));
        assert_eq!(guesses.count(1, start), Err(WINDOW));
        guesses.forgive(&1);
        guesses.forgive(&1);
        assert_eq!(guesses.count(1, start), Ok(()));
        assert_eq!(guesses.check(&2, start), Ok(()));
        assert_eq!(guesses.count(2, start), Ok(()));
        assert_eq!(guesses.check(&1, start + WINDOW), Ok(()));
        assert_eq!(guesses.count(1, start + WINDOW), Ok(()));
    }
}
