//! What a connection is at, as seen by itself and by who needs its place.
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::task::Waker;
use std::time::Instant;

use futures_util::task::AtomicWaker;
use tokio_util::sync::CancellationToken;

/// What a connection is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Phase {
    /// Its client sends the head of a request.
    Head,
    /// Its client sends a body.
    Body,
    /// The server answers.
    Answer,
    /// Its client may ask something more.
    Idle,
}

/// What a connection is at. Its own task writes it; others read, and may ask it to end.
#[derive(Debug)]
pub(super) struct Standing {
    /// Moments are microseconds since then, and one more: zero is "not".
    start: Instant,
    phase: AtomicU8,
    /// Since when the client's next bytes are waited for.
    reading: AtomicU64,
    /// Since when the client is waited for to take bytes.
    writing: AtomicU64,
    /// Of who reads while an answer is given: a wait for the client begins when that ends.
    reader: AtomicWaker,
    /// Cancelled when another needs the place.
    pub(super) displaced: CancellationToken,
}

impl Standing {
    /// A connection just begun; `start` is the same moment for all that are compared.
    pub(super) fn new(start: Instant) -> Self {
        let standing = Self {
            start,
            phase: AtomicU8::new(Phase::Head as u8),
            reading: AtomicU64::new(0),
            writing: AtomicU64::new(0),
            reader: AtomicWaker::new(),
            displaced: CancellationToken::new(),
        };
        standing.wait_to_read();
        standing
    }

    pub(super) fn phase(&self) -> Phase {
        match self.phase.load(Ordering::Relaxed) {
            0 => Phase::Head,
            1 => Phase::Body,
            2 => Phase::Answer,
            _ => Phase::Idle,
        }
    }

    /// The next phase. In heads and between requests the client is waited for from the first moment;
    /// over a body only while a read finds nothing.
    pub(super) fn enter(&self, phase: Phase) {
        self.phase.store(phase as u8, Ordering::Relaxed);
        self.reading.store(0, Ordering::Relaxed);
        if matches!(phase, Phase::Head | Phase::Idle) {
            self.wait_to_read();
        }
        if phase == Phase::Idle {
            self.reader.wake();
        }
    }

    /// Wakes `reader` when the answer at hand has been given.
    pub(super) fn wake_at_end(&self, reader: &Waker) {
        self.reader.register(reader);
    }

    /// From `from`, and from no other phase, to the next.
    pub(super) fn leave(&self, from: Phase, to: Phase) {
        if self.phase() == from {
            self.enter(to);
        }
    }

    /// Notes that the client's bytes are waited for.
    pub(super) fn wait_to_read(&self) {
        begin(&self.reading, self.now());
    }

    pub(super) fn read(&self) {
        self.reading.store(0, Ordering::Relaxed);
    }

    /// Notes that the client takes no bytes.
    pub(super) fn wait_to_write(&self) {
        begin(&self.writing, self.now());
    }

    pub(super) fn written(&self) {
        self.writing.store(0, Ordering::Relaxed);
    }

    /// Since when the client is waited for, if it is: smaller is earlier.
    pub(super) fn waiting_since(&self) -> Option<u64> {
        let moments = [&self.reading, &self.writing];
        let moments = moments.map(|moment| moment.load(Ordering::Relaxed));
        moments.into_iter().filter(|moment| *moment > 0).min()
    }

    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_micros())
            .map_or(u64::MAX, |now| now.saturating_add(1))
    }
}

fn begin(moment: &AtomicU64, now: u64) {
    if moment.load(Ordering::Relaxed) == 0 {
        moment.store(now, Ordering::Relaxed);
    }
}
