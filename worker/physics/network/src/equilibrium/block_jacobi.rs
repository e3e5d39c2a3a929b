//! Preconditioner of the conjugate gradients: the inverse of each node's own stiffness.
use loadframe_numerics::{Team, wide};

use crate::{
    assembly::Assembly,
    field::{BLOCK, Real, dot, sum},
    stiffness::{Stiffness, positive_block},
    strips::{AtPlaces, Spill, Strip},
    sums::Sums,
};

/// Inverse 3 x 3 blocks, one per node; zero for nodes that are held or that nothing holds.
#[derive(Debug)]
pub(super) struct BlockJacobi<T> {
    /// xx, yy, xy, and in space zz, xz, yz.
    inverses: [Vec<T>; 6],
    /// 1 where they are not zero.
    mobility: Vec<T>,
    spill: Spill<T, 6>,
    /// Mean over the directions of what the blocks multiply, summed over the nodes [mm/N].
    compliance: f64,
    /// Stiffness of the free nodes along x and y, summed [N/mm].
    stiffness: f64,
}

/// Places of the diagonal among them.
pub(super) const DIAGONAL: [usize; 3] = [0, 1, 3];

/// Part of its trace added to a block's diagonal. Without it a node on nearly parallel bonds, such
/// as a dangling one, is thrown far aside by a tiny force; with much more the block is no longer
/// the node's stiffness and iterations grow.
const TRACE_SHARE: f64 = 0.02;

impl<T: Real> BlockJacobi<T> {
    pub(super) fn zeros(assembly: &Assembly) -> Self {
        let parts = if assembly.dimensions() == 2 { 3 } else { 6 };
        let zeros = |part| {
            let length = if part < parts { assembly.places() } else { 0 };
            vec![T::zero(); length]
        };
        Self {
            inverses: [0, 1, 2, 3, 4, 5].map(zeros),
            mobility: zeros(0),
            spill: Spill::new(&assembly.strips, parts),
            compliance: 0.0,
            stiffness: 0.0,
        }
    }

    /// Becomes that of this stiffness, without the transverse part of bonds in compression, so that
    /// every block is positive.
    pub(super) fn follow(&mut self, assembly: &Assembly, stiffness: &Stiffness<T>, team: &Team) {
        let strips = &assembly.strips;
        let is_flat = assembly.dimensions() == 2;
        let blocks = self.inverses.each_mut().map(Vec::as_mut_slice);
        self.spill
            .sum(strips, team, blocks, (), |strip, (), blocks| {
                wide(
                    #[inline(always)]
                    || {
                        if is_flat {
                            add_bonds::<T, 2>(assembly, &strip, stiffness, blocks);
                        } else {
                            add_bonds::<T, 3>(assembly, &strip, stiffness, blocks);
                        }
                    },
                );
                0.0
            });
        self.stiffness = strips.sum(team, (), |strip, ()| {
            let free = strip.within(&assembly.free());
            wide(
                #[inline(always)]
                || sum(&self.inverses[0][free.clone()]) + sum(&self.inverses[1][free.clone()]),
            )
        });
        self.leave_out(assembly);
        let blocks = AtPlaces(self.inverses.each_mut().map(Vec::as_mut_slice));
        let diagonals = strips.sum(team, blocks, |strip, AtPlaces(blocks)| {
            wide(
                #[inline(always)]
                || {
                    if is_flat {
                        invert::<T, 2>(blocks);
                    } else {
                        invert::<T, 3>(blocks);
                    }
                },
            );
            let free = strip.within(&assembly.free());
            let first = strip.places.start;
            for inverse in blocks.iter_mut().filter(|part| !part.is_empty()) {
                inverse[..free.start - first].fill(T::zero());
                inverse[free.end - first..].fill(T::zero());
            }
            DIAGONAL.map(|part| sum(blocks[part])).iter().sum()
        });
        // what was raised along a held axis
        self.leave_out(assembly);
        self.compliance = diagonals / 3.0;
        let xx = &self.inverses[0];
        for (mobility, xx) in self.mobility.iter_mut().zip(xx) {
            *mobility = T::new(f64::from(u8::from(*xx > T::zero())));
        }
    }

    /// Leaves out what blocks have along the axes in which guides hold their nodes.
    fn leave_out(&mut self, assembly: &Assembly) {
        /// The axes of each part.
        const AXES: [[usize; 2]; 6] = [[0, 0], [1, 1], [0, 1], [2, 2], [0, 2], [1, 2]];
        for (part, axes) in self.inverses.iter_mut().zip(AXES) {
            if part.is_empty() {
                continue;
            }
            for (place, held) in assembly.guided() {
                if axes.iter().any(|axis| held[*axis]) {
                    part[*place as usize] = T::zero();
                }
            }
        }
    }

    /// Sets `moved` to about the displacements that relieve `forces`, both from place `start` on
    /// and whole vectors long; returns their product.
    #[inline(always)]
    pub(super) fn apply(&self, start: usize, forces: [&[T]; 3], moved: [&mut [T]; 3]) -> f64 {
        let [fx, fy, fz] = forces;
        let [mx, my, mz] = moved;
        let count = fx.len();
        let [xx, yy, xy, zz, xz, yz] = self.inverses.each_ref().map(
            #[inline(always)]
            |part| part.get(start..).unwrap_or_default(),
        );
        let (xx, yy, xy, fy) = (&xx[..count], &yy[..count], &xy[..count], &fy[..count]);
        let (mx, my) = (&mut mx[..count], &mut my[..count]);
        if fz.is_empty() {
            for node in 0..count {
                mx[node] = xy[node].mul_add(fy[node], xx[node] * fx[node]);
                my[node] = yy[node].mul_add(fy[node], xy[node] * fx[node]);
            }
            return dot(fx, mx) + dot(fy, my);
        }
        let (zz, xz, yz) = (&zz[..count], &xz[..count], &yz[..count]);
        let (fz, mz) = (&fz[..count], &mut mz[..count]);
        for node in 0..count {
            let (x, y, z) = (fx[node], fy[node], fz[node]);
            mx[node] = xz[node].mul_add(z, xy[node].mul_add(y, xx[node] * x));
            my[node] = yz[node].mul_add(z, yy[node].mul_add(y, xy[node] * x));
            mz[node] = zz[node].mul_add(z, yz[node].mul_add(y, xz[node] * x));
        }
        dot(fx, mx) + dot(fy, my) + dot(fz, mz)
    }

    /// Stiffness of the free nodes along x and y, summed [N/mm].
    pub(super) fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// 1 at the places of nodes that move, 0 at others.
    pub(super) fn mobility(&self) -> &[T] {
        &self.mobility
    }

    /// Mean over the directions of what the blocks multiply, summed over the nodes [mm/N]: times the
    /// square of a force, the squared preconditioned norm of such a residual at every node.
    pub(super) fn compliance(&self) -> f64 {
        self.compliance
    }
}

/// Sums K = b⁺ 1 + (what is left of s sᵀ) of the bonds into the blocks of their ends.
#[inline(always)]
fn add_bonds<T: Real, const D: usize>(
    assembly: &Assembly,
    strip: &Strip,
    stiffness: &Stiffness<T>,
    blocks: &mut Sums<'_, T, 6>,
) {
    let mut parts = [[T::zero(); BLOCK]; 6];
    for block in &assembly.blocks[strip.blocks.clone()] {
        let (start, count) = (block.start, block.count);
        let [sx, sy, sz] = stiffness.axial.each_ref();
        let (sx, sy) = (&sx[start..][..count], &sy[start..][..count]);
        let sz = if D == 3 { &sz[start..][..count] } else { sx };
        let transverse = &stiffness.transverse[start..][..count];
        let [xx, yy, xy, zz, xz, yz] = parts.each_mut().map(
            #[inline(always)]
            |part| &mut part[..count],
        );
        for bond in 0..count {
            let z = if D == 3 { sz[bond] } else { T::zero() };
            let block = positive_block([sx[bond], sy[bond], z], transverse[bond]);
            (xx[bond], yy[bond], xy[bond]) = (block[0], block[1], block[2]);
            if D == 3 {
                (zz[bond], xz[bond], yz[bond]) = (block[3], block[4], block[5]);
            }
        }
        let used = if D == 3 { 6 } else { 3 };
        for (part, values) in parts.iter().enumerate().take(used) {
            block.share(&assembly.ends, values, part, blocks);
        }
    }
}

/// Inverts the blocks after their diagonals were raised; a block without stiffness becomes zero,
/// so that the node stays put.
#[inline(always)]
pub(super) fn invert<T: Real, const D: usize>(blocks: &mut [&mut [T]; 6]) {
    let [xx, yy, xy, zz, xz, yz] = blocks.each_mut().map(
        #[inline(always)]
        |part| &mut **part,
    );
    let nodes = xx.len();
    let (yy, xy) = (&mut yy[..nodes], &mut xy[..nodes]);
    let share = T::new(TRACE_SHARE);
    // scaled by the trace, so that no product of stiffnesses leaves the range of numbers
    let scale = |trace: T| {
        if trace > T::min_positive_value() {
            T::one() / trace
        } else {
            T::zero()
        }
    };
    if D == 2 {
        for node in 0..nodes {
            let scale = scale(xx[node] + yy[node]);
            let (a, b, c) = (
                xx[node] * scale + share,
                yy[node] * scale + share,
                xy[node] * scale,
            );
            let inverse = scale / (a * b - c * c);
            xx[node] = b * inverse;
            yy[node] = a * inverse;
            xy[node] = -c * inverse;
        }
        return;
    }
    let (zz, xz, yz) = (&mut zz[..nodes], &mut xz[..nodes], &mut yz[..nodes]);
    for node in 0..nodes {
        let scale = scale(xx[node] + yy[node] + zz[node]);
        let (a, b, c) = (
            xx[node] * scale + share,
            yy[node] * scale + share,
            zz[node] * scale + share,
        );
        let (d, e, f) = (xy[node] * scale, xz[node] * scale, yz[node] * scale);
        let minors = [b * c - f * f, e * f - d * c, d * f - e * b];
        let inverse = scale / (a * minors[0] + d * minors[1] + e * minors[2]);
        xx[node] = minors[0] * inverse;
        xy[node] = minors[1] * inverse;
        xz[node] = minors[2] * inverse;
        yy[node] = (a * c - e * e) * inverse;
        zz[node] = (a * b - d * d) * inverse;
        yz[node] = (d * e - a * f) * inverse;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One node with these six entries.
    fn block(entries: [f64; 6]) -> [Vec<f64>; 6] {
        entries.map(|entry| vec![entry])
    }

    #[test]
    fn the_inverse_undoes_the_raised_block() {
        let (xx, yy, xy, zz, xz, yz) = (2.0, 5.0, 0.7, 1.0, -0.3, 0.4);
        let mut blocks = block([xx, yy, xy, zz, xz, yz]);
        invert::<f64, 3>(&mut blocks.each_mut().map(Vec::as_mut_slice));
        let [ixx, iyy, ixy, izz, ixz, iyz] = blocks.map(|part| part[0]);
        let raise = TRACE_SHARE * (xx + yy + zz);
        let first_row = [
            (xx + raise) * ixx + xy * ixy + xz * ixz,
            (xx + raise) * ixy + xy * iyy + xz * iyz,
            (xx + raise) * ixz + xy * iyz + xz * izz,
        ];
        for (value, expected) in first_row.iter().zip([1.0, 0.0, 0.0]) {
            assert!((value - expected).abs() < 1e-14, "{first_row:?}");
        }
    }

    #[test]
    fn a_node_without_stiffness_stays_put() {
        let mut blocks = block([0.0; 6]);
        invert::<f64, 3>(&mut blocks.each_mut().map(Vec::as_mut_slice));
        assert_eq!(blocks, block([0.0; 6]));
        let mut flat = block([0.0; 6]);
        invert::<f64, 2>(&mut flat.each_mut().map(Vec::as_mut_slice));
        assert_eq!(flat, block([0.0; 6]));
    }

    #[test]
    fn stiffnesses_at_the_ends_of_single_precision_are_inverted() {
        for size in [1e-30_f32, 1e30] {
            let mut blocks = [1.0, 2.0, 0.1, 3.0, 0.2, 0.3].map(|entry| vec![entry * size]);
            invert::<f32, 3>(&mut blocks.each_mut().map(Vec::as_mut_slice));
            assert!(blocks.iter().all(|part| part[0].is_normal()), "{blocks:?}");
        }
    }
}
