//! Bonds in blocks that kernels work through as vectors.
//!
//! Many networks, lattices above all, have runs of bonds that lie side by side: their ends are at
//! places i, i + 1, ... and j, j + 1, ..., so that both ends of a block of them are slices. All
//! other bonds fall into blocks that gather and scatter. Every block is a whole number of vectors
//! long; slots that no bond fills, at the end of a block or in small gaps of a run, hold a bond
//! that does not act.
//!
//! Every block goes through three steps: differences of a nodal field over the bonds, whatever the
//! kernel makes of them, and sums of that back over the nodes.
use super::{
    field::{BLOCK, LANES, Real},
    places::NONE,
    strips::Strips,
    sums::Sums,
};

/// Fewer bonds side by side are gathered.
const SHORTEST_RUN: usize = 8;
/// A longer gap ends a run.
const LONGEST_GAP: u32 = 8;

/// Bonds in consecutive slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    /// The first slot.
    pub(crate) start: usize,
    /// Slots, a multiple of [`LANES`].
    pub(crate) count: usize,
    /// First ends of a run, `None` for bonds in no order.
    run: Option<[usize; 2]>,
}

/// One value per bond of a block and component.
pub(crate) type Buffer<T> = [[T; BLOCK]; 3];

/// Bonds in the order in which kernels work through them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blocks {
    pub(crate) blocks: Vec<Block>,
    /// Number in the network of the bond in each slot, or [`NONE`].
    pub(crate) bonds: Vec<u32>,
    /// Places of the ends of the bond in each slot.
    pub(crate) ends: Vec<[u32; 2]>,
    pub(crate) strips: Strips,
}

impl Blocks {
    /// Puts the bonds with these places of their `ends`, of so many places, into blocks.
    pub(crate) fn new(ends: &[[u32; 2]], places: usize) -> Self {
        let ends_of = |bond: u32| ends[bond as usize];
        let offset = |bond: u32| {
            let [first, second] = ends_of(bond);
            i64::from(second) - i64::from(first)
        };
        // by offset, first end and number, in one number each: comparing them looks nothing up
        let mut keys: Vec<u128> = (0..ends.len() as u32)
            .map(|bond| {
                let offset = (offset(bond) + (1 << 32)) as u128;
                offset << 64 | u128::from(ends_of(bond)[0]) << 32 | u128::from(bond)
            })
            .collect();
        keys.sort_unstable();
        let order: Vec<u32> = keys.iter().map(|key| *key as u32).collect();
        let go_on = |bond: &u32, next: &u32| {
            let gap = ends_of(*next)[0].wrapping_sub(ends_of(*bond)[0]);
            offset(*bond) == offset(*next) && (1..=LONGEST_GAP + 1).contains(&gap)
        };
        let mut pieces: Vec<&[u32]> = Vec::new();
        let mut loose: Vec<u32> = Vec::new();
        for run in order.chunk_by(go_on) {
            if run.len() < SHORTEST_RUN {
                loose.extend(run);
                continue;
            }
            let mut left = run;
            while let Some(first) = left.first() {
                let end = ends_of(*first)[0] + BLOCK as u32;
                let (piece, rest) = left.split_at(left.partition_point(|b| ends_of(*b)[0] < end));
                pieces.push(piece);
                left = rest;
            }
        }
        // strip by strip along memory
        let mut blocks = Self {
            strips: Strips::new(places, pieces.iter().map(|piece| offset(piece[0]))),
            ..Self::default()
        };
        let strip = |piece: &[u32]| blocks.strips.of(Some(ends_of(piece[0])));
        pieces.sort_unstable_by_key(|piece| {
            let bond = piece[0];
            (strip(piece), ends_of(bond)[0], offset(bond))
        });
        loose.sort_unstable();
        for piece in pieces {
            let [first, second] = ends_of(piece[0]);
            let last = ends_of(piece[piece.len() - 1])[0];
            let start = blocks.open((last - first + 1) as usize, Some([first, second]));
            for bond in piece {
                blocks.bonds[start + (ends_of(*bond)[0] - first) as usize] = *bond;
            }
        }
        for piece in loose.chunks(BLOCK) {
            let start = blocks.open(piece.len(), None);
            for (slot, bond) in piece.iter().enumerate() {
                blocks.bonds[start + slot] = *bond;
                blocks.ends[start + slot] = ends_of(*bond);
            }
        }
        blocks.strips.end(blocks.blocks.len(), blocks.bonds.len());
        blocks
    }

    /// Adds a block with room for `bonds`; returns its first slot.
    fn open(&mut self, bonds: usize, run: Option<[u32; 2]>) -> usize {
        let (start, count) = (self.bonds.len(), bonds.next_multiple_of(LANES));
        self.bonds.resize(start + count, NONE);
        self.strips
            .begin(self.strips.of(run), self.blocks.len(), start);
        let ends = |slot: u32| run.map_or([0; 2], |run| run.map(|end| end + slot));
        self.ends.extend((0..count as u32).map(ends));
        self.blocks.push(Block {
            start,
            count,
            run: run.map(|run| run.map(|end| end as usize)),
        });
        start
    }
}

impl Block {
    /// The field at the first and at the second ends: slices of it for a run, else copies in
    /// `scratch`. Axes beyond `D` repeat the first.
    #[inline(always)]
    pub(crate) fn at_ends<'a, T: Real, const D: usize>(
        &self,
        ends: &[[u32; 2]],
        field: &[&'a [T]; 3],
        scratch: &'a mut [Buffer<T>; 2],
    ) -> [[&'a [T]; 3]; 2] {
        let count = self.count;
        if let Some(run) = self.run {
            return run.map(
                #[inline(always)]
                |start| {
                    [0, 1, 2].map(
                        #[inline(always)]
                        |axis| &field[if axis < D { axis } else { 0 }][start..][..count],
                    )
                },
            );
        }
        for (bond, pair) in ends[self.start..][..count].iter().enumerate() {
            for (scratch, node) in scratch.iter_mut().zip(pair) {
                for axis in 0..D {
                    scratch[axis][bond] = field[axis][*node as usize];
                }
            }
        }
        scratch.each_ref().map(
            #[inline(always)]
            |scratch| {
                scratch.each_ref().map(
                    #[inline(always)]
                    |values| &values[..count],
                )
            },
        )
    }

    /// Adds `forces` at the first ends and takes them away at the second ends.
    #[inline(always)]
    pub(crate) fn scatter<T: Real, const D: usize>(
        &self,
        ends: &[[u32; 2]],
        forces: &Buffer<T>,
        sums: &mut Sums<'_, T, 3>,
    ) {
        let count = self.count;
        if let Some([first, second]) = self.run {
            for (axis, forces) in forces.iter().enumerate().take(D) {
                let forces = &forces[..count];
                let [own, spill] = sums.at(axis, first, count);
                let (ours, others) = forces.split_at(own.len());
                add(own, ours);
                add(spill, others);
                let [own, spill] = sums.at(axis, second, count);
                let (ours, others) = forces.split_at(own.len());
                subtract(own, ours);
                subtract(spill, others);
            }
        } else {
            for (bond, ends) in ends[self.start..][..count].iter().enumerate() {
                let [first, second] = ends.map(|end| end as usize - sums.first);
                for (sums, forces) in sums.own.iter_mut().zip(forces).take(D) {
                    sums[first] += forces[bond];
                    sums[second] -= forces[bond];
                }
            }
        }
    }

    /// Adds one value of each bond to both its ends.
    #[inline(always)]
    pub(crate) fn share<T: Real, const N: usize>(
        &self,
        ends: &[[u32; 2]],
        values: &[T; BLOCK],
        component: usize,
        sums: &mut Sums<'_, T, N>,
    ) {
        let values = &values[..self.count];
        if let Some(run) = self.run {
            for end in run {
                let [own, spill] = sums.at(component, end, self.count);
                let (ours, others) = values.split_at(own.len());
                add(own, ours);
                add(spill, others);
            }
        } else {
            for (value, ends) in values.iter().zip(&ends[self.start..][..self.count]) {
                for end in ends {
                    sums.own[component][*end as usize - sums.first] += *value;
                }
            }
        }
    }
}

#[inline(always)]
fn add<T: Real>(sums: &mut [T], values: &[T]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += *value;
    }
}

#[inline(always)]
fn subtract<T: Real>(sums: &mut [T], values: &[T]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum -= *value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: usize = 1024;

    /// The blocks of these ends: which bonds they hold, and whether side by side.
    fn contents(ends: &[[u32; 2]]) -> Vec<(Vec<u32>, bool)> {
        let blocks = Blocks::new(ends, PLACES);
        assert_eq!(blocks.bonds.len(), blocks.ends.len());
        let filled = |block: &Block| {
            let bonds = blocks.bonds[block.start..][..block.count].iter();
            bonds.copied().filter(|bond| *bond != NONE).collect()
        };
        for (slot, bond) in blocks.bonds.iter().enumerate() {
            assert!(*bond == NONE || blocks.ends[slot] == ends[*bond as usize]);
        }
        let all = blocks.blocks.iter();
        all.map(|block| (filled(block), block.run.is_some()))
            .collect()
    }

    #[test]
    fn runs_go_on_over_small_gaps_and_from_block_to_block() {
        let bonds = 2 * BLOCK as u32;
        // a gap of one in the middle, and what follows far away is another run
        let mut ends: Vec<[u32; 2]> = (0..bonds).map(|bond| [bond, bond + 5]).collect();
        ends.remove(100);
        ends.extend((0..20).map(|bond| [bonds + 50 + bond, bonds + 55 + bond]));
        let contents = contents(&ends);
        let lengths: Vec<usize> = contents.iter().map(|(bonds, _)| bonds.len()).collect();
        assert_eq!(lengths, [BLOCK - 1, BLOCK, 20]);
        assert!(contents.iter().all(|(_, is_run)| *is_run));
    }

    #[test]
    fn bonds_in_no_order_and_doubles_of_a_run_are_gathered() {
        let mut ends: Vec<[u32; 2]> = (0..9).map(|bond| [bond, bond + 1]).collect();
        ends.push([7, 2]);
        ends.push([3, 4]);
        let contents = contents(&ends);
        let all: usize = contents.iter().map(|(bonds, _)| bonds.len()).sum();
        assert_eq!(all, ends.len());
        assert!(
            contents
                .iter()
                .any(|(bonds, is_run)| !is_run && bonds.contains(&9))
        );
    }

    #[test]
    fn every_block_is_whole_vectors_long() {
        let ends: Vec<[u32; 2]> = (0..300).map(|bond| [bond, (bond * 7) % 301]).collect();
        for block in Blocks::new(&ends, PLACES).blocks {
            assert!(block.count > 0 && block.count.is_multiple_of(LANES) && block.count <= BLOCK);
        }
    }
}
