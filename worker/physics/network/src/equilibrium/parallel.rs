//! Parallel relaxation: the moves of all unbalanced nodes are computed first, then all are made.
//!
//! Each node moves only the part ω of its own step, because its neighbours move too. A balanced
//! node sleeps until a neighbour moves.
//!
//! Source: [Zilka2022] section 2.3.1, figure 8; the factor ω is ours.
use loadframe_harness::Interrupt;
use loadframe_numerics::Team;

use super::{
    Search,
    node_step::{NodeStep, node_step},
    work::Meter,
};
use crate::{Vector, assembly::Assembly};

/// Displacements of every place, near equilibrium; see [`Search::run`].
pub(super) fn solve(
    search: &Search,
    relaxation_factor: f64,
    assembly: &Assembly,
    mut displacements: Vec<Vector>,
    team: &Team,
    meter: &mut Meter<'_>,
) -> Result<Vec<Vector>, Interrupt> {
    let incidence = assembly.incidence();
    let (limit, cap) = (search.force_limit, search.step_cap);
    let mut awake: Vec<u32> = assembly.free().map(|node| node as u32).collect();
    let mut is_awake = vec![true; assembly.places()];
    let mut visits: Vec<Option<NodeStep>> = Vec::new();
    for _ in 0..search.iteration_limit {
        meter.work.sweeps += 1;
        visits.clear();
        visits.resize(awake.len(), None);
        team.fill(&mut visits, |start, visits| {
            for (visit, node) in visits.iter_mut().zip(&awake[start..]) {
                let node = *node as usize;
                *visit = Some(node_step(
                    assembly,
                    incidence,
                    &displacements,
                    node,
                    limit,
                    cap,
                ));
            }
            0.0
        });
        meter.spend(visits.iter().flatten().map(|visit| visit.bonds).sum())?;

        is_awake.fill(false);
        let mut any_moved = false;
        for (node, visit) in awake.iter().zip(visits.iter().flatten()) {
            if visit.is_balanced {
                continue;
            }
            any_moved = true;
            displacements[*node as usize] += visit.step * relaxation_factor;
            for bond in incidence.of(*node as usize) {
                // the bond's ends are the node itself and the neighbour it wakes
                for end in assembly.ends[*bond as usize] {
                    is_awake[end as usize] = true;
                }
            }
        }
        if !any_moved {
            break;
        }
        awake.clear();
        awake.extend(
            assembly
                .free()
                .map(|node| node as u32)
                .filter(|node| is_awake[*node as usize]),
        );
    }
    Ok(displacements)
}
