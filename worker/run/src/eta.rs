//! Time to the end, from how fast the work goes.
use std::time::Duration;

/// Nothing is said before this much time: the first steps are not like the others.
const FIRST_WORD: Duration = Duration::from_millis(500);
/// The rate forgets over this part of the time elapsed, so that a slow start does not weigh on the
/// estimate for ever, and one slow step does not make it jump.
const MEMORY_FRACTION: f64 = 0.25;
/// and over no less than this [s].
const SHORTEST_MEMORY_S: f64 = 2.0;

/// Smoothed rate of progress.
#[derive(Debug, Default)]
pub struct TimeToGo {
    /// Time [s] and fraction of work when last told.
    last: Option<(f64, f64)>,
    /// Fraction of work per second.
    rate: f64,
}

impl TimeToGo {
    /// Takes in that at `elapsed` the work was done to `fraction`, and estimates the time [s] left.
    pub fn update(&mut self, elapsed: Duration, fraction: f64) -> Option<f64> {
        let now = elapsed.as_secs_f64();
        match self.last {
            // a resumed run starts above zero: only what it does itself tells its speed
            None => self.last = Some((now, fraction)),
            Some((then, before)) if now > then => {
                let rate = (fraction - before) / (now - then);
                let memory = (MEMORY_FRACTION * now).max(SHORTEST_MEMORY_S);
                let weight = if self.rate == 0.0 {
                    1.0
                } else {
                    1.0 - ((then - now) / memory).exp()
                };
                self.rate += weight * (rate - self.rate);
                self.last = Some((now, fraction));
            }
            Some(_) => {}
        }
        let left = (1.0 - fraction) / self.rate;
        (elapsed >= FIRST_WORD && left.is_finite() && left >= 0.0).then_some(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a few hundred additions.
    const ROUND_OFF: f64 = 1e-9;

    fn run(eta: &mut TimeToGo, from_s: f64, fraction: f64, rate: f64, steps: u32) -> Option<f64> {
        let mut left = None;
        for step in 0..=steps {
            let passed = f64::from(step) * 0.1;
            let at = Duration::from_secs_f64(from_s + passed);
            left = eta.update(at, fraction + rate * passed);
        }
        left
    }

    #[test]
    fn a_steady_run_is_foreseen_exactly_even_when_resumed_halfway() {
        // 2 % per second from 0.5; after 5 s at 0.6 there are 0.4/0.02 = 20 s left
        let left = run(&mut TimeToGo::default(), 0.0, 0.5, 0.02, 50).expect("known after 5 s");
        assert!((left - 20.0).abs() < 20.0 * ROUND_OFF, "{left}");
    }

    #[test]
    fn a_change_of_pace_is_learned_within_a_few_memories() {
        let mut eta = TimeToGo::default();
        run(&mut eta, 0.0, 0.0, 0.01, 100);
        // from 0.1 at 10 s ten times slower for 40 s, about 8 memories of 5 to 12 s
        let left = run(&mut eta, 10.0, 0.1, 0.001, 400).expect("known");
        let steady = (1.0 - 0.14) / 0.001;
        // e^-4, with the longest memory of 12.5 s: 0.009 · e^-3.2 of the old rate may remain
        let slowest = 0.001 + 0.009 * (-40.0_f64 / 12.5).exp();
        assert!(left <= steady && left >= (1.0 - 0.14) / slowest, "{left}");
    }

    #[test]
    fn nothing_is_said_before_anything_is_known() {
        let mut eta = TimeToGo::default();
        assert_eq!(eta.update(Duration::ZERO, 0.0), None);
        assert_eq!(eta.update(Duration::from_millis(100), 0.1), None);
        let mut idle = TimeToGo::default();
        idle.update(Duration::ZERO, 0.0);
        assert_eq!(idle.update(Duration::from_secs(9), 0.0), None);
    }
}
