//! Which bonds break at an equilibrium.
use loadframe_numerics::wide;

use super::field::BLOCK;

/// The rule of a breaking round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BreakingRule {
    /// Every bond whose tension exceeds its strength.
    AllOverStrength,
    /// Only the one with the largest tension over strength.
    WeakestFirst,
    /// None.
    Never,
}

/// The slots in which the tension exceeds the strength.
pub(crate) fn over_strength(tensions: &[f64], strengths: &[f64]) -> Vec<usize> {
    let mut over = Vec::new();
    wide(
        #[inline(always)]
        || {
            let blocks = tensions.chunks(BLOCK).zip(strengths.chunks(BLOCK));
            for (block, (tensions, strengths)) in blocks.enumerate() {
                let slots = || (block * BLOCK..).zip(tensions.iter().zip(strengths));
                // in most blocks there is none
                let count: u64 = slots().map(|(_, (t, s))| u64::from(t > s)).sum();
                if count > 0 {
                    over.extend(slots().filter(|(_, (t, s))| t > s).map(|(slot, _)| slot));
                }
            }
        },
    );
    over
}

/// A bond under tension: its number in the network, tension [N] and strength [N].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) bond: usize,
    pub(crate) tension: f64,
    pub(crate) strength: f64,
}

impl Candidate {
    /// Failure index: tension over strength [-].
    pub(crate) fn index(&self) -> f64 {
        self.tension / self.strength
    }

    pub(crate) fn is_over_strength(&self) -> bool {
        self.tension > self.strength && self.tension > 0.0
    }
}

/// The bonds that break, by ascending number. Compression never breaks a bond.
pub(crate) fn breaking(
    rule: BreakingRule,
    candidates: impl Iterator<Item = Candidate>,
) -> Vec<Candidate> {
    let over_strength = candidates.filter(Candidate::is_over_strength);
    match rule {
        BreakingRule::Never => Vec::new(),
        BreakingRule::AllOverStrength => over_strength.collect(),
        BreakingRule::WeakestFirst => {
            // the first of equals stays, which is the one with the lowest number; without strength
            // the ratio is infinite
            let weaker = |worst: Candidate, next: Candidate| {
                let is_worse = next.index() > worst.index();
                if is_worse { next } else { worst }
            };
            over_strength.reduce(weaker).into_iter().collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn broken(rule: BreakingRule) -> Vec<usize> {
        let tensions_and_strengths = [
            (2.0, 3.0),
            (3.0, 2.0),
            (4.0, 2.0),
            (8.0, 4.0),
            (-5.0, 0.0),
            (0.0, 0.0),
        ];
        let numbered = tensions_and_strengths.iter().enumerate();
        let candidates = numbered.map(|(bond, &(tension, strength))| Candidate {
            bond,
            tension,
            strength,
        });
        let broken = breaking(rule, candidates);
        broken.iter().map(|candidate| candidate.bond).collect()
    }

    #[test]
    fn all_over_strength_in_tension_break() {
        assert_eq!(broken(BreakingRule::AllOverStrength), [1, 2, 3]);
    }

    #[test]
    fn the_weakest_is_the_lowest_number_among_equal_ratios() {
        assert_eq!(broken(BreakingRule::WeakestFirst), [2]);
    }

    #[test]
    fn every_slot_over_strength_is_seen() {
        let strengths: Vec<f64> = (0..200).map(f64::from).collect();
        let mut tensions = strengths.clone();
        for slot in [0, 63, 64, 199] {
            tensions[slot] += 1e-9;
        }
        tensions[100] = f64::NAN;
        tensions[101] = -1e9;
        assert_eq!(over_strength(&tensions, &strengths), [0, 63, 64, 199]);
    }

    #[test]
    fn never_is_never() {
        assert!(broken(BreakingRule::Never).is_empty());
    }
}
