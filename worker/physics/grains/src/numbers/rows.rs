//! What contacts read of a particle and add to it: rows of four numbers, fetched for a vector of
//! particles at once.
//!
//! A row is one load of 32 bytes; eight of them are turned into four vectors of eight by shuffles
//! within registers. That is far cheaper than eight times three single loads.
//!
//! Here and in all that kernels call, arrays are worked through by loops: functions of the standard
//! library that take closures are compiled for the plainest machine, vectors in them included.
use pulp::{Simd, bytemuck};
use serde::{Deserialize, Serialize};

use super::{
    Vector,
    lanes::{LANES, Lanes, Vectors},
};

/// Three components and a fourth number that belongs to them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[repr(align(32))]
pub(crate) struct Row(pub(crate) [f64; 4]);

/// Rows of a vector of particles, by component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gathered<S: Simd> {
    pub(crate) vector: Vectors<S>,
    pub(crate) fourth: Lanes<S>,
}

impl Row {
    pub(crate) fn new(vector: Vector, fourth: f64) -> Self {
        Self([vector.x, vector.y, vector.z, fourth])
    }

    pub(crate) fn vector(&self) -> Vector {
        Vector::new(self.0[0], self.0[1], self.0[2])
    }

    /// How deep two spheres, with centre and radius in a row each, are in each other [m].
    pub(crate) fn overlap(&self, other: &Self) -> f64 {
        self.0[3] + other.0[3] - (other.vector() - self.vector()).norm()
    }

    pub(crate) fn set(&mut self, vector: Vector) {
        self.0[..3].copy_from_slice(vector.as_slice());
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, other: [f64; 4]) {
        for (sum, term) in self.0.iter_mut().zip(other) {
            *sum += term;
        }
    }

    #[inline(always)]
    pub(crate) fn subtract(&mut self, other: [f64; 4]) {
        for (sum, term) in self.0.iter_mut().zip(other) {
            *sum -= term;
        }
    }
}

/// Row of the shuffled transpose of eight rows that ends in each lane, and the other way round: the
/// instruction that does it cheaply mixes the lanes up, the same way in both directions.
const SHUFFLED: [usize; LANES] = [0, 2, 1, 3, 4, 6, 5, 7];

/// Place of contact `lane` among the rows of a transpose.
#[inline(always)]
fn place<S: Simd>(lane: usize) -> usize {
    if S::F64_LANES == LANES {
        SHUFFLED[lane]
    } else {
        lane
    }
}

/// Rows of the particles of part number `part` of a block.
#[inline(always)]
pub(crate) fn gather<S: Simd>(
    simd: S,
    rows: &[Row],
    particles: &[u32; LANES],
    part: usize,
) -> Gathered<S> {
    let mut fetched = [simd.splat_f64s(0.0); 4];
    // as many as there are lanes
    let slots: &mut [[f64; 4]] = bytemuck::cast_slice_mut(&mut fetched);
    for (slot, row) in slots.iter_mut().enumerate() {
        *row = rows[particles[part * S::F64_LANES + place::<S>(slot)] as usize].0;
    }
    let [x, y, z, fourth] = simd.deinterleave_shfl_f64s(fetched);
    Gathered {
        vector: Vectors {
            x: Lanes::new(simd, x),
            y: Lanes::new(simd, y),
            z: Lanes::new(simd, z),
        },
        fourth: Lanes::new(simd, fourth),
    }
}

/// Columns of contacts as rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattered<S: Simd>([S::f64s; 4]);

impl<S: Simd> Scattered<S> {
    /// The row of a lane.
    #[inline(always)]
    pub(crate) fn row(&self, lane: usize) -> [f64; 4] {
        bytemuck::cast_slice(&self.0)[place::<S>(lane)]
    }

    /// The same, where there are any; without a closure, see above.
    #[inline(always)]
    pub(crate) fn row_of(scattered: Option<&Self>, lane: usize) -> Option<[f64; 4]> {
        let mut row = None;
        if let Some(scattered) = scattered {
            row = Some(scattered.row(lane));
        }
        row
    }
}

impl<S: Simd> Gathered<S> {
    /// Columns as rows.
    #[inline(always)]
    pub(crate) fn scatter(&self, simd: S) -> Scattered<S> {
        let vector = &self.vector;
        Scattered(simd.interleave_shfl_f64s([
            vector.x.value,
            vector.y.value,
            vector.z.value,
            self.fourth.value,
        ]))
    }

    /// This where `mask` is set, zero elsewhere.
    #[inline(always)]
    pub(crate) fn masked(self, simd: S, mask: S::m64s) -> Self {
        Self {
            vector: self.vector.only_if(mask, Vectors::zero(simd)),
            fourth: self.fourth.only_if(mask, Lanes::splat(simd, 0.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are moved, not computed")]
    use super::*;
    use pulp::{Arch, Scalar, WithSimd};

    /// Gathers eight particles and scatters their rows again.
    struct Round<'a>(&'a [Row], &'a [u32; LANES]);

    impl WithSimd for Round<'_> {
        type Output = (Vec<[f64; 4]>, Vec<f64>);

        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let (mut rows, mut first) = (Vec::new(), [0.0; LANES]);
            for part in 0..LANES / S::F64_LANES {
                let gathered = gather(simd, self.0, self.1, part);
                gathered.vector.x.store(&mut first, part);
                let scattered = gathered.scatter(simd);
                rows.extend((0..S::F64_LANES).map(|lane| scattered.row(lane)));
            }
            (rows, first.to_vec())
        }
    }

    #[test]
    fn lanes_keep_the_order_of_contacts_in_every_width() {
        let rows: Vec<Row> = (0..9)
            .map(|row| {
                Row(std::array::from_fn(|column| {
                    f64::from(10 * row + column as i32)
                }))
            })
            .collect();
        let particles = [8, 1, 2, 7, 4, 4, 0, 5];
        let expected: Vec<[f64; 4]> = particles.iter().map(|p| rows[*p as usize].0).collect();
        let xs: Vec<f64> = expected.iter().map(|row| row[0]).collect();
        let round = || Round(&rows, &particles);
        let mut found = vec![
            Arch::new().dispatch(round()),
            Simd::vectorize(Scalar::new(), round()),
        ];
        #[cfg(target_arch = "x86_64")]
        found.extend(pulp::x86::V3::try_new().map(|simd| Simd::vectorize(simd, round())));
        for (rows, first) in found {
            assert_eq!(rows, expected);
            assert_eq!(first, xs);
        }
    }
}
