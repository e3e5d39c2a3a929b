//! What contacts read of a particle and add to it: rows of four numbers, fetched for a vector of
//! particles at once.
//!
//! A row is one load of 32 bytes; eight of them are turned into four vectors of eight by shuffles
//! within registers. That is far cheaper than eight times three single loads.
//!
//! Here and in all that kernels call, arrays are worked through by loops: functions of the standard
//! library that take closures are compiled for the plainest machine, vectors in them included.
use pulp::{
    Simd,
    bytemuck::{self, Pod},
};
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

/// Place of contact `lane` among the rows of a transpose `width` lanes wide.
#[inline(always)]
fn place(width: usize, lane: usize) -> usize {
    if width == LANES { SHUFFLED[lane] } else { lane }
}

/// Rows of the particles of part number `part` of a block.
#[inline(always)]
pub(crate) fn gather<S: Simd>(
    simd: S,
    rows: &[Row],
    particles: &[u32; LANES],
    part: usize,
) -> Gathered<S> {
    let [x, y, z, fourth] = match S::F64_LANES {
        8 => transpose::<S, 8>(simd, rows, particles, part),
        4 => transpose::<S, 4>(simd, rows, particles, part),
        2 => transpose::<S, 2>(simd, rows, particles, part),
        _ => transpose::<S, 1>(simd, rows, particles, part),
    };
    Gathered {
        vector: Vectors {
            x: Lanes::new(simd, x),
            y: Lanes::new(simd, y),
            z: Lanes::new(simd, z),
        },
        fourth: Lanes::new(simd, fourth),
    }
}

#[inline(always)]
fn transpose<S: Simd, const N: usize>(
    simd: S,
    rows: &[Row],
    particles: &[u32; LANES],
    part: usize,
) -> [S::f64s; 4]
where
    [[f64; 4]; N]: Pod,
{
    let mut fetched = [[0.0; 4]; N];
    for (slot, row) in fetched.iter_mut().enumerate() {
        *row = rows[particles[part * N + place(N, slot)] as usize].0;
    }
    simd.deinterleave_shfl_f64s(bytemuck::cast::<_, [S::f64s; 4]>(fetched))
}

/// Gives `each` the rows of every contact in the part, in the order of contacts whatever the width.
#[inline(always)]
pub(crate) fn scatter<S: Simd, const C: usize>(
    simd: S,
    columns: [Gathered<S>; C],
    part: usize,
    mut each: impl FnMut(usize, [[f64; 4]; C]),
) {
    match S::F64_LANES {
        8 => hand_out::<S, 8, C>(simd, columns, part, &mut each),
        4 => hand_out::<S, 4, C>(simd, columns, part, &mut each),
        2 => hand_out::<S, 2, C>(simd, columns, part, &mut each),
        _ => hand_out::<S, 1, C>(simd, columns, part, &mut each),
    }
}

#[inline(always)]
fn hand_out<S: Simd, const N: usize, const C: usize>(
    simd: S,
    columns: [Gathered<S>; C],
    part: usize,
    each: &mut impl FnMut(usize, [[f64; 4]; C]),
) where
    [[f64; 4]; N]: Pod,
{
    let columns: [[[f64; 4]; N]; C] =
        columns.map(|column| bytemuck::cast(simd.interleave_shfl_f64s(column.values())));
    for lane in 0..N {
        let slot = place(N, lane);
        each(part * N + lane, columns.map(|column| column[slot]));
    }
}

impl<S: Simd> Gathered<S> {
    #[inline(always)]
    fn values(&self) -> [S::f64s; 4] {
        let vector = &self.vector;
        [
            vector.x.value,
            vector.y.value,
            vector.z.value,
            self.fourth.value,
        ]
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

    /// Gathers eight particles and hands their rows out again.
    struct Round<'a>(&'a [Row], &'a [u32; LANES]);

    impl WithSimd for Round<'_> {
        type Output = (Vec<[f64; 4]>, Vec<f64>);

        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let (mut rows, mut first) = (Vec::new(), [0.0; LANES]);
            for part in 0..LANES / S::F64_LANES {
                let gathered = gather(simd, self.0, self.1, part);
                gathered.vector.x.store(&mut first, part);
                scatter(simd, [gathered; 2], part, |contact, [row, _]| {
                    assert_eq!(contact, rows.len());
                    rows.push(row);
                });
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
