//! Fibres by themselves: the blocks of their nodes, which are a chain, factored and solved.
//!
//! A fibre's own matrix is that of its segments and of its bonds as if their other ends were held. It is
//! block tridiagonal, for a point between nodes moves with neighbours: D₁ = A₁₁, Lᵢ = Aᵢ,ᵢ₋₁ Dᵢ₋₁⁻¹,
//! Dᵢ = Aᵢᵢ - Lᵢ Aᵢ,ᵢ₋₁ᵀ.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::{SMatrix, SVector, Vector3};

use super::super::element::{Ends, PARTS};
use super::super::error::FrameError;
use super::operator::{Operator, slices};
use super::scalar::Scalar;

/// What raises the diagonal of bars, as a share of what is left of it.
const RAISED: f64 = 1e-8;

/// Dᵢ⁻¹ and Lᵢ of a node.
#[derive(Debug, Clone, Copy)]
struct Block<T, const M: usize> {
    inverse: SMatrix<T, M, M>,
    link: SMatrix<T, M, M>,
}

/// The factors of all fibres.
#[derive(Debug)]
pub(super) struct Chains<T, const M: usize> {
    blocks: Vec<Block<T, M>>,
}

impl<T: Scalar, const M: usize> Chains<T, M> {
    /// Factors all fibres.
    pub(super) fn new(operator: &Operator<'_, M>, team: &Team) -> Result<Self, FrameError> {
        let none = Block {
            inverse: SMatrix::zeros(),
            link: SMatrix::zeros(),
        };
        let mut blocks = vec![none; operator.network.fibre_nodes()];
        let network = operator.network;
        let work = |(fibres, own): (Range<usize>, &mut [Block<T, M>])| {
            let first = network.nodes_of(fibres.start).start;
            let mut exact = Vec::new();
            for fibre in fibres {
                let nodes = network.nodes_of(fibre);
                let own = &mut own[nodes.start - first..nodes.end - first];
                factor_to(operator, fibre, &mut exact, own)?;
            }
            Ok(())
        };
        let pieces = slices(network, operator.pieces(), &mut blocks);
        let outcomes: Vec<Result<(), FrameError>> = team.map(pieces, work);
        outcomes.into_iter().collect::<Result<(), _>>()?;
        Ok(Self { blocks })
    }

    /// Factors a fibre again.
    pub(super) fn factor_again(
        &mut self,
        operator: &Operator<'_, M>,
        fibre: usize,
    ) -> Result<(), FrameError> {
        let nodes = operator.network.nodes_of(fibre);
        factor_to(operator, fibre, &mut Vec::new(), &mut self.blocks[nodes])
    }

    /// Solves D z = r of the nodes that follow one another on fibres from `start` on.
    pub(super) fn substitute(&self, start: usize, right: &[[T; M]], own: &mut [[T; M]]) {
        substitute(&self.blocks[start..start + right.len()], right, own);
    }
}

fn substitute<T: Scalar, const M: usize>(
    blocks: &[Block<T, M>],
    right: &[[T; M]],
    own: &mut [[T; M]],
) {
    let mut before = SVector::<T, M>::zeros();
    for ((block, right), own) in blocks.iter().zip(right).zip(&mut *own) {
        before = SVector::from(*right) - block.link * before;
        *own = before.into();
    }
    let mut after = SVector::<T, M>::zeros();
    let mut link: Option<&SMatrix<T, M, M>> = None;
    for (block, own) in blocks.iter().zip(own).rev() {
        let mut value = block.inverse * SVector::from(*own);
        if let Some(link) = link {
            value -= link.tr_mul(&after);
        }
        *own = value.into();
        after = value;
        link = Some(&block.link);
    }
}

/// Factors a fibre in double precision, and rounds.
fn factor_to<T: Scalar, const M: usize>(
    operator: &Operator<'_, M>,
    fibre: usize,
    exact: &mut Vec<Block<f64, M>>,
    own: &mut [Block<T, M>],
) -> Result<(), FrameError> {
    let none = Block {
        inverse: SMatrix::zeros(),
        link: SMatrix::zeros(),
    };
    exact.clear();
    exact.resize(own.len(), none);
    factor(operator, fibre, exact)?;
    for (own, exact) in own.iter_mut().zip(exact) {
        own.inverse = exact.inverse.map(T::of);
        own.link = exact.link.map(T::of);
    }
    Ok(())
}

fn factor<const M: usize>(
    operator: &Operator<'_, M>,
    fibre: usize,
    blocks: &mut [Block<f64, M>],
) -> Result<(), FrameError> {
    let network = operator.network;
    let nodes = network.nodes_of(fibre);
    let first = nodes.start as u32;
    // the blocks of the matrix first, in the places of their factors
    let segment = network.first_segment(fibre);
    for index in segment..segment + nodes.len() - 1 {
        if operator.is_active[index] {
            let element = &network.elements()[index];
            let at = (element.nodes[0] - first) as usize;
            for part in 0..PARTS {
                if element.stiffness[part] > 0.0 {
                    add(
                        blocks,
                        [at, at + 1],
                        element.stiffness[part],
                        &element.part(part),
                    );
                }
            }
        }
    }
    for at in operator.places(fibre) {
        let [force, moment] = operator.points().stiffness(at);
        if force > 0.0 {
            let tie = operator.points().tie(at);
            let at = tie.nodes.map(|node| (node - first) as usize);
            for axis in 0..3 {
                let mut unit = Vector3::zeros();
                unit[axis] = 1.0;
                add(blocks, at, force, &tie.spread([unit, Vector3::zeros()]));
                if M > 3 {
                    add(blocks, at, moment, &tie.spread([Vector3::zeros(), unit]));
                }
            }
        }
    }
    for at in 0..blocks.len() {
        let node = nodes.start + at;
        let is_free = operator.is_free[node];
        let is_linked = at > 0 && is_free && operator.is_free[node - 1];
        if !is_free {
            blocks[at].inverse = SMatrix::identity();
        }
        if is_linked {
            let beside = blocks[at].link;
            let link = beside * blocks[at - 1].inverse;
            blocks[at].inverse -= link * beside.transpose();
            blocks[at].link = link;
        } else {
            blocks[at].link = SMatrix::zeros();
        }
        // what bars leave loose is held by less than round-off leaves of a difference
        let raised = RAISED * blocks[at].inverse.trace().abs();
        for motion in 0..M {
            blocks[at].inverse[(motion, motion)] += if M > 3 { 0.0 } else { raised };
        }
        let Some(cholesky) = blocks[at].inverse.cholesky() else {
            let [x, y, z] = network.position_um(node);
            return Err(FrameError::GivesWay { node, x, y, z });
        };
        blocks[at].inverse = cholesky.inverse();
    }
    Ok(())
}

/// Adds c b bᵀ of two neighbours, or of one node twice named, whose second part then is nil.
fn add<const M: usize>(blocks: &mut [Block<f64, M>], at: [usize; 2], stiffness: f64, ends: &Ends) {
    let of =
        |end: usize| SVector::<f64, M>::from_fn(|motion, _| ends[2 * end + motion / 3][motion % 3]);
    let [own, other] = [of(0), of(1)];
    blocks[at[0]].inverse += own * own.transpose() * stiffness;
    if at[1] != at[0] {
        blocks[at[1]].inverse += other * other.transpose() * stiffness;
        blocks[at[1]].link += other * own.transpose() * stiffness;
    }
}
