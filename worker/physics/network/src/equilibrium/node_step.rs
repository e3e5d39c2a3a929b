//! The move of a single node towards its own balance, which both relaxations are made of.
use crate::{
    Vector,
    assembly::{Assembly, BondState},
    incidence::Incidence,
};

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
    let mut rounding = 0.0;
    for bond in bonds {
        let state = bond_state(assembly, displacements, *bond);
        let [first, second] = assembly.ends[*bond as usize].map(|node| node as usize);
        let force = state.direction * state.tension;
        if first == node {
            resultant += force;
        } else {
            resultant -= force;
        }
        rounding += state.round_off(displacements[first].amax() + displacements[second].amax());
    }
    let resultant = assembly.free_part(node, resultant);
    let magnitude = resultant.norm();
    // a resultant that is not a number ends the search; whoever started it will find it
    if magnitude.is_nan() || magnitude <= force_limit.max(rounding) {
        return NodeStep {
            is_balanced: true,
            step: Vector::zeros(),
            bonds: bonds.len(),
        };
    }
    // most visits end above, so the states are worth computing again
    let along = resultant / magnitude;
    let (mut stiffness, mut axial) = (0.0, 0.0);
    for bond in bonds {
        let state = bond_state(assembly, displacements, *bond);
        let square = state.direction.dot(&along).powi(2);
        stiffness += state.axial * square + state.transverse.max(0.0) * (1.0 - square);
        axial += state.axial;
    }
    let length = magnitude / stiffness.max(LEAST_STIFFNESS * axial);
    NodeStep {
        is_balanced: false,
        step: along * length.min(cap),
        bonds: 2 * bonds.len(),
    }
}

#[inline]
fn bond_state(assembly: &Assembly, displacements: &[Vector], bond: u32) -> BondState {
    let [first, second] = assembly.ends[bond as usize].map(|node| &displacements[node as usize]);
    assembly.respond(bond as usize, first, second)
}
