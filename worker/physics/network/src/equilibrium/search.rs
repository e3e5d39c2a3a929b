//! What a search for equilibrium is told, and what it comes to.
use nalgebra::Matrix3;

use crate::{
    assembly::Assembly,
    configuration::{Configuration, Residual, Verdict},
};

/// The way to equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    NewtonCg,
    Sequential,
    /// ω, the part of its own step a node moves.
    Parallel {
        relaxation_factor: f64,
    },
    Descent(Descent),
}

/// A descent of the magnitude of each node's resultant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Descent {
    pub(crate) gradient: Gradient,
    /// α [mm²/N] of the first move, and of all where it is not adaptive; `None` for the largest that
    /// leaves no more than the limit.
    pub(crate) step: Option<f64>,
    /// Whether later steps are those of Barzilai and Borwein.
    pub(crate) is_adaptive: bool,
}

/// The gradient of the magnitude of a resultant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gradient {
    Exact,
    /// As [Zilka2022] has it: of the sum of the bonds' tensions.
    Printed,
    /// Of a spline through values so far apart [mm].
    Smoothed {
        spacing: f64,
    },
}

/// A method and where it ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    pub(crate) method: Method,
    /// Sweeps or Newton iterations.
    pub(crate) iteration_limit: u32,
    /// F_lim [N], (8).
    pub(crate) force_limit: f64,
    /// Farthest a node may move at once [mm].
    pub(crate) step_cap: f64,
    /// [`calm`](super::calm).
    pub(crate) calm: f64,
}

/// Where a search ended.
#[derive(Debug)]
pub(crate) struct Settled {
    pub(crate) configuration: Configuration,
    pub(crate) residual: Residual,
}

impl Settled {
    /// The first free node that equilibrium holds although the energy falls when it alone moves: bonds
    /// that push along one line, say, until something moves them off it. None where the assembly is
    /// not in equilibrium, or where what pushes is within `force_limit` [N].
    ///
    /// A node's own stiffness is Σ (a − b) n⊗n + (Σ b) 1 over its bonds (7), where no a − b is negative: it
    /// curves down only where Σ b is, which in a net that is pulled hardly a node has. Parts that buckle
    /// only as a whole are not seen.
    pub(crate) fn unstable(&self, assembly: &Assembly, force_limit: f64) -> Option<usize> {
        if self.residual.verdict == Verdict::Unbalanced {
            return None;
        }
        let transverse = &self.configuration.stiffness.transverse;
        let is_pushed = |node: &usize| {
            let bonds = assembly.incidence().of(*node).iter();
            bonds.map(|bond| transverse[*bond as usize]).sum::<f32>() < 0.0
        };
        let mut pushed = assembly.free().filter(is_pushed);
        let found = pushed.find(|node| self.falls(assembly, force_limit, *node));
        found.map(|node| assembly.node(node))
    }

    /// Whether moving a free node by the length of a bond that pushes it sets free more than
    /// `force_limit`.
    fn falls(&self, assembly: &Assembly, force_limit: f64, node: usize) -> bool {
        // along its guide it may be held
        if assembly.guide_of(node).is_some() {
            return false;
        }
        let (mut stiffness, mut reach) = (Matrix3::zeros(), 0.0_f64);
        for bond in assembly.incidence().of(node) {
            let state = self.configuration.bond(assembly, *bond as usize);
            let along = state.direction * state.direction.transpose();
            stiffness += (state.axial - state.transverse) * along;
            stiffness += state.transverse * Matrix3::identity();
            if state.transverse < 0.0 {
                reach = reach.max(state.tension / state.transverse);
            }
        }
        // a plane network does not leave its plane
        let least = match assembly.dimensions() {
            2 => {
                let in_plane = stiffness.fixed_view::<2, 2>(0, 0).into_owned();
                in_plane.symmetric_eigenvalues().min()
            }
            _ => stiffness.symmetric_eigenvalues().min(),
        };
        -least * reach > force_limit
    }

    /// The free node that keeps an unbalanced assembly from equilibrium although nothing resists
    /// its motion along its resultant: it belongs to a mechanism, or buckles.
    pub(crate) fn mechanism(&self, assembly: &Assembly) -> Option<usize> {
        /// Stiffness along the resultant below which a node counts as unresisted, relative to the
        /// stiffness of its stiffest bond.
        const UNRESISTED: f64 = 1e-9;
        if self.residual.verdict != Verdict::Unbalanced {
            return None;
        }
        let node = self.residual.node;
        let along = self.configuration.resultants.at(node).normalize();
        let (mut resistance, mut stiffest) = (0.0, 0.0_f64);
        for bond in assembly.incidence().of(node) {
            let state = self.configuration.bond(assembly, *bond as usize);
            let square = state.direction.dot(&along).powi(2);
            resistance += state.axial * square + state.transverse * (1.0 - square);
            stiffest = stiffest.max(state.axial);
        }
        (resistance <= UNRESISTED * stiffest).then(|| assembly.node(node))
    }
}
