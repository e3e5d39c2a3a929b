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
use loadframe_numerics::Team;

use super::super::error::FrameError;
use super::bodies::Bodies;
use super::chains::Chains;
use super::operator::{Nodal, Operator};

/// ω. A sheet of 28 000 nodes took 109 iterations with 0.5, 89 with 0.9.
const SHARE: f64 = 0.9;

/// The preconditioner of what is active of a network.
#[derive(Debug)]
pub(super) struct Cycle<const M: usize> {
    chains: Chains<M>,
    bodies: Bodies,
    left: Nodal<M>,
}

impl<const M: usize> Cycle<M> {
    /// Factors fibres and bodies.
    ///
    /// # Errors
    /// [`FrameError`] when a fibre has no factor, or that of bodies does not fit into memory.
    pub(super) fn new(operator: &Operator<'_, M>, team: &Team) -> Result<Self, FrameError> {
        Ok(Self {
            chains: Chains::new(operator, team)?,
            bodies: Bodies::new(operator)?,
            left: vec![[0.0; M]; operator.network.fibre_nodes()],
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
        operator: &mut Operator<'_, M>,
        team: &Team,
        right: &[[f64; M]],
        solution: &mut [[f64; M]],
    ) -> f64 {
        solution.fill([0.0; M]);
        self.chains
            .add(operator, team, SHARE, [right, right], solution);
        operator.lack(team, solution, right, &mut self.left);
        self.bodies.add(operator, team, &self.left, solution);
        operator.lack(team, solution, right, &mut self.left);
        self.chains
            .add(operator, team, SHARE, [&self.left, right], solution)
    }
}
