//! Numbers side by side: one arithmetic for every width of vector instructions.
//!
//! A kernel is written once over [`Lanes`] and compiled for 8, 4 and 1 numbers at a time. Products
//! and sums stay apart (nothing is fused) and each lane is a contact of its own, so that every
//! width gives the same bits.
use std::ops::{Add, Mul, Neg, Sub};

use pulp::{Simd, bytemuck};

/// Contacts in a block: the widest vectors hold so many numbers.
pub(crate) const LANES: usize = 8;

/// A number for each contact of a block.
pub(crate) type Array = [f64; LANES];

/// Bits of the lanes that `mask` has, the first lane of a block in the lowest.
#[inline(always)]
pub(crate) fn bits<S: Simd>(mask: S::m64s, part: usize) -> u8 {
    let bytes = bytemuck::bytes_of(&mask);
    if S::F64_LANES == LANES && bytes.len() == 1 {
        return bytes[0];
    }
    let width = bytes.len() / S::F64_LANES;
    let mut bits = 0;
    for lane in 0..S::F64_LANES {
        bits |= (bytes[lane * width] & 1) << lane;
    }
    bits << (part * S::F64_LANES)
}

/// Whether `mask` has any lane: cheaper than to ask which.
#[inline(always)]
pub(crate) fn any<S: Simd>(mask: S::m64s) -> bool {
    let mut all = 0;
    for byte in bytemuck::bytes_of(&mask) {
        all |= byte;
    }
    all != 0
}

/// Some numbers side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    pub(crate) value: S::f64s,
}

/// Some vectors side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vectors<S: Simd> {
    pub(crate) x: Lanes<S>,
    pub(crate) y: Lanes<S>,
    pub(crate) z: Lanes<S>,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, value: S::f64s) -> Self {
        Self { simd, value }
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        Self::new(simd, simd.splat_f64s(value))
    }

    /// Part number `part` of a block.
    #[inline(always)]
    pub(crate) fn load(simd: S, array: &Array, part: usize) -> Self {
        Self::new(simd, S::as_simd_f64s(array).0[part])
    }

    #[inline(always)]
    pub(crate) fn store(self, array: &mut Array, part: usize) {
        S::as_mut_simd_f64s(array).0[part] = self.value;
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self::new(self.simd, self.simd.sqrt_f64s(self.value))
    }

    /// Quotient.
    #[inline(always)]
    pub(crate) fn over(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.div_f64s(self.value, other.value))
    }

    /// The smaller of both numbers.
    #[inline(always)]
    pub(crate) fn or_smaller(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.min_f64s(self.value, other.value))
    }

    /// The larger of both numbers.
    #[inline(always)]
    pub(crate) fn or_larger(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.max_f64s(self.value, other.value))
    }

    #[inline(always)]
    pub(crate) fn at_most(self, other: Self) -> S::m64s {
        (self.simd).less_than_or_equal_f64s(self.value, other.value)
    }

    #[inline(always)]
    pub(crate) fn below(self, other: Self) -> S::m64s {
        self.simd.less_than_f64s(self.value, other.value)
    }

    /// This where `mask` is set, `other` elsewhere.
    #[inline(always)]
    pub(crate) fn only_if(self, mask: S::m64s, other: Self) -> Self {
        let value = (self.simd).select_f64s(mask, self.value, other.value);
        Self::new(self.simd, value)
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $instruction:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self::new(self.simd, self.simd.$instruction(self.value, other.value))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(self.simd, self.simd.neg_f64s(self.value))
    }
}

impl<S: Simd> Vectors<S> {
    #[inline(always)]
    pub(crate) fn zero(simd: S) -> Self {
        Self::splat(simd, [0.0; 3])
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, vector: [f64; 3]) -> Self {
        let [x, y, z] = vector;
        Self {
            x: Lanes::splat(simd, x),
            y: Lanes::splat(simd, y),
            z: Lanes::splat(simd, z),
        }
    }

    #[inline(always)]
    pub(crate) fn load(simd: S, arrays: &[Array; 3], part: usize) -> Self {
        Self {
            x: Lanes::load(simd, &arrays[0], part),
            y: Lanes::load(simd, &arrays[1], part),
            z: Lanes::load(simd, &arrays[2], part),
        }
    }

    #[inline(always)]
    pub(crate) fn store(self, arrays: &mut [Array; 3], part: usize) {
        self.x.store(&mut arrays[0], part);
        self.y.store(&mut arrays[1], part);
        self.z.store(&mut arrays[2], part);
    }

    #[inline(always)]
    pub(crate) fn scaled(self, factor: Lanes<S>) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> Lanes<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub(crate) fn only_if(self, mask: S::m64s, other: Self) -> Self {
        Self {
            x: self.x.only_if(mask, other.x),
            y: self.y.only_if(mask, other.y),
            z: self.z.only_if(mask, other.z),
        }
    }
}

impl<S: Simd> Add for Vectors<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl<S: Simd> Sub for Vectors<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}
