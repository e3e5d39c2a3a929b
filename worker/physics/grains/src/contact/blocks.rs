//! Candidates in blocks: what lists of pairs, planes and facets have in common.
use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use super::{
    law::Law,
    packed::{Columns, List},
    past::Past,
    stiffness::Springs,
    tangents::{Tangent, Tangents},
    touching::{Observer, Touching, Who},
};
use crate::numbers::lanes::{Array, LANES};

/// Who meets in the lanes of a block.
pub(super) trait Ends: Clone + Debug + Default + Send + Sync + 'static {
    /// Those of one lane.
    type Lane: Copy;

    /// A block of this lane alone, where nothing else may ever touch.
    fn padding(lane: Self::Lane) -> Self;

    fn set(&mut self, lane: usize, ends: Self::Lane);

    /// Shows all that it is made of.
    fn show(&mut self, columns: &mut dyn Columns);
}

/// Candidates in vectors; the last ones of a list may be padding, which never touches.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(super) struct Block<E: Ends, F: Law> {
    pub(super) ends: E,
    /// Constant of the normal spring: k_N [N/m] of a linear one; 0 for padding.
    pub(super) stiffness: Array,
    pub(super) law: F,
}

/// Candidates and which of them touched in the last step.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks<E: Ends, F: Law> {
    pub(super) blocks: Vec<Block<E, F>>,
    pub(super) state: State,
}

/// What there is beside the blocks.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct State {
    /// Bits by lane, block by block.
    pub(super) touching: Vec<u8>,
    tangents: Tangents,
    /// Candidates, padding not counted.
    pub(super) count: usize,
    /// Lanes of the last block that are taken; 0 when it is full or closed.
    filled: usize,
}

/// What is known of a block before its step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before<'a> {
    pub(super) tangent: Tangent<'a>,
    /// Bits of what touched in the last step.
    pub(super) touched: u8,
}

impl<E: Ends, F: Law> Blocks<E, F> {
    /// Adds a candidate and returns its place, block by block. Its bit is set when it has a past, so
    /// that the past is forgotten in time.
    pub(super) fn add(&mut self, ends: E::Lane, springs: &Springs, past: Option<&Past>) -> usize {
        let lane = self.state.filled;
        if lane == 0 {
            self.blocks.push(Block {
                ends: E::padding(ends),
                ..Block::default()
            });
            self.state.touching.push(0);
        }
        let number = self.blocks.len() - 1;
        self.state.tangents.set::<F>(number, lane, springs);
        self.state.count += 1;
        self.state.filled = (lane + 1) % LANES;
        let block = &mut self.blocks[number];
        block.ends.set(lane, ends);
        block.stiffness[lane] = springs.normal;
        let remembered = past.copied().unwrap_or_default();
        block.law.start(lane, springs, &remembered);
        self.state.touching[number] |= u8::from(past.is_some()) << lane;
        number * LANES + lane
    }

    /// The next candidate begins a block.
    pub(super) fn close_block(&mut self) {
        self.state.filled = 0;
    }

    /// All is added.
    pub(super) fn finish(&mut self) {
        self.blocks.shrink_to_fit();
        self.state.touching.shrink_to_fit();
        self.state.tangents.finish();
    }

    /// A block to work through, its bits, and what is known before.
    #[inline(always)]
    pub(super) fn take(&mut self, block: usize) -> (&mut Block<E, F>, &mut u8, Before<'_>) {
        let touching = &mut self.state.touching[block];
        let before = Before {
            tangent: self.state.tangents.of::<F>(block),
            touched: *touching,
        };
        (&mut self.blocks[block], touching, before)
    }

    /// Multiplies tan φ of all contacts.
    pub(super) fn rub(&mut self, factor: f64) {
        self.state.tangents.rub(factor);
    }

    /// Gives the candidate at one place tan φ of that at another, block by block.
    pub(super) fn hand_friction(&mut self, from: usize, to: usize) {
        let [from, to] = [from, to].map(|place| (place / LANES, place % LANES));
        self.state.tangents.hand_friction(from, to);
    }

    /// Whether its candidates may differ in tan φ.
    pub(super) fn has_frictions(&self) -> bool {
        self.state.tangents.differ()
    }

    /// Whether the candidate at a place touched in the last step.
    pub(super) fn touched(&self, place: usize) -> bool {
        self.state.touching[place / LANES] >> (place % LANES) & 1 == 1
    }

    /// Shows the contacts that touched in the last step; `of` tells who is in a lane.
    pub(super) fn see(&self, observer: &mut Observer<'_>, of: impl Fn(&E, usize) -> Who) {
        let blocks = self.blocks.iter().zip(&self.state.touching);
        for (number, (block, bits)) in blocks.enumerate() {
            for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
                observer(Touching {
                    who: of(&block.ends, lane),
                    constant: block.stiffness[lane],
                    shear_ratio: self.state.tangents.ratio(number, lane),
                    friction: self.state.tangents.friction(number, lane),
                    law: &block.law,
                    lane,
                });
            }
        }
    }

    /// Memory [bytes].
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice()) + self.state.tangents.bytes()
    }
}

impl<E: Ends, F: Law> List for Blocks<E, F> {
    fn state(&self) -> &State {
        &self.state
    }

    fn show(&self, columns: &mut dyn Columns) {
        for block in &self.blocks {
            block.clone().show(columns);
        }
    }

    fn fill(&mut self, state: State, columns: &mut dyn Columns) {
        self.blocks
            .resize_with(state.touching.len(), Block::default);
        self.state = state;
        for block in &mut self.blocks {
            block.show(columns);
        }
    }
}

impl<E: Ends, F: Law> Block<E, F> {
    fn show(&mut self, columns: &mut dyn Columns) {
        self.ends.show(columns);
        columns.numbers(&mut self.stiffness);
        self.law.show(columns);
    }
}
