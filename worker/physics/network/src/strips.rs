//! A network in strips, so that threads share a pass over it.
//!
//! A strip is a range of places, all equally long, with the [`blocks`](super::blocks) of bonds that
//! begin there. Whoever works on a strip sums what acts on its own places where it belongs, and what
//! acts on the first places of the next one into a [`Spill`], which is added when all are done. Blocks
//! that reach farther, or backwards, are left over: one thread works through them before. Where strips
//! end follows from the network alone, and sums over strips are folded in order: no bit of a result
//! depends on the number of threads.
use std::{array, ops::Range};

use loadframe_numerics::Team;

use super::{
    field::{BLOCK, Real},
    sums::Sums,
};

/// Strips at most: a number of each has room on the stack.
const MOST: usize = 64;
/// Places in a strip at least: some 20 µs of work in the shortest pass, several times what it costs
/// to hand it to a thread.
const SHORTEST: usize = 8192;
/// A strip is at least this many times as long as it reaches beyond: less is spilled than stays.
const LENGTHS: usize = 2;

/// Runs that lead farther than this part of all places are left over: they would make strips so long
/// that there were too few to share.
const FARTHEST: usize = 8;

/// Where strips end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strips {
    places: usize,
    /// Places in a strip; fewer in the last.
    length: usize,
    /// Places beyond its own that a strip acts on.
    reach: usize,
    /// The first block and the first slot of each strip, and of what is left over.
    starts: Vec<[usize; 2]>,
    /// All blocks.
    blocks: usize,
}

/// A strip at work.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    pub(crate) number: usize,
    pub(crate) places: Range<usize>,
    pub(crate) blocks: Range<usize>,
    pub(crate) first_slot: usize,
}

impl Strip {
    /// Those of its places that are in `range`.
    pub(crate) fn within(&self, range: &Range<usize>) -> Range<usize> {
        let Range { start, end } = self.places;
        range.start.clamp(start, end)..range.end.clamp(start, end)
    }
}

impl Strips {
    /// Strips of so many places, for runs of bonds with these offsets between their ends.
    pub(crate) fn new(places: usize, offsets: impl Iterator<Item = i64>) -> Self {
        let far = (places / FARTHEST) as i64;
        let reach = offsets.filter(|offset| *offset <= far).max();
        let reach = reach.unwrap_or(0).max(0) as usize + BLOCK;
        let length = SHORTEST.max(LENGTHS * reach).max(places.div_ceil(MOST));
        Self {
            places,
            length: length.next_multiple_of(BLOCK),
            reach,
            ..Self::default()
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.places.div_ceil(self.length).max(1)
    }

    /// The strip of a place.
    pub(crate) fn at(&self, place: usize) -> usize {
        place / self.length
    }

    /// The strip of a block whose bonds have these first ends; [`Strips::count`] when it is left over.
    pub(crate) fn of(&self, run: Option<[u32; 2]>) -> usize {
        if self.count() == 1 {
            return 0;
        }
        match run.map(|run| run.map(|end| end as usize)) {
            Some([first, second]) if (first..=first + self.reach - BLOCK).contains(&second) => {
                first / self.length
            }
            _ => self.count(),
        }
    }

    /// Says that the blocks from this strip on, if they are not known to, begin with that block and
    /// slot.
    pub(crate) fn begin(&mut self, strip: usize, block: usize, slot: usize) {
        if self.starts.len() <= strip {
            self.starts.resize(strip + 1, [block, slot]);
        }
    }

    /// Says that there are so many blocks and slots.
    pub(crate) fn end(&mut self, blocks: usize, slots: usize) {
        self.begin(self.count(), blocks, slots);
        self.blocks = blocks;
    }

    /// All places with the blocks of no strip.
    pub(crate) fn left_over(&self) -> Strip {
        Strip {
            number: self.count(),
            places: 0..self.places,
            blocks: self.starts[self.count()][0]..self.blocks,
            first_slot: 0,
        }
    }

    pub(crate) fn strip(&self, number: usize) -> Strip {
        let start = number * self.length;
        let [block, slot] = self.starts[number];
        Strip {
            number,
            places: start..(start + self.length).min(self.places),
            blocks: block..self.starts[number + 1][0],
            first_slot: slot,
        }
    }

    /// Does `work` on every strip, given its part of the outputs.
    pub(crate) fn each<C: Cut>(
        &self,
        team: &Team,
        outputs: C,
        work: impl Fn(Strip, &mut C) + Sync + Send,
    ) {
        self.each_of(team, 0..self.count(), outputs, &work);
    }

    fn each_of<C: Cut>(
        &self,
        team: &Team,
        range: Range<usize>,
        mut outputs: C,
        work: &(impl Fn(Strip, &mut C) + Sync + Send),
    ) {
        if range.len() == 1 {
            return work(self.strip(range.start), &mut outputs);
        }
        let middle = range.start.midpoint(range.end);
        let (first, second) = outputs.cut(&Cutting {
            places: (middle - range.start) * self.length,
            slots: self.starts[middle][1] - self.starts[range.start][1],
            strips: middle - range.start,
            reach: self.reach,
        });
        team.both(
            || self.each_of(team, range.start..middle, first, work),
            || self.each_of(team, middle..range.end, second, work),
        );
    }

    /// Σ over the strips of what `work` returns.
    pub(crate) fn sum<C: Cut>(
        &self,
        team: &Team,
        outputs: C,
        work: impl Fn(Strip, &mut C) -> f64 + Sync + Send,
    ) -> f64 {
        self.fold(team, outputs, work, |sum, part| sum + part)
    }

    /// What `work` returns for the strips, put together one after the other from 0 on.
    pub(crate) fn fold<C: Cut>(
        &self,
        team: &Team,
        outputs: C,
        work: impl Fn(Strip, &mut C) -> f64 + Sync + Send,
        combine: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let mut parts = [0.0; MOST];
        let count = self.count();
        let outputs = (outputs, OfStrips(&mut parts[..count]));
        self.each(team, outputs, |strip, (outputs, part)| {
            part.0[0] = work(strip, outputs);
        });
        parts[..count].iter().copied().fold(0.0, combine)
    }
}

/// Where outputs are cut in two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cutting {
    places: usize,
    slots: usize,
    strips: usize,
    reach: usize,
}

/// Outputs of a pass that are cut strip from strip.
pub(crate) trait Cut: Sized + Send {
    fn cut(self, at: &Cutting) -> (Self, Self);
}

/// Numbers at places, in one array per component; empty ones stay so.
#[derive(Debug)]
pub(crate) struct AtPlaces<'a, T, const N: usize>(pub(crate) [&'a mut [T]; N]);

/// Numbers in slots, likewise.
#[derive(Debug)]
pub(crate) struct InSlots<'a, T, const N: usize>(pub(crate) [&'a mut [T]; N]);

/// A number of each strip.
#[derive(Debug)]
pub(crate) struct OfStrips<'a, T>(pub(crate) &'a mut [T]);

/// What strips do to places of the next one, in one array per component.
#[derive(Debug)]
pub(crate) struct Spilled<'a, T, const N: usize>(pub(crate) [&'a mut [T]; N]);

impl Cut for () {
    fn cut(self, _: &Cutting) -> (Self, Self) {
        ((), ())
    }
}

impl<A: Cut, B: Cut> Cut for (A, B) {
    fn cut(self, at: &Cutting) -> (Self, Self) {
        let ((a, c), (b, d)) = (self.0.cut(at), self.1.cut(at));
        ((a, b), (c, d))
    }
}

impl<T: Send, const N: usize> Cut for AtPlaces<'_, T, N> {
    fn cut(self, at: &Cutting) -> (Self, Self) {
        let (first, second) = cut_all(self.0, at.places);
        (Self(first), Self(second))
    }
}

impl<T: Send, const N: usize> Cut for InSlots<'_, T, N> {
    fn cut(self, at: &Cutting) -> (Self, Self) {
        let (first, second) = cut_all(self.0, at.slots);
        (Self(first), Self(second))
    }
}

impl<T: Send, const N: usize> Cut for Spilled<'_, T, N> {
    fn cut(self, at: &Cutting) -> (Self, Self) {
        let (first, second) = cut_all(self.0, at.strips * at.reach);
        (Self(first), Self(second))
    }
}

impl<T: Send> Cut for OfStrips<'_, T> {
    fn cut(self, at: &Cutting) -> (Self, Self) {
        let (first, second) = self.0.split_at_mut(at.strips);
        (Self(first), Self(second))
    }
}

/// The same slices, for a while.
pub(crate) fn again<'a, T, const N: usize>(slices: &'a mut [&mut [T]; N]) -> [&'a mut [T]; N] {
    slices.each_mut().map(|slice| &mut **slice)
}

fn cut_all<T, const N: usize>(slices: [&mut [T]; N], at: usize) -> ([&mut [T]; N], [&mut [T]; N]) {
    let mut seconds = array::from_fn(|_| Default::default());
    let mut into = seconds.iter_mut();
    let firsts = slices.map(|slice| {
        let (first, second) = slice.split_at_mut(at.min(slice.len()));
        if let Some(into) = into.next() {
            *into = second;
        }
        first
    });
    (firsts, seconds)
}

/// Memory for what strips do to places of the next ones.
#[derive(Clone, Debug)]
pub(crate) struct Spill<T, const N: usize>([Vec<T>; N]);

impl<T: Real, const N: usize> Spill<T, N> {
    /// For the first `used` of the components.
    pub(crate) fn new(strips: &Strips, used: usize) -> Self {
        let length = match strips.count() {
            1 => 0,
            count => count * strips.reach,
        };
        Self(array::from_fn(|component| {
            vec![T::zero(); if component < used { length } else { 0 }]
        }))
    }

    /// Sets `sums` at every place to what `work` adds to them, for what is left over and then strip by
    /// strip; returns the sum of what it returns.
    pub(crate) fn sum<C: Cut>(
        &mut self,
        strips: &Strips,
        team: &Team,
        mut sums: [&mut [T]; N],
        mut outputs: C,
        work: impl Fn(Strip, &mut C, &mut Sums<'_, T, N>) -> f64 + Sync + Send,
    ) -> f64 {
        let mut total = 0.0;
        let rest = strips.left_over();
        let is_clear = !rest.blocks.is_empty();
        if is_clear {
            let mut all = Sums::new(0, again(&mut sums), array::from_fn(|_| Default::default()));
            all.clear();
            total += work(rest, &mut outputs, &mut all);
        }
        let own = AtPlaces(again(&mut sums));
        let spill = Spilled(self.0.each_mut().map(Vec::as_mut_slice));
        total += strips.sum(
            team,
            ((own, spill), outputs),
            |strip, ((own, spill), outputs)| {
                let (own, spill) = (again(&mut own.0), again(&mut spill.0));
                let mut sums = Sums::new(strip.places.start, own, spill);
                if is_clear {
                    sums.clear_spill();
                } else {
                    sums.clear();
                }
                work(strip, outputs, &mut sums)
            },
        );
        if strips.count() > 1 {
            let own = AtPlaces(sums);
            strips.each(team, own, |strip, own| {
                self.add_to(strips.reach, &strip, own);
            });
        }
        total
    }

    /// Adds what the strip before did to this one.
    fn add_to(&self, reach: usize, strip: &Strip, own: &mut AtPlaces<'_, T, N>) {
        let Some(before) = strip.number.checked_sub(1) else {
            return;
        };
        for (own, spilled) in own.0.iter_mut().zip(&self.0) {
            let spilled = spilled.get(before * reach..).unwrap_or_default();
            for (sum, spilled) in own.iter_mut().zip(spilled.iter().take(reach)) {
                *sum += *spilled;
            }
        }
    }
}

#[cfg(test)]
mod tests;
