//! Waiting for conditions.
use std::time::{Duration, Instant};

/// Longest wait for something that must come: far beyond any time a healthy lab takes, so that
/// only a hang reaches it, on however slow a machine.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Between two questions, at first and later.
const SHORTEST_PAUSE: Duration = Duration::from_millis(2);
const LONGEST_PAUSE: Duration = Duration::from_millis(40);

/// Asks `probe` until it gives a value.
///
/// # Panics
/// After [`PATIENCE`], naming what was waited for.
pub fn until<T>(what: &str, mut probe: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    let mut pause = SHORTEST_PAUSE;
    loop {
        if let Some(value) = probe() {
            return value;
        }
        assert!(
            begin.elapsed() < PATIENCE,
            "waited {PATIENCE:?} in vain until {what}"
        );
        std::thread::sleep(pause);
        // an answer takes the server a millisecond or two, which others could use
        pause = (pause * 5 / 4).min(LONGEST_PAUSE);
    }
}

/// How long the random tests go on, from `LOADFRAME_SOAK` (minutes); without it they stop at their
/// number of kills.
pub fn soak() -> Option<Duration> {
    let minutes: f64 = std::env::var("LOADFRAME_SOAK").ok()?.parse().unwrap();
    Some(Duration::from_secs_f64(60.0 * minutes))
}
