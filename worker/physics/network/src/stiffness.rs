//! The Hessian of the energy, bond by bond, as the inner solver uses it.

use loadframe_numerics::{Team, wide};

use super::{
    assembly::Assembly,
    blocks::Buffer,
    field::{BLOCK, Field, Real, sum},
    strips::{Spill, Strip},
    sums::Sums,
};

/// Blocks whose work is summed in the precision of the data.
const BLOCKS_PER_SUM: usize = 64;

/// K = b 1 + s sᵀ of every bond, s = √(a − b) n: the stiffness (7) between its ends in four
/// numbers. a > b always: a − b = (e + f_r u (2 + u))/l in tension, r_c/l in compression.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stiffness<T> {
    /// s [√(N/mm)].
    pub(crate) axial: [Vec<T>; 3],
    /// b [N/mm].
    pub(crate) transverse: Vec<T>,
}

impl<T: Real> Stiffness<T> {
    pub(crate) fn zeros(slots: usize, dimensions: usize) -> Self {
        Self {
            axial: [0, 1, 2].map(|axis| {
                let length = if axis < dimensions { slots } else { 0 };
                vec![T::zero(); length]
            }),
            transverse: vec![T::zero(); slots],
        }
    }

    /// All bonds of an assembly, whether they act or not, neither stretched nor turned: K = e/l₀ n nᵀ.
    pub(crate) fn at_rest(assembly: &Assembly) -> Self {
        let mut stiffness = Self::zeros(assembly.ends.len(), assembly.dimensions());
        for slot in assembly.slots() {
            let [first, second] =
                assembly.ends[slot].map(|end| assembly.positions.at(end as usize));
            let Some(direction) = (first - second).try_normalize(0.0) else {
                continue;
            };
            let root = (assembly.laws.of(slot).slope(0.0) / assembly.rest_lengths[slot]).sqrt();
            for (axial, component) in stiffness.axial.iter_mut().zip(direction.iter()) {
                if let Some(axial) = axial.get_mut(slot) {
                    *axial = T::new(root * component);
                }
            }
        }
        stiffness
    }

    /// Makes that of the bond in a slot nothing.
    pub(crate) fn clear(&mut self, slot: usize) {
        self.transverse[slot] = T::zero();
        for axial in self.axial.iter_mut().filter(|axial| !axial.is_empty()) {
            axial[slot] = T::zero();
        }
    }

    /// xx, yy, xy, zz, xz, yz of the K of the bond in a slot; compressed, of a n nᵀ (7) alone, which
    /// is positive.
    pub(crate) fn positive(&self, slot: usize) -> [T; 6] {
        let [x, y, z] = self
            .axial
            .each_ref()
            .map(|axial| axial.get(slot).copied().unwrap_or_default());
        positive_block([x, y, z], self.transverse[slot])
    }

    /// Sets `positive` to this without the transverse part of compressed bonds, which makes H
    /// indefinite: K = a n nᵀ.
    pub(crate) fn without_buckling(&self, positive: &mut Self) {
        let source = [
            &self.axial[0],
            &self.axial[1],
            &self.axial[2],
            &self.transverse,
        ];
        let [sx, sy, sz] = &mut positive.axial;
        let copies = [sx, sy, sz, &mut positive.transverse];
        for (copy, source) in copies.into_iter().zip(source) {
            copy.clear();
            copy.extend_from_slice(source);
        }
        let [sx, sy, sz] = positive.axial.each_mut().map(Vec::as_mut_slice);
        let transverse = positive.transverse.as_mut_slice();
        wide(
            #[inline(always)]
            || {
                if sz.is_empty() {
                    straighten::<T, 2>(sx, sy, &mut [], transverse);
                } else {
                    straighten::<T, 3>(sx, sy, sz, transverse);
                }
            },
        );
    }

    /// Sets `product` to H p for a nodal field p (7), which must vanish at held nodes; returns
    /// p · H p.
    pub(crate) fn multiply(
        &self,
        assembly: &Assembly,
        field: &Field<T>,
        product: &mut Field<T>,
        spill: &mut Spill<T, 3>,
        team: &Team,
    ) -> f64 {
        let field = field.components();
        spill.sum(
            &assembly.strips,
            team,
            product.components_mut(),
            (),
            |strip, (), product| {
                wide(
                    #[inline(always)]
                    || {
                        if assembly.dimensions() == 2 {
                            self.multiply_in::<2>(assembly, &strip, field, product)
                        } else {
                            self.multiply_in::<3>(assembly, &strip, field, product)
                        }
                    },
                )
            },
        )
    }

    #[inline(always)]
    fn multiply_in<const D: usize>(
        &self,
        assembly: &Assembly,
        strip: &Strip,
        field: [&[T]; 3],
        product: &mut Sums<'_, T, 3>,
    ) -> f64 {
        let mut forces: Buffer<T> = [[T::zero(); BLOCK]; 3];
        let mut scratch = [forces; 2];
        let mut work = [T::zero(); BLOCK];
        let mut curvature = 0.0;
        for blocks in assembly.blocks[strip.blocks.clone()].chunks(BLOCKS_PER_SUM) {
            for block in blocks {
                let at_ends = block.at_ends::<T, D>(&assembly.ends, &field, &mut scratch);
                let axial = self.axial.each_ref().map(
                    #[inline(always)]
                    |axial| axial.get(block.start..).unwrap_or_default(),
                );
                let transverse = &self.transverse[block.start..][..block.count];
                force::<T, D>(axial, transverse, at_ends, &mut forces, &mut work);
                block.scatter::<T, D>(&assembly.ends, &forces, product);
            }
            curvature += sum(&work);
            work = [T::zero(); BLOCK];
        }
        curvature
    }
}

/// Takes b away where it is negative and shortens s sᵀ there from a − b to a.
#[inline(always)]
fn straighten<T: Real, const D: usize>(
    sx: &mut [T],
    sy: &mut [T],
    sz: &mut [T],
    transverse: &mut [T],
) {
    let count = transverse.len();
    let (sx, sy) = (&mut sx[..count], &mut sy[..count]);
    let sz = if D == 3 { &mut sz[..count] } else { sz };
    for bond in 0..count {
        let b = transverse[bond];
        let mut square = sx[bond] * sx[bond] + sy[bond] * sy[bond];
        if D == 3 {
            square += sz[bond] * sz[bond];
        }
        let left = if b < T::zero() {
            ((square + b).max(T::zero()) / square).sqrt()
        } else {
            T::one()
        };
        sx[bond] *= left;
        sy[bond] *= left;
        if D == 3 {
            sz[bond] *= left;
        }
        transverse[bond] = b.max(T::zero());
    }
}

/// xx, yy, xy, zz, xz, yz of s sᵀ + b 1; where b is negative, of s sᵀ shortened from a − b to a.
#[inline(always)]
pub(crate) fn positive_block<T: Real>([x, y, z]: [T; 3], b: T) -> [T; 6] {
    let square = x * x + y * y + z * z;
    let left = if b < T::zero() && square > T::zero() {
        (square + b).max(T::zero()) / square
    } else {
        T::one()
    };
    let b = b.max(T::zero());
    [
        b + left * x * x,
        b + left * y * y,
        left * x * y,
        b + left * z * z,
        left * x * z,
        left * y * z,
    ]
}

/// Sets `forces` to K (p₁ − p₂) of a block's bonds, and adds (p₁ − p₂) · K (p₁ − p₂) to `work`.
#[inline(always)]
fn force<T: Real, const D: usize>(
    axial: [&[T]; 3],
    transverse: &[T],
    [first, second]: [[&[T]; 3]; 2],
    forces: &mut Buffer<T>,
    work: &mut [T; BLOCK],
) {
    let count = transverse.len();
    let [x1, y1, z1] = first.map(
        #[inline(always)]
        |values| &values[..count],
    );
    let [x2, y2, z2] = second.map(
        #[inline(always)]
        |values| &values[..count],
    );
    let [fx, fy, fz] = forces.each_mut().map(
        #[inline(always)]
        |forces| &mut forces[..count],
    );
    let work = &mut work[..count];
    let (sx, sy) = (&axial[0][..count], &axial[1][..count]);
    let sz = if D == 3 { &axial[2][..count] } else { sx };
    for bond in 0..count {
        let x = x1[bond] - x2[bond];
        let y = y1[bond] - y2[bond];
        let b = transverse[bond];
        let mut along = sy[bond].mul_add(y, sx[bond] * x);
        let mut across = y.mul_add(y, x * x);
        if D == 3 {
            let z = z1[bond] - z2[bond];
            along = sz[bond].mul_add(z, along);
            across = z.mul_add(z, across);
            fz[bond] = sz[bond].mul_add(along, b * z);
        }
        fx[bond] = sx[bond].mul_add(along, b * x);
        fy[bond] = sy[bond].mul_add(along, b * y);
        work[bond] += along.mul_add(along, b * across);
    }
}
