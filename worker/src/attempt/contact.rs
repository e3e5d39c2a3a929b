//! When the server was last heard of.
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What all who speak with the server under one lease know of its being there.
#[derive(Debug)]
pub(super) struct Contact {
    /// When it last answered anything.
    last_answer: Mutex<Instant>,
    /// Whether the last request had no answer.
    is_away: AtomicBool,
    longest_silence: Duration,
}

impl Contact {
    /// With a server that is given up when it has been silent for so long. That is longer than a lease:
    /// a server that starts again gives its workers a fresh one, and what was computed is worth a wait.
    pub(super) fn lasting(longest_silence: Duration) -> Arc<Self> {
        Arc::new(Self {
            last_answer: Mutex::new(Instant::now()),
            is_away: AtomicBool::new(false),
            longest_silence,
        })
    }

    /// Notes whether a request had an answer.
    pub(super) fn note(&self, answered: bool) {
        if answered {
            *self.lock() = Instant::now();
        }
        self.is_away.store(!answered, Ordering::Relaxed);
    }

    /// Whether the last request had no answer.
    pub(super) fn is_away(&self) -> bool {
        self.is_away.load(Ordering::Relaxed)
    }

    /// Whether the server has been silent for longer than it is waited for.
    pub(super) fn is_given_up(&self) -> bool {
        self.lock().elapsed() > self.longest_silence
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Instant> {
        self.last_answer
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}
