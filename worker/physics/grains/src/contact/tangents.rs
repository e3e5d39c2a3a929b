//! The shear springs and the friction of the contacts of a list.
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{law::Law, stiffness::Springs};
use crate::numbers::lanes::{Array, LANES, Lanes};

/// k_T/k_N and tan φ. They belong to a pair of materials; where one pair meets, which is nearly
/// everywhere, a list has them once, and a list without friction never.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum Tangents {
    #[default]
    Unset,
    One([f64; 2]),
    /// By block.
    Each(Vec<[Array; 2]>),
}

/// Those of a block.
#[derive(Clone, Copy, Debug)]
pub(super) enum Tangent<'a> {
    One([f64; 2]),
    Each(&'a [Array; 2]),
}

impl Tangents {
    #[inline(always)]
    pub(super) fn of<F: Law>(&self, block: usize) -> Tangent<'_> {
        match self {
            _ if !F::IS_ROUGH => Tangent::One([0.0; 2]),
            Self::Unset => Tangent::One([0.0; 2]),
            Self::One(values) => Tangent::One(*values),
            Self::Each(blocks) => Tangent::Each(&blocks[block]),
        }
    }

    /// k_T/k_N of the contact in a lane of a block.
    pub(super) fn ratio(&self, block: usize, lane: usize) -> f64 {
        match self {
            Self::Unset => 0.0,
            Self::One([ratio, _]) => *ratio,
            Self::Each(blocks) => blocks[block][0][lane],
        }
    }

    /// tan φ of the contact in a lane of a block.
    pub(super) fn friction(&self, block: usize, lane: usize) -> f64 {
        match self {
            Self::Unset => 0.0,
            Self::One([_, friction]) => *friction,
            Self::Each(blocks) => blocks[block][1][lane],
        }
    }

    /// Multiplies tan φ of all contacts.
    pub(super) fn rub(&mut self, factor: f64) {
        match self {
            Self::Unset => {}
            Self::One([_, friction]) => *friction *= factor,
            Self::Each(blocks) => {
                let frictions = blocks.iter_mut().flat_map(|[_, frictions]| frictions);
                frictions.for_each(|friction| *friction *= factor);
            }
        }
    }

    /// Whether contacts may have other ones than their neighbours.
    pub(super) fn differ(&self) -> bool {
        matches!(self, Self::Each(_))
    }

    /// Gives a contact tan φ of another, each by block and lane.
    pub(super) fn hand_friction(&mut self, from: (usize, usize), to: (usize, usize)) {
        // where all have the same there is nothing to give
        if let Self::Each(blocks) = self {
            blocks[to.0][1][to.1] = blocks[from.0][1][from.1];
        }
    }

    /// Sets those of a contact in the last block, number `block`.
    #[allow(clippy::float_cmp, reason = "the same materials give the same bits")]
    pub(super) fn set<F: Law>(&mut self, block: usize, lane: usize, springs: &Springs) {
        if !F::IS_ROUGH {
            return;
        }
        let values = [springs.ratio, springs.friction];
        match self {
            Self::Unset => *self = Self::One(values),
            Self::One(known) if *known == values => {}
            Self::One(known) => {
                *self = Self::Each(vec![known.map(|value| [value; LANES]); block + 1]);
                self.set::<F>(block, lane, springs);
            }
            Self::Each(blocks) => {
                blocks.resize(block + 1, values.map(|value| [value; LANES]));
                for (array, value) in blocks[block].iter_mut().zip(values) {
                    array[lane] = value;
                }
            }
        }
    }

    /// All is set.
    pub(super) fn finish(&mut self) {
        if let Self::Each(blocks) = self {
            blocks.shrink_to_fit();
        }
    }

    /// Memory [bytes].
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Unset | Self::One(_) => 0,
            Self::Each(blocks) => size_of_val(blocks.as_slice()),
        }
    }
}

impl Tangent<'_> {
    /// k_T/k_N and tan φ of a part.
    #[inline(always)]
    pub(super) fn load<S: Simd>(self, simd: S, part: usize) -> [Lanes<S>; 2] {
        match self {
            Self::One([ratio, friction]) => {
                [Lanes::splat(simd, ratio), Lanes::splat(simd, friction)]
            }
            Self::Each([ratios, frictions]) => [
                Lanes::load(simd, ratios, part),
                Lanes::load(simd, frictions, part),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are moved, not computed")]
    use super::*;
    use crate::contact::{
        law::{Coulomb, Followed, Frictionless, Linear},
        stiffness::{Cement, Resistance},
    };

    type Rough = Coulomb<Linear, Followed>;

    #[test]
    fn a_list_has_one_tangent_until_two_pairs_of_materials_meet_in_it() {
        let springs = |ratio: f64| Springs {
            normal: 1e5,
            ratio,
            friction: 0.5,
            dashpots: [0.0; 2],
            resistance: Resistance::default(),
            cement: Cement::default(),
        };
        let mut tangents = Tangents::default();
        tangents.set::<Rough>(0, 0, &springs(0.3));
        tangents.set::<Rough>(1, 0, &springs(0.3));
        assert_eq!(tangents, Tangents::One([0.3, 0.5]));
        assert_eq!(tangents.bytes(), 0);
        tangents.set::<Frictionless<Linear>>(1, 1, &springs(0.25));
        assert_eq!(tangents, Tangents::One([0.3, 0.5]));
        tangents.set::<Rough>(1, 1, &springs(0.25));
        tangents.set::<Rough>(2, 0, &springs(0.3));
        tangents.rub(0.5);
        for (block, lane, expected) in [(0, 0, 0.3), (1, 0, 0.3), (1, 1, 0.25), (2, 0, 0.3)] {
            assert_eq!(tangents.ratio(block, lane), expected);
            let Tangent::Each([_, frictions]) = tangents.of::<Rough>(block) else {
                panic!("two pairs of materials met");
            };
            assert_eq!(frictions[lane], 0.25);
        }
        tangents.set::<Rough>(
            2,
            1,
            &Springs {
                friction: 0.1,
                ..springs(0.25)
            },
        );
        tangents.hand_friction((2, 1), (0, 3));
        assert_eq!([tangents.friction(0, 3), tangents.ratio(0, 3)], [0.1, 0.3]);
    }
}
