//! The move of a single node towards its own balance, which both relaxations are made of.
use crate::network::{Vector, assembly::Assembly, incidence::Incidence};

/// A node as its bonds see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeStep {
    /// Whether its resultant is within the limit, or within round-off.
    pub(super) is_balanced: bool,
    /// Displacement along its resultant that would balance it if its stiffness were constant [mm].
    pub(super) step: Vector,
    /// Bonds looked at.
    pub(super) bonds: usize,
}

/// Least stiffness along the resultant, relative to the sum of the axial stiffnesses of the node's
/// bonds: a node nothing resists would be thrown to infinity.
const LEAST_STIFFNESS: f64 = 0.02;

/// One step of Newton's method on the line through the node along its resultant R (6): R/k with
/// the stiffness along it k = Σ a c² + b⁺ (1 − c²) (9), where c is the cosine between bond and
/// resultant and b⁺ is the transverse stiffness of bonds under tension only. No step is longer than
/// `cap`.
///
/// Source: [Zilka2022] section 1.2.4 asks for a move along the resultant and leaves its length
/// open; the length is ours.
pub(super) fn node_step(
    assembly: &Assembly,
    incidence: &Incidence,
    displacements: &[Vector],
    node: usize,
    force_limit: f64,
    cap: f64,
) -> NodeStep {
    let bonds = incidence.of(node);
    let mut resultant = Vector::zeros();
    // Σ (a − b⁺) n nᵀ is kept as a matrix, because the resultant is known only afterwards
    let mut directed = nalgebra::Matrix3::zeros();
    let (mut transverse, mut axial, mut rounding) = (0.0, 0.0, 0.0);
    for bond in bonds {
        let bond = *bond as usize;
        let [first, second] = assembly.ends[bond].map(|node| node as usize);
        let shift = assembly.shift(bond, displacements);
        let (state, _) = assembly.shapes[bond].respond(&shift);
        let force = state.direction * state.tension;
        if first == node {
            resultant += force;
        } else {
            resultant -= force;
        }
        let resisting = state.transverse.max(0.0);
        directed += state.direction * state.direction.transpose() * (state.axial - resisting);
        transverse += resisting;
        axial += state.axial;
        rounding += state.round_off(displacements[first].amax() + displacements[second].amax());
    }
    let magnitude = resultant.norm();
    // a resultant that is not a number ends the search; whoever started it will find it
    let is_balanced = magnitude.is_nan() || magnitude <= force_limit.max(rounding);
    let mut step = Vector::zeros();
    if !is_balanced {
        let along = resultant / magnitude;
        let stiffness = along.dot(&(directed * along)) + transverse;
        let length = magnitude / stiffness.max(LEAST_STIFFNESS * axial);
        step = along * length.min(cap);
    }
    NodeStep {
        is_balanced,
        step,
        bonds: bonds.len(),
    }
}
