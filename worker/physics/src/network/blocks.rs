//! Bonds in blocks that kernels work through as vectors.
//!
//! A lattice lists its bonds in runs whose ends are i, i + 1, ... and j, j + 1, ...: both ends of a
//! block of such bonds are slices. Bonds of other networks fall into blocks that gather and scatter.
//! Every block goes through three steps: differences of a nodal field over the bonds, whatever the
//! kernel makes of them, and sums of that back over the nodes.
use super::field::Real;

/// Bonds in a block, at most: their buffers stay in the core's nearest cache.
pub(crate) const BLOCK: usize = 128;
/// Shorter runs are gathered.
const SHORTEST_RUN: usize = 8;

/// Consecutive bonds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    /// Number of the first bond.
    pub(crate) start: usize,
    pub(crate) count: usize,
    /// First ends of a run, `None` for bonds in no order.
    run: Option<[usize; 2]>,
}

/// One value per bond of a block and component.
pub(crate) type Buffer<T> = [[T; BLOCK]; 3];

/// Cuts bonds into blocks.
pub(crate) fn blocks(ends: &[[u32; 2]]) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut start = 0;
    while start < ends.len() {
        let most = (ends.len() - start).min(BLOCK);
        let goes_on = |step: &usize| {
            let step = *step;
            ends[start + step] == ends[start].map(|end| end.wrapping_add(step as u32))
        };
        let count = 1 + (1..most).take_while(goes_on).count();
        if count >= SHORTEST_RUN {
            let run = Some(ends[start].map(|end| end as usize));
            blocks.push(Block { start, count, run });
        } else {
            match blocks.last_mut() {
                Some(last) if last.run.is_none() && last.count + count <= BLOCK => {
                    last.count += count;
                }
                _ => blocks.push(Block {
                    start,
                    count,
                    run: None,
                }),
            }
        }
        start += count;
    }
    blocks
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
        let slice = |axis: usize, start: usize| {
            let axis = if axis < D { axis } else { 0 };
            &field[axis][start..][..count]
        };
        if let Some([first, second]) = self.run {
            return [
                [slice(0, first), slice(1, first), slice(2, first)],
                [slice(0, second), slice(1, second), slice(2, second)],
            ];
        }
        for (bond, pair) in ends[self.start..][..count].iter().enumerate() {
            for (scratch, node) in scratch.iter_mut().zip(pair) {
                for axis in 0..D {
                    scratch[axis][bond] = field[axis][*node as usize];
                }
            }
        }
        let [first, second] = scratch;
        [
            [&first[0][..count], &first[1][..count], &first[2][..count]],
            [
                &second[0][..count],
                &second[1][..count],
                &second[2][..count],
            ],
        ]
    }

    /// Adds `forces` at the first ends and takes them away at the second ends.
    #[inline(always)]
    pub(crate) fn scatter<T: Real, const D: usize>(
        &self,
        ends: &[[u32; 2]],
        forces: &Buffer<T>,
        sums: &mut [&mut [T]; 3],
    ) {
        let count = self.count;
        if let Some([first, second]) = self.run {
            for axis in 0..D {
                let forces = &forces[axis][..count];
                for (sum, force) in sums[axis][first..][..count].iter_mut().zip(forces) {
                    *sum += *force;
                }
                for (sum, force) in sums[axis][second..][..count].iter_mut().zip(forces) {
                    *sum -= *force;
                }
            }
        } else {
            for (bond, [first, second]) in ends[self.start..][..count].iter().enumerate() {
                for axis in 0..D {
                    sums[axis][*first as usize] += forces[axis][bond];
                    sums[axis][*second as usize] -= forces[axis][bond];
                }
            }
        }
    }

    /// Adds one value of each bond to both its ends.
    #[inline(always)]
    pub(crate) fn share<T: Real>(&self, ends: &[[u32; 2]], values: &[T; BLOCK], sums: &mut [T]) {
        let values = &values[..self.count];
        if let Some(run) = self.run {
            for end in run {
                for (sum, value) in sums[end..][..self.count].iter_mut().zip(values) {
                    *sum += *value;
                }
            }
        } else {
            for (value, ends) in values.iter().zip(&ends[self.start..][..self.count]) {
                for end in ends {
                    sums[*end as usize] += *value;
                }
            }
        }
    }
}
