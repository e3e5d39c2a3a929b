//! What conjugate gradients are preconditioned by: fibres, then bodies, then fibres again.
//!
//! With the matrix D of fibres by themselves ([`Chains`]) and the motions Q of rigid groups ([`Bodies`])
//! a residual r makes
//!
//! z₁ = ω D⁻¹ r, z₂ = z₁ + Q (r - K z₁), z = z₂ + ω D⁻¹ (r - K z₂),
//!
//! a symmetric cycle of two levels [Notay2010]. A bond of stiffness k holds each of its two fibres with
//! k in D, and k (a - b)² ≤ 2 k a² + 2 k b²: K ≤ 2 D, whatever the network. So z is that of a symmetric
//! positive matrix for each ω below 1 and each Q that moves too little rather than too much.
//!
//! K itself is not needed: with K = D - C ([`Coupling`]) and y = Q s the same is
//!
//! s = (1 - ω) r + C z₁, z = z₁ + (1 - ω) y + ω D⁻¹ (s + C y).
use std::ops::Range;

use loadframe_numerics::Team;

use super::super::error::FrameError;
use super::bodies::Bodies;
use super::chains::Chains;
use super::coupling::Coupling;
use super::operator::{Operator, slices};
use super::scalar::Scalar;

/// ω. A sheet of 28 000 nodes took 109 iterations with 0.5, 89 with 0.9.
const SHARE: f64 = 0.9;

/// The preconditioner of what is active of a network.
#[derive(Debug)]
pub(super) struct Cycle<T, const M: usize> {
    chains: Chains<T, M>,
    coupling: Coupling<T, M>,
    bodies: Bodies,
    /// z₁, y, and s.
    moved: Vec<[T; M]>,
    carried: Vec<[T; M]>,
    left: Vec<[T; M]>,
}

impl<T: Scalar, const M: usize> Cycle<T, M> {
    /// Factors fibres and bodies.
    ///
    /// # Errors
    /// [`FrameError`] when a fibre has no factor, or that of bodies does not fit into memory.
    pub(super) fn new(operator: &Operator<'_, M>, team: &Team) -> Result<Self, FrameError> {
        let none = || vec![[T::zero(); M]; operator.network.fibre_nodes()];
        Ok(Self {
            chains: Chains::new(operator, team)?,
            coupling: Coupling::new(operator),
            bodies: Bodies::new(operator)?,
            moved: none(),
            carried: none(),
            left: none(),
        })
    }

    /// Factors a fibre again, of which something broke.
    ///
    /// # Errors
    /// [`FrameError`] when it has no factor.
    pub(super) fn factor_again(
        &mut self,
        operator: &Operator<'_, M>,
        fibre: usize,
    ) -> Result<(), FrameError> {
        self.coupling.copy_again(operator, fibre);
        self.chains.factor_again(operator, fibre)
    }

    /// Makes groups and their factor anew.
    ///
    /// # Errors
    /// As [`Cycle::new`].
    pub(super) fn renew(&mut self, operator: &Operator<'_, M>) -> Result<(), FrameError> {
        self.bodies = Bodies::new(operator)?;
        Ok(())
    }

    /// Unknowns of the factor of bodies and the numbers it stores.
    pub(super) fn size(&self) -> [usize; 2] {
        self.bodies.size()
    }

    /// The motions z that forces r lead to; gives r·z.
    pub(super) fn solve(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[f64; M]],
        solution: &mut [[f64; M]],
    ) -> f64 {
        let Self {
            chains,
            coupling,
            bodies,
            moved,
            carried,
            left,
        } = self;
        let (network, share) = (operator.network, T::of(SHARE));
        let rest = T::of(1.0 - SHARE);
        let pieces = operator.pieces();
        let first = slices(network, pieces, moved);
        let first = first.into_iter().zip(slices(network, pieces, left));
        let work = |((fibres, moved), (_, left)): (Piece<'_, T, M>, Piece<'_, T, M>)| {
            let start = network.nodes_of(fibres.start).start;
            for (left, right) in left.iter_mut().zip(&right[start..]) {
                *left = right.map(T::of);
            }
            for fibre in fibres {
                let nodes = network.nodes_of(fibre);
                let own = nodes.start - start..nodes.end - start;
                chains.substitute(nodes.start, &left[own.clone()], &mut moved[own]);
            }
            for (moved, left) in moved.iter_mut().zip(left) {
                for (moved, left) in moved.iter_mut().zip(left) {
                    *moved *= share;
                    *left *= rest;
                }
            }
        };
        team.map(first.collect(), work);
        coupling.add(operator, team, moved, left);
        bodies.move_by(operator, team, left, carried);
        coupling.add(operator, team, carried, left);

        let (moved, carried, left) = (&*moved, &*carried, &*left);
        let work = |(fibres, own): (Range<usize>, &mut [[f64; M]])| {
            let mut sum = 0.0;
            let start = network.nodes_of(fibres.start).start;
            let mut again = Vec::new();
            for fibre in fibres {
                let nodes = network.nodes_of(fibre);
                again.resize(nodes.len(), [T::zero(); M]);
                chains.substitute(nodes.start, &left[nodes.clone()], &mut again);
                for (node, again) in nodes.zip(&again) {
                    let own = &mut own[node - start];
                    for motion in 0..M {
                        let with_bodies = moved[node][motion] + rest * carried[node][motion];
                        let value = (with_bodies + share * again[motion]).wide();
                        own[motion] = value;
                        sum += value * right[node][motion];
                    }
                }
            }
            sum
        };
        let pieces = slices(network, pieces, solution);
        team.map(pieces, work).into_iter().sum()
    }
}

/// Fibres, and something of each of their nodes.
type Piece<'a, T, const M: usize> = (Range<usize>, &'a mut [[T; M]]);
