//! What hangs together, from what joins what.
//!
//! Checks of specs and engines ask the same, so that it stands here, below both.

/// Sets of things that are numbered from 0, each set named by its lowest member. Every thing begins
/// as a set of its own.
///
/// # Source
/// Union-find with path halving (Tarjan and van Leeuwen, Journal of the ACM 31, 1984). The lower root
/// leads, so that names do not depend on the order in which things are joined.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DisjointSets {
    /// The member that leads each thing, never above it; the lowest of a set leads itself.
    leaders: Vec<u32>,
}

impl DisjointSets {
    /// So many things, none joined to another; numbers end at `u32::MAX`.
    pub fn new(count: usize) -> Self {
        let mut sets = Self::default();
        sets.reset(count);
        sets
    }

    /// Takes all apart, and makes them so many; keeps its memory.
    pub fn reset(&mut self, count: usize) {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        self.leaders.clear();
        self.leaders.extend(0..count);
    }

    /// The lowest member of the set that a thing is in.
    #[inline]
    pub fn root(&mut self, mut thing: u32) -> u32 {
        while self.leaders[thing as usize] != thing {
            // halving the path keeps the trees flat
            let above = self.leaders[self.leaders[thing as usize] as usize];
            self.leaders[thing as usize] = above;
            thing = above;
        }
        thing
    }

    /// Makes the sets of two things one.
    #[inline]
    pub fn join(&mut self, first: u32, second: u32) {
        let (first, second) = (self.root(first), self.root(second));
        self.leaders[first.max(second) as usize] = first.min(second);
    }

    /// The lowest member of the set of every thing.
    pub fn into_roots(mut self) -> Vec<u32> {
        for thing in 0..self.leaders.len() {
            // leaders are below, and name their roots by now
            self.leaders[thing] = self.leaders[self.leaders[thing] as usize];
        }
        self.leaders
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_by_their_lowest_member_in_any_order_of_joining() {
        let pairs = [[4, 2], [5, 1], [2, 5], [6, 3]];
        for turn in 0..pairs.len() {
            let mut sets = DisjointSets::new(7);
            for [first, second] in pairs.iter().cycle().skip(turn).take(pairs.len()) {
                sets.join(*second, *first);
            }
            let roots: Vec<u32> = (0..7).map(|thing| sets.root(thing)).collect();
            assert_eq!(roots, [0, 1, 1, 3, 1, 1, 3]);
            assert_eq!(sets.into_roots(), roots);
        }
    }

    #[test]
    fn what_is_reset_hangs_together_no_more() {
        let mut sets = DisjointSets::new(2);
        sets.join(0, 1);
        sets.reset(3);
        assert_eq!(sets, DisjointSets::new(3));
        assert_eq!(sets.into_roots(), [0, 1, 2]);
    }
}
