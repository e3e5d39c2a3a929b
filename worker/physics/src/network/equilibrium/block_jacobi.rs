//! Preconditioner of the conjugate gradients: the inverse of each node's own stiffness.
use crate::{
    network::{Vector, assembly::Assembly, configuration::Configuration},
    parallel::ordered_sum,
};

/// Inverse 3 x 3 blocks, one per free node.
#[derive(Debug)]
pub(super) struct BlockJacobi {
    inverses: Vec<Symmetric>,
    /// Mean over the directions of what the blocks multiply, summed over the nodes [mm/N].
    compliance: f64,
}

/// A symmetric 3 x 3 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Symmetric {
    xx: f64,
    yy: f64,
    zz: f64,
    xy: f64,
    xz: f64,
    yz: f64,
}

/// Part of its trace added to a block's diagonal. Without it a node on nearly parallel bonds, such
/// as a dangling one, is thrown far aside by a tiny force; with much more the block is no longer
/// the node's stiffness and iterations grow.
const TRACE_SHARE: f64 = 0.02;

impl BlockJacobi {
    /// From the bond states, without the transverse part of bonds in compression, so that every
    /// block is positive.
    pub(super) fn new(assembly: &Assembly, configuration: &Configuration) -> Self {
        let mut blocks = vec![Symmetric::default(); assembly.nodes()];
        for (state, [first, second]) in configuration.bonds.iter().zip(&assembly.ends) {
            let transverse = state.transverse.max(0.0);
            let stiffness = Symmetric::bond(&state.direction, state.axial - transverse, transverse);
            blocks[*first as usize].add(&stiffness);
            blocks[*second as usize].add(&stiffness);
        }
        blocks.truncate(assembly.free());
        let mut compliance = 0.0;
        for block in &mut blocks {
            *block = block.inverse();
            compliance += block.trace() / 3.0;
        }
        Self {
            inverses: blocks,
            compliance,
        }
    }

    /// The preconditioned force on a node: about the displacement that relieves it.
    #[inline]
    pub(super) fn apply(&self, node: usize, force: &Vector) -> Vector {
        self.inverses[node].times(force)
    }

    /// The squared preconditioned norm of the free nodes' `forces`.
    pub(super) fn norm(&self, forces: &[Vector]) -> f64 {
        ordered_sum(forces.len(), |node| {
            forces[node].dot(&self.apply(node, &forces[node]))
        })
    }

    /// The squared preconditioned norm of a residual with magnitude `force` at every node.
    pub(super) fn uniform_norm(&self, force: f64) -> f64 {
        self.compliance * force * force
    }
}

impl Symmetric {
    /// `along` n nᵀ + `all` 1.
    fn bond(direction: &Vector, along: f64, all: f64) -> Self {
        let scaled = direction * along;
        Self {
            xx: scaled.x * direction.x + all,
            yy: scaled.y * direction.y + all,
            zz: scaled.z * direction.z + all,
            xy: scaled.x * direction.y,
            xz: scaled.x * direction.z,
            yz: scaled.y * direction.z,
        }
    }

    fn add(&mut self, other: &Self) {
        self.xx += other.xx;
        self.yy += other.yy;
        self.zz += other.zz;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yz += other.yz;
    }

    fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// The inverse after the diagonal was raised; zero for a block without stiffness, so that the
    /// node stays put. Entries that vanish by symmetry stay exactly zero: flat networks stay flat.
    fn inverse(&self) -> Self {
        let floor = TRACE_SHARE * self.trace();
        let (xx, yy, zz) = (self.xx + floor, self.yy + floor, self.zz + floor);
        let (xy, xz, yz) = (self.xy, self.xz, self.yz);
        let minors = [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy];
        let determinant = xx * minors[0] + xy * minors[1] + xz * minors[2];
        if !determinant.is_normal() {
            return Self::default();
        }
        let scale = 1.0 / determinant;
        Self {
            xx: minors[0] * scale,
            xy: minors[1] * scale,
            xz: minors[2] * scale,
            yy: (xx * zz - xz * xz) * scale,
            zz: (xx * yy - xy * xy) * scale,
            yz: (xy * xz - xx * yz) * scale,
        }
    }

    #[inline]
    fn times(&self, vector: &Vector) -> Vector {
        Vector::new(
            self.xx * vector.x + self.xy * vector.y + self.xz * vector.z,
            self.xy * vector.x + self.yy * vector.y + self.yz * vector.z,
            self.xz * vector.x + self.yz * vector.y + self.zz * vector.z,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes_the_raised_block() {
        let along = Vector::new(1.0, 2.0, -0.5).normalize();
        let block = Symmetric::bond(&along, 3.0, 0.1);
        let vector = Vector::new(0.3, -0.7, 0.2);
        let raised = block.times(&vector) + vector * (TRACE_SHARE * block.trace());
        // condition number about 20, so a few tens of roundings
        assert!((block.inverse().times(&raised) - vector).norm() < 1e-14);
    }

    #[test]
    fn a_node_without_stiffness_stays_put() {
        assert_eq!(Symmetric::default().inverse(), Symmetric::default());
    }

    #[test]
    fn a_flat_block_keeps_flat_forces_flat() {
        let block = Symmetric::bond(&Vector::new(0.6, 0.8, 0.0), 3.0, 0.1);
        let moved = block.inverse().times(&Vector::new(0.3, -0.7, 0.0));
        assert_eq!(moved.z.to_bits(), 0.0_f64.to_bits());
    }
}
