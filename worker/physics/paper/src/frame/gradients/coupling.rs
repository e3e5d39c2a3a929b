//! What bonds do to a fibre by the motion of the other: the network's matrix less that of fibres by themselves.
//!
//! With D the matrix of fibres whose bonds are held at their other ends, K = D - C: a bond of stiffness k
//! has k of its own point's motion in D and k of the other's in C. So a residual after a
//! step of D needs C alone, r - K D⁻¹ r = C D⁻¹ r, without any segment.
use std::ops::Range;

use loadframe_numerics::Team;

use super::operator::{Operator, slices};
use super::points::Points;
use super::scalar::Scalar;

/// C, in the numbers of the preconditioner.
#[derive(Debug)]
pub(super) struct Coupling<T, const M: usize> {
    points: Points<T, M>,
}

impl<T: Scalar, const M: usize> Coupling<T, M> {
    pub(super) fn new(operator: &Operator<'_, M>) -> Self {
        let points = operator.points();
        let ties = (0..points.len()).map(|at| (points.tie(at).rounded(T::of), points.other(at)));
        let mut coupling = Self {
            points: Points::new(ties),
        };
        for at in 0..points.len() {
            coupling.copy(operator, at);
        }
        coupling
    }

    /// Takes over what changed of the points on a fibre.
    pub(super) fn copy_again(&mut self, operator: &Operator<'_, M>, fibre: usize) {
        for at in operator.places(fibre) {
            self.copy(operator, at);
        }
    }

    fn copy(&mut self, operator: &Operator<'_, M>, at: usize) {
        let points = operator.points();
        self.points.set_tie(at, points.tie(at).rounded(T::of));
        let stiffness = points.stiffness(at).map(T::of);
        self.points.set_stiffness(at, stiffness);
    }

    /// Adds C z at nodes that are free.
    pub(super) fn add(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        motion: &[[T; M]],
        to: &mut [[T; M]],
    ) {
        self.points.follow(team, motion);
        let (network, points) = (operator.network, &self.points);
        let work = |(fibres, own): (Range<usize>, &mut [[T; M]])| {
            let start = network.nodes_of(fibres.start).start;
            for at in operator.places_of(fibres) {
                if let Some(load) = points.pulled(at) {
                    points.add(at, &load, own, start as u32);
                }
            }
            for (own, is_free) in own.iter_mut().zip(&operator.is_free[start..]) {
                if !is_free {
                    *own = [T::zero(); M];
                }
            }
        };
        team.map(slices(network, operator.pieces(), to), work);
    }
}
