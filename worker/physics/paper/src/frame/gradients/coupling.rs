//! What bonds do to a fibre by the motion of the other: the network's matrix less that of fibres by themselves.
//!
//! With D the matrix of fibres whose bonds are held at their other ends, K = D - C: a bond of stiffness k
//! has k of its own point's motion in D and k of the other's in C. So a residual after a
//! step of D needs C alone, r - K D⁻¹ r = C D⁻¹ r, without any segment.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::Vector3;

use super::super::tie::Tie;
use super::operator::{Operator, add_spread, ends_of, slices};
use super::scalar::Scalar;

/// A point of a bond, with the stiffness of this.
#[derive(Debug, Clone, Copy)]
struct Point<T> {
    tie: Tie<T>,
    other: u32,
    stiffness: [T; 2],
}

/// C, in the numbers of the preconditioner.
#[derive(Debug)]
pub(super) struct Coupling<T> {
    points: Vec<Point<T>>,
    moved: Vec<[Vector3<T>; 2]>,
}

impl<T: Scalar> Coupling<T> {
    pub(super) fn new<const M: usize>(operator: &Operator<'_, M>) -> Self {
        let points: Vec<Point<T>> = operator.points().iter().map(rounded).collect();
        let moved = vec![[Vector3::zeros(); 2]; points.len()];
        Self { points, moved }
    }

    /// Takes over what changed of the points on a fibre.
    pub(super) fn copy_again<const M: usize>(&mut self, operator: &Operator<'_, M>, fibre: usize) {
        for at in operator.places(fibre) {
            self.points[at] = rounded(&operator.points()[at]);
        }
    }

    /// Adds C z at nodes that are free.
    pub(super) fn add<const M: usize>(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        motion: &[[T; M]],
        to: &mut [[T; M]],
    ) {
        let points = &self.points;
        team.fill(&mut self.moved, |start, moved| {
            for (point, moved) in points[start..].iter().zip(moved) {
                *moved = point.tie.motion(&ends_of(motion, point.tie.nodes));
            }
            0.0
        });
        let (network, moved) = (operator.network, &self.moved);
        let work = |(fibres, own): (Range<usize>, &mut [[T; M]])| {
            let start = network.nodes_of(fibres.start).start;
            for fibre in fibres {
                for point in &points[operator.places(fibre)] {
                    let [force, moment] = point.stiffness;
                    if force > T::zero() {
                        let [shift, turn] = moved[point.other as usize];
                        let loads = [shift * force, turn * moment];
                        add_spread(own, start as u32, &point.tie, loads);
                    }
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

fn rounded<T: Scalar>(point: &super::operator::Point) -> Point<T> {
    Point {
        tie: point.tie.rounded(T::of),
        other: point.other,
        stiffness: point.stiffness.map(T::of),
    }
}
