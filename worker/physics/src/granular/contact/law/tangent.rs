//! The shear spring and the friction of the contacts of a block.
use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::granular::lanes::{Array, LANES, Lanes};

/// k_T/k_N and tan φ. They belong to a pair of materials; where one pair meets, which is nearly
/// everywhere, a block has them once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) enum Tangent {
    #[default]
    Unset,
    One([f64; 2]),
    Each(Box<[Array; 2]>),
}

impl Tangent {
    /// k_T/k_N and tan φ of a part.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, part: usize) -> [Lanes<S>; 2] {
        match self {
            Self::Unset => [Lanes::splat(simd, 0.0); 2],
            Self::One([ratio, friction]) => {
                [Lanes::splat(simd, *ratio), Lanes::splat(simd, *friction)]
            }
            Self::Each(arrays) => [
                Lanes::load(simd, &arrays[0], part),
                Lanes::load(simd, &arrays[1], part),
            ],
        }
    }

    /// k_T/k_N and tan φ of a contact.
    pub(super) fn at(&self, lane: usize) -> [f64; 2] {
        match self {
            Self::Unset => [0.0; 2],
            Self::One(values) => *values,
            Self::Each(arrays) => [arrays[0][lane], arrays[1][lane]],
        }
    }

    /// Multiplies tan φ of all contacts.
    pub(super) fn rub(&mut self, factor: f64) {
        match self {
            Self::Unset => {}
            Self::One([_, friction]) => *friction *= factor,
            Self::Each(arrays) => arrays[1]
                .iter_mut()
                .for_each(|friction| *friction *= factor),
        }
    }

    #[allow(clippy::float_cmp, reason = "the same materials give the same bits")]
    pub(super) fn set(&mut self, lane: usize, values: [f64; 2]) {
        match self {
            Self::Unset => *self = Self::One(values),
            Self::One(known) if *known == values => {}
            Self::One(known) => {
                *self = Self::Each(Box::new(known.map(|value| [value; LANES])));
                self.set(lane, values);
            }
            Self::Each(arrays) => {
                for (array, value) in arrays.iter_mut().zip(values) {
                    array[lane] = value;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are moved, not computed")]
    use super::*;

    #[test]
    fn a_block_has_one_tangent_until_two_pairs_of_materials_meet_in_it() {
        let mut tangent = Tangent::default();
        tangent.set(0, [0.3, 0.5]);
        tangent.set(1, [0.3, 0.5]);
        assert_eq!(tangent, Tangent::One([0.3, 0.5]));
        tangent.set(2, [0.25, 0.5]);
        for (lane, expected) in [(0, [0.3, 0.5]), (1, [0.3, 0.5]), (2, [0.25, 0.5])] {
            assert_eq!(tangent.at(lane), expected);
        }
    }
}
