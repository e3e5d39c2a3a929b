//! How long a client may still be waited for over one body or answer.
use std::time::Duration;

use super::limits::ConnectionLimits;

/// What has come so far, and how long it was waited for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    bytes: u64,
    waited: Duration,
}

impl Pace {
    /// Longest next wait: none is longer than the limit of silence, nor all together than the grace
    /// and the time that the slowest allowed client takes for as many bytes.
    pub(super) fn longest_wait(&self, limits: &ConnectionLimits) -> Duration {
        let earned = self.bytes as f64 / f64::from(limits.bytes_per_s.max(1));
        let allowed = limits.grace + Duration::from_secs_f64(earned);
        allowed.saturating_sub(self.waited).min(limits.silence)
    }

    /// Notes that `bytes` came after a wait.
    pub(super) fn moved(&mut self, bytes: usize, waited: Duration) {
        self.bytes += bytes as u64;
        self.waited += waited;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> ConnectionLimits {
        ConnectionLimits {
            silence: Duration::from_secs(30),
            grace: Duration::from_secs(60),
            bytes_per_s: 1000,
            ..ConnectionLimits::default()
        }
    }

    #[test]
    fn a_drop_in_every_silence_is_not_enough() {
        let mut pace = Pace::default();
        let mut waits = 0;
        while !pace.longest_wait(&limits()).is_zero() {
            // a byte after 20 s each earns a thousandth of a second
            pace.moved(1, Duration::from_secs(20));
            waits += 1;
        }
        // 20 + 20 + 20 s are the grace of 60 s, and 3 ms were earned; the fourth wait is of those
        assert_eq!(waits, 4);
    }

    #[test]
    fn who_keeps_the_pace_may_go_on_for_ever() {
        let mut pace = Pace::default();
        for _ in 0..10_000 {
            assert_eq!(pace.longest_wait(&limits()), Duration::from_secs(30));
            // 25 s for 25 000 bytes at 1000 bytes/s
            pace.moved(25_000, Duration::from_secs(25));
        }
        // however much was earned, nobody is waited for in silence longer than that
        pace.moved(1 << 40, Duration::ZERO);
        assert_eq!(pace.longest_wait(&limits()), Duration::from_secs(30));
    }
}
