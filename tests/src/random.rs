//! Chance that can be repeated.
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// A source of random moments; its seed is printed, and `LOADFRAME_SEED` sets it.
#[derive(Clone, Debug)]
pub struct Chance(ChaCha8Rng);

impl Chance {
    /// A fresh seed, or the one in `LOADFRAME_SEED`.
    pub fn new(test: &str) -> Self {
        let seed = match std::env::var("LOADFRAME_SEED") {
            Ok(text) => text.parse().unwrap(),
            Err(_) => u64::from(
                SystemTime::now()
                    .duration_since(UNIX_EPOCH)
                    .unwrap()
                    .subsec_nanos(),
            ),
        };
        eprintln!("{test}: LOADFRAME_SEED={seed}");
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// An independent source, for another thread.
    pub fn split(&mut self) -> Self {
        Self(ChaCha8Rng::seed_from_u64(self.0.random()))
    }

    pub fn number(&mut self, range: Range<u64>) -> u64 {
        self.0.random_range(range)
    }

    pub fn duration(&mut self, below: Duration) -> Duration {
        below.mul_f64(self.0.random())
    }
}
