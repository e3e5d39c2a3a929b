//! Sequential relaxation: each node is moved into its own balance, one after another, in sweeps
//! over all nodes, until a sweep finds every node balanced.
//!
//! A node whose neighbours did not move since it was balanced is balanced still, so it is skipped;
//! this changes no result.
//!
//! Source: [Zilka2022] section 2.3, figure 7.
use loadframe_harness::Interrupt;

use super::{
    Search,
    node_step::{NodeStep, node_step},
    work::Meter,
};
use crate::{Vector, assembly::Assembly};

/// Moves of one node per visit, the thesis' `i_bodMAX`. Nodes need a few; the bound is there for
/// those that jump between the branches of the bond law.
const MOVES_PER_VISIT: usize = 50;

/// Displacements of every place, near equilibrium; see [`Search::run`].
pub(super) fn solve(
    search: &Search,
    assembly: &Assembly,
    displacements: Vec<Vector>,
    meter: &mut Meter<'_>,
) -> Result<Vec<Vector>, Interrupt> {
    let incidence = assembly.incidence();
    let (limit, cap) = (search.force_limit, search.step_cap);
    sweep(
        search,
        assembly,
        displacements,
        meter,
        |displacements, node, _| node_step(assembly, incidence, displacements, node, limit, cap),
    )
}

/// Sweeps over the nodes that are not balanced until none is left, each moved as `visit` says of all
/// displacements, a node, and how often it was moved in this visit.
pub(super) fn sweep(
    search: &Search,
    assembly: &Assembly,
    mut displacements: Vec<Vector>,
    meter: &mut Meter<'_>,
    mut visit: impl FnMut(&[Vector], usize, usize) -> NodeStep,
) -> Result<Vec<Vector>, Interrupt> {
    let incidence = assembly.incidence();
    let mut is_awake = vec![true; assembly.places()];
    for _ in 0..search.iteration_limit {
        meter.work.sweeps += 1;
        let mut any_moved = false;
        for node in assembly.free() {
            if !std::mem::take(&mut is_awake[node]) {
                continue;
            }
            let mut has_moved = false;
            for attempt in 0..=MOVES_PER_VISIT {
                let found = visit(&displacements, node, attempt);
                meter.spend(found.bonds)?;
                if found.is_balanced {
                    break;
                }
                if attempt == MOVES_PER_VISIT {
                    is_awake[node] = true;
                    break;
                }
                displacements[node] += found.step;
                has_moved = true;
            }
            if has_moved {
                any_moved = true;
                for bond in incidence.of(node) {
                    for end in assembly.ends[*bond as usize] {
                        if end as usize != node {
                            is_awake[end as usize] = true;
                        }
                    }
                }
            }
        }
        if !any_moved {
            break;
        }
    }
    Ok(displacements)
}
