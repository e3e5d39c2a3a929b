//! Whose turn it is: among jobs of equal priority the person goes first who has used least lately.
//!
//! What a person has used is core seconds (wall time of attempts times threads of their workers), of which
//! half counts after [`HALF_LIFE_MS`]. It is kept as a level, the logarithm to the base 2 of the core seconds
//! plus the moment in half-lives: levels of two people compare as their use does at any moment, and nothing
//! has to be rewritten as time goes by. A running attempt counts from its start, as a minute at least.
use uuid::Uuid;

/// Use counts half after this [ms]: a day, so that a night's work weighs the next morning and a week's is
/// forgiven (Slurm's `PriorityDecayHalfLife` is of the same kind, and a week by default).
pub const HALF_LIFE_MS: f64 = 24.0 * 3600.0 * 1000.0;
/// A running attempt counts as at least so long [ms]: of jobs that start at once, people get one each.
pub const LEAST_COUNTED_MS: i64 = 60_000;

/// How a person stands with the queue.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    pub person: Uuid,
    /// Of the attempts that have ended; `None` is nothing yet.
    pub level: Option<f64>,
    pub running: u32,
    /// Core seconds of what runs.
    pub running_core_s: f64,
    pub most_running: Option<u32>,
}

impl Standing {
    /// Recent use [core s] at the moment `now` [ms since 1970].
    pub fn use_s(&self, now: i64) -> f64 {
        used(self.level, now) + self.running_core_s
    }

    /// Whether no further job of the person may run.
    pub fn is_at_limit(&self) -> bool {
        self.most_running.is_some_and(|most| self.running >= most)
    }
}

/// What a level means at the moment `now` [ms since 1970], in core seconds.
pub fn used(level: Option<f64>, now: i64) -> f64 {
    level.map_or(0.0, |level| (level - now as f64 / HALF_LIFE_MS).exp2())
}

/// The level after `core_s` more were used at the moment `now` [ms since 1970].
pub fn charged(level: Option<f64>, core_s: f64, now: i64) -> Option<f64> {
    let used = used(level, now) + core_s.max(0.0);
    let charged = used.log2() + now as f64 / HALF_LIFE_MS;
    if charged.is_finite() {
        Some(charged)
    } else {
        level
    }
}

/// Which of the candidates is next, each a person (none for nobody's) and the number of their first job: the
/// one with the least use, of equal ones the job submitted first.
pub fn next(candidates: &[(Option<Uuid>, i64)], standings: &[Standing], now: i64) -> Option<usize> {
    let use_of = |person: Option<Uuid>| {
        let mut standings = standings.iter();
        let found = standings.find(|standing| Some(standing.person) == person);
        found.map_or(0.0, |standing| standing.use_s(now))
    };
    let key = |index: &usize| (use_of(candidates[*index].0), candidates[*index].1);
    let compare = |a: &usize, b: &usize| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    };
    (0..candidates.len()).min_by(compare)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANNA: Uuid = Uuid::from_u128(1);
    const BERT: Uuid = Uuid::from_u128(2);
    const NOW: i64 = 1_800_000_000_000;
    const DAY: i64 = 24 * 3600 * 1000;

    fn standing(person: Uuid, level: Option<f64>) -> Standing {
        Standing {
            person,
            level,
            running: 0,
            running_core_s: 0.0,
            most_running: None,
        }
    }

    #[test]
    fn use_counts_half_a_day_later_and_adds_up() {
        let first = charged(None, 800.0, NOW);
        let is_near = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-9;
        assert!(is_near(used(first, NOW), 800.0));
        assert!(is_near(used(first, NOW + DAY), 400.0));
        let second = charged(first, 100.0, NOW + DAY);
        // 400 + 100, and a quarter of that two days later
        assert!(is_near(used(second, NOW + 3 * DAY), 125.0));
        assert_eq!(charged(None, 0.0, NOW), None, "nothing is nothing");
        assert_eq!(
            charged(first, f64::NAN, NOW),
            first.map(|_| charged(first, 0.0, NOW).unwrap())
        );
    }

    #[test]
    fn who_has_used_least_is_next_and_of_equals_who_came_first() {
        let waiting = [(Some(ANNA), 1), (Some(BERT), 10_001)];
        assert_eq!(next(&waiting, &[], NOW), Some(0));
        let used = [
            standing(ANNA, charged(None, 5.0, NOW)),
            standing(BERT, None),
        ];
        assert_eq!(next(&waiting, &used, NOW), Some(1));
        let mut running = [standing(ANNA, None), standing(BERT, None)];
        running[0].running_core_s = 60.0;
        assert_eq!(next(&waiting, &running, NOW), Some(1));
        assert_eq!(next(&[], &running, NOW), None);
        // nobody's jobs go by their order alone
        assert_eq!(next(&[(None, 7), (None, 3)], &[], NOW), Some(1));
    }
}
