//! What becomes of messages.
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Longest way of a message [ms].
const LONGEST: f64 = 30_000.0;

/// The network of a world: worse under some seeds than under others.
pub(crate) struct Network {
    /// Shares of messages that are lost, doubled, and late.
    lost: f64,
    doubled: f64,
    late: f64,
    /// Whether it has been mended.
    is_whole: bool,
}

impl Network {
    pub(crate) fn new(rng: &mut ChaCha8Rng) -> Self {
        let mut share = |most: f64| {
            if rng.random_bool(0.7) {
                rng.random_range(0.0..most)
            } else {
                0.0
            }
        };
        Self {
            lost: share(0.25),
            doubled: share(0.25),
            late: share(0.3),
            is_whole: false,
        }
    }

    /// From now on every message arrives, once and soon.
    pub(crate) fn mend(&mut self) {
        self.is_whole = true;
    }

    /// How long each copy of a message takes [ms]; none if it is lost.
    pub(crate) fn ways(&self, rng: &mut ChaCha8Rng) -> Vec<i64> {
        if self.is_whole {
            return vec![rng.random_range(1..20)];
        }
        if rng.random_bool(self.lost) {
            return Vec::new();
        }
        let copies = 1 + usize::from(rng.random_bool(self.doubled));
        let way = |_| {
            if rng.random_bool(self.late) {
                // as often between 0.1 and 1 s as between 1 and 10
                (100.0 * (LONGEST / 100.0).powf(rng.random_range(0.0..1.0))) as i64
            } else {
                rng.random_range(1..50)
            }
        };
        (0..copies).map(way).collect()
    }
}
