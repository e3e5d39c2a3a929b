//! The Hessian of the energy, bond by bond, as the inner solver uses it.
use crate::wide::wide;

use super::{
    assembly::Assembly,
    blocks::{BLOCK, Buffer},
    field::{Field, Real},
};

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
    pub(crate) fn zeros(bonds: usize, dimensions: usize) -> Self {
        Self {
            axial: [0, 1, 2].map(|axis| {
                let length = if axis < dimensions { bonds } else { 0 };
                vec![T::zero(); length]
            }),
            transverse: vec![T::zero(); bonds],
        }
    }

    /// Without the transverse part of compressed bonds, which makes H indefinite: K = a n nᵀ.
    pub(crate) fn without_buckling(&self) -> Self {
        let mut positive = self.clone();
        for bond in 0..self.transverse.len() {
            let b = self.transverse[bond];
            if b >= T::zero() {
                continue;
            }
            let components = positive.axial.iter().filter_map(|axial| axial.get(bond));
            let square: T = components.map(|s| *s * *s).sum();
            let left = ((square + b).max(T::zero()) / square).sqrt();
            for axial in &mut positive.axial {
                if let Some(s) = axial.get_mut(bond) {
                    *s *= left;
                }
            }
            positive.transverse[bond] = T::zero();
        }
        positive
    }

    /// H p for a nodal field p (7), which must vanish at held nodes.
    pub(crate) fn multiply(&self, assembly: &Assembly, field: &Field<T>, product: &mut Field<T>) {
        wide(
            #[inline(always)]
            || {
                if assembly.dimensions() == 2 {
                    self.multiply_in::<2>(assembly, field, product);
                } else {
                    self.multiply_in::<3>(assembly, field, product);
                }
            },
        );
    }

    #[inline(always)]
    fn multiply_in<const D: usize>(
        &self,
        assembly: &Assembly,
        field: &Field<T>,
        product: &mut Field<T>,
    ) {
        let field = field.components();
        let mut product = product.components_mut();
        for component in &mut product {
            component.fill(T::zero());
        }
        let mut forces: Buffer<T> = [[T::zero(); BLOCK]; 3];
        let mut scratch = [forces; 2];
        for block in &assembly.blocks {
            let at_ends = block.at_ends::<T, D>(&assembly.ends, &field, &mut scratch);
            let axial = self
                .axial
                .each_ref()
                .map(|axial| axial.get(block.start..).unwrap_or_default());
            let transverse = &self.transverse[block.start..][..block.count];
            force::<T, D>(axial, transverse, at_ends, &mut forces);
            block.scatter::<T, D>(&assembly.ends, &forces, &mut product);
        }
    }
}

/// The forces K (p₁ − p₂) of a block's bonds.
#[inline(always)]
fn force<T: Real, const D: usize>(
    axial: [&[T]; 3],
    transverse: &[T],
    [first, second]: [[&[T]; 3]; 2],
    forces: &mut Buffer<T>,
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
    let (sx, sy) = (&axial[0][..count], &axial[1][..count]);
    if D == 2 {
        for bond in 0..count {
            let (x, y) = (x1[bond] - x2[bond], y1[bond] - y2[bond]);
            let along = sx[bond] * x + sy[bond] * y;
            fx[bond] = transverse[bond] * x + sx[bond] * along;
            fy[bond] = transverse[bond] * y + sy[bond] * along;
        }
        return;
    }
    let sz = &axial[2][..count];
    for bond in 0..count {
        let (x, y, z) = (
            x1[bond] - x2[bond],
            y1[bond] - y2[bond],
            z1[bond] - z2[bond],
        );
        let along = sx[bond] * x + sy[bond] * y + sz[bond] * z;
        fx[bond] = transverse[bond] * x + sx[bond] * along;
        fy[bond] = transverse[bond] * y + sy[bond] * along;
        fz[bond] = transverse[bond] * z + sz[bond] * along;
    }
}
