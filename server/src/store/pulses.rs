//! Heartbeats that are not written down yet.
//!
//! A worker shows every second that it lives. To write each of these down would cost the disk a commit and
//! would say no more than the last of them; so they gather here, and the sweeper writes all of them
//! ([`Store::write_pulses`](super::Store::write_pulses)) in one statement before it looks for leases that have run out. Of a server that is killed nothing is lost: the
//! next one gives every attempt a fresh lease.
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// When each attempt was last heard of [ms since 1970], by its row.
#[derive(Debug, Default)]
pub(super) struct Pulses(Mutex<BTreeMap<i64, i64>>);

impl Pulses {
    pub(super) fn note(&self, attempt: i64, at: i64) {
        self.lock().insert(attempt, at);
    }

    /// Whether the attempt was heard of since the last were written down.
    pub(super) fn has(&self, attempt: i64) -> bool {
        self.lock().contains_key(&attempt)
    }

    pub(super) fn all(&self) -> Vec<(i64, i64)> {
        let pulses = self.lock();
        pulses.iter().map(|(attempt, at)| (*attempt, *at)).collect()
    }

    /// Forgets those that are written down, but for whoever was heard of again since.
    pub(super) fn forget(&self, written: &[(i64, i64)]) {
        let mut pulses = self.lock();
        for (attempt, at) in written {
            if pulses.get(attempt) == Some(at) {
                pulses.remove(attempt);
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<i64, i64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_was_heard_of_while_others_were_written_is_kept() {
        let pulses = Pulses::default();
        pulses.note(1, 100);
        pulses.note(2, 100);
        pulses.note(1, 150);
        let written = pulses.all();
        assert_eq!(written, [(1, 150), (2, 100)]);
        pulses.note(2, 200);
        pulses.forget(&written);
        assert_eq!(pulses.all(), [(2, 200)]);
        assert!(pulses.has(2) && !pulses.has(1));
    }
}
