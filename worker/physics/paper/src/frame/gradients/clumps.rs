//! Clumps of nodes that hang together, as rigid bodies, each by itself.
//!
//! Between single fibres and the cells of the grid lie groups of fibres that bonds make stiff and that as
//! a whole are held softly: ends of fibres that are bonded to one another, a layer beside the next. A clump
//! is a node with all its neighbours that belong to no other yet; the next level joins clumps in
//! the same way [VanekMandelBrezina1996]. A clump's six rigid motions X: t + ω × (X - centre) meet the
//! stiffness of the elements at its border, for those inside do not feel them.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::{Matrix6, Vector3, Vector6};

use super::super::element::{Element, Ends, PARTS};
use super::super::network::Network;
use super::operator::{Nodal, Operator, dot, parts, slices};

/// How often clumps are joined: about 4, 16 and 64 nodes.
const LEVELS: usize = 3;
/// What raises the diagonal of a clump, as a share of it: motions that nothing resists.
const RAISED: f64 = 1e-9;
/// Not in any clump.
const NONE: u32 = u32::MAX;

/// One level of clumps.
#[derive(Debug)]
struct Level {
    /// Clump of each node.
    of_node: Vec<u32>,
    /// Nodes of each clump: `nodes[first[clump]..first[clump + 1]]`.
    first: Vec<u32>,
    nodes: Vec<u32>,
    centres: Vec<Vector3<f64>>,
    inverses: Vec<Matrix6<f64>>,
    motions: Vec<[Vector3<f64>; 2]>,
}

/// All levels.
#[derive(Debug)]
pub(super) struct Clumps {
    levels: Vec<Level>,
}

impl Clumps {
    pub(super) fn new<const M: usize>(operator: &Operator<'_, M>) -> Self {
        let network = operator.network;
        let nodes = network.fibre_nodes();
        let mut of_node: Vec<u32> = (0..nodes as u32)
            .map(|node| {
                if operator.is_free[node as usize] {
                    node
                } else {
                    NONE
                }
            })
            .collect();
        let mut count = nodes;
        let mut levels = Vec::with_capacity(LEVELS);
        for _ in 0..LEVELS {
            let joined = join(count, pairs(operator, &of_node));
            for clump in &mut of_node {
                if *clump != NONE {
                    *clump = joined.0[*clump as usize];
                }
            }
            count = joined.1;
            levels.push(Level::new(operator, of_node.clone(), count));
        }
        Self { levels }
    }

    /// The motions of clumps that forces on the nodes lead to.
    pub(super) fn solve<const M: usize>(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[f64; M]],
    ) {
        let positions = operator.network.positions();
        for level in &mut self.levels {
            let Level {
                first,
                nodes,
                centres,
                inverses,
                motions,
                ..
            } = level;
            team.fill(motions, |start, motions| {
                for (clump, motion) in (start..).zip(motions) {
                    let mut sums = Vector6::zeros();
                    for &node in &nodes[first[clump] as usize..first[clump + 1] as usize] {
                        let [force, moment] = parts(&right[node as usize]);
                        let arm = positions[node as usize] - centres[clump];
                        let moment = moment + arm.cross(&force);
                        for axis in 0..3 {
                            sums[axis] += force[axis];
                            sums[axis + 3] += moment[axis];
                        }
                    }
                    let moved = inverses[clump] * sums;
                    *motion =
                        [0, 3].map(|at| Vector3::new(moved[at], moved[at + 1], moved[at + 2]));
                }
                0.0
            });
        }
    }

    /// Adds to the nodes what their clumps' motions make of them; gives its product with `right`.
    pub(super) fn add<const M: usize>(
        &self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[f64; M]],
        solution: &mut Nodal<M>,
    ) -> f64 {
        let network = operator.network;
        let work = |(fibres, own): (Range<usize>, &mut [[f64; M]])| {
            let mut sum = 0.0;
            let start = network.nodes_of(fibres.start).start;
            for (node, own) in (start..).zip(own) {
                if !operator.is_free[node] {
                    continue;
                }
                let mut moved = [Vector3::zeros(); 2];
                for level in &self.levels {
                    let clump = level.of_node[node];
                    if clump != NONE {
                        let [shift, turn] = level.motions[clump as usize];
                        let arm = network.positions()[node] - level.centres[clump as usize];
                        moved[0] += shift + turn.cross(&arm);
                        moved[1] += turn;
                    }
                }
                let moved: [f64; M] = std::array::from_fn(|motion| moved[motion / 3][motion % 3]);
                for (own, moved) in own.iter_mut().zip(moved) {
                    *own += moved;
                }
                sum += dot(&right[node], &moved);
            }
            sum
        };
        let pieces = slices(network, operator.pieces(), solution);
        team.map(pieces, work).into_iter().sum()
    }
}

/// Pairs of different clumps that an active element joins.
fn pairs<const M: usize>(operator: &Operator<'_, M>, of_node: &[u32]) -> Vec<[u32; 2]> {
    let network = operator.network;
    let mut pairs: Vec<[u32; 2]> = Vec::new();
    for (index, element) in network.elements().iter().enumerate() {
        if operator.is_active[index] {
            let nodes = match index.checked_sub(network.segments()) {
                None => element.nodes,
                Some(bond) => operator.ends[bond].map(|tie| tie.nearer()),
            };
            let [a, b] = nodes.map(|node| of_node[node as usize]);
            if a != b && a != NONE && b != NONE {
                pairs.push([a.min(b), a.max(b)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Joins each item that has no group yet with its neighbours that have none; gives the group of each item
/// and their number. What is left alone between groups joins the first beside it.
fn join(count: usize, pairs: Vec<[u32; 2]>) -> (Vec<u32>, usize) {
    let mut starts = vec![0_u32; count + 1];
    for pair in &pairs {
        for &item in pair {
            starts[item as usize + 1] += 1;
        }
    }
    for item in 0..count {
        starts[item + 1] += starts[item];
    }
    let mut next = starts.clone();
    let mut neighbours = vec![0; 2 * pairs.len()];
    for [a, b] in pairs {
        for (own, other) in [(a, b), (b, a)] {
            neighbours[next[own as usize] as usize] = other;
            next[own as usize] += 1;
        }
    }
    let beside = |item: usize| &neighbours[starts[item] as usize..starts[item + 1] as usize];
    let mut groups = vec![NONE; count];
    let mut found = 0;
    // first those whose neighbours are all without a group
    for item in 0..count {
        let is_apart = beside(item)
            .iter()
            .all(|&other| groups[other as usize] == NONE);
        if groups[item] == NONE && is_apart {
            groups[item] = found;
            for &other in beside(item) {
                groups[other as usize] = found;
            }
            found += 1;
        }
    }
    let first = groups.clone();
    for (item, group) in groups.iter_mut().enumerate() {
        if *group == NONE {
            let grouped = beside(item).iter().map(|&other| first[other as usize]);
            *group = grouped.filter(|group| *group != NONE).min().unwrap_or(0);
        }
    }
    (groups, found as usize)
}

impl Level {
    fn new<const M: usize>(operator: &Operator<'_, M>, of_node: Vec<u32>, count: usize) -> Self {
        let network = operator.network;
        let mut first = vec![0_u32; count + 1];
        for &clump in of_node.iter().filter(|clump| **clump != NONE) {
            first[clump as usize + 1] += 1;
        }
        for clump in 0..count {
            first[clump + 1] += first[clump];
        }
        let mut next = first.clone();
        let mut nodes = vec![0; first[count] as usize];
        let mut centres = vec![Vector3::zeros(); count];
        for (node, &clump) in of_node.iter().enumerate() {
            if clump != NONE {
                nodes[next[clump as usize] as usize] = node as u32;
                next[clump as usize] += 1;
                centres[clump as usize] += network.positions()[node];
            }
        }
        for (clump, centre) in centres.iter_mut().enumerate() {
            *centre /= f64::from((first[clump + 1] - first[clump]).max(1));
        }
        let mut blocks = vec![Matrix6::zeros(); count];
        for (index, element) in network.elements().iter().enumerate() {
            if operator.is_active[index] {
                add_border(operator, index, element, &of_node, &centres, &mut blocks);
            }
        }
        let inverses = blocks.into_iter().map(|block| inverse(&block)).collect();
        Self {
            of_node,
            first,
            nodes,
            inverses,
            motions: vec![Default::default(); count],
            centres,
        }
    }
}

/// Adds an element at the border of clumps to the blocks of all of them.
fn add_border<const M: usize>(
    operator: &Operator<'_, M>,
    index: usize,
    element: &Element,
    of_node: &[u32],
    centres: &[Vector3<f64>],
    blocks: &mut [Matrix6<f64>],
) {
    let network: &Network = operator.network;
    let ties = index
        .checked_sub(network.segments())
        .map(|bond| &operator.ends[bond]);
    let nodes = match ties {
        None => [
            element.nodes[0],
            element.nodes[0],
            element.nodes[1],
            element.nodes[1],
        ],
        Some([a, b]) => [a.nodes[0], a.nodes[1], b.nodes[0], b.nodes[1]],
    };
    let clumps = nodes.map(|node| of_node[node as usize]);
    if clumps.iter().all(|clump| *clump == clumps[0]) {
        return;
    }
    for (place, &clump) in clumps.iter().enumerate() {
        if clump == NONE || clumps[..place].contains(&clump) {
            continue;
        }
        let mut columns = [Vector6::zeros(); PARTS];
        for motion in 0..6 {
            let mut unit = Vector3::zeros();
            unit[motion % 3] = 1.0;
            let of = |end: usize| {
                if clumps[end] != clump {
                    return [Vector3::zeros(); 2];
                }
                let arm = network.positions()[nodes[end] as usize] - centres[clump as usize];
                if motion < 3 {
                    [unit, Vector3::zeros()]
                } else {
                    [unit.cross(&arm), unit]
                }
            };
            let [a, b, c, d] = [of(0), of(1), of(2), of(3)];
            let ends: Ends = match ties {
                None => [a[0], a[1], c[0], c[1]],
                Some([one, other]) => {
                    let one = one.motion(&[a[0], a[1], b[0], b[1]]);
                    let other = other.motion(&[c[0], c[1], d[0], d[1]]);
                    [one[0], one[1], other[0], other[1]]
                }
            };
            let deformation = element.deformation(&ends);
            for (column, value) in columns.iter_mut().zip(deformation) {
                column[motion] = value;
            }
        }
        for (column, stiffness) in columns.iter().zip(element.stiffness) {
            if stiffness > 0.0 {
                blocks[clump as usize] += column * column.transpose() * stiffness;
            }
        }
    }
}

/// The inverse of a block with a raised diagonal; nothing for a clump that nothing holds.
fn inverse(block: &Matrix6<f64>) -> Matrix6<f64> {
    let mut raised = *block;
    let shares = [0, 3].map(|from| (from..from + 3).map(|at| block[(at, at)]).sum::<f64>());
    for at in 0..6 {
        raised[(at, at)] += RAISED * shares[at / 3];
    }
    raised
        .cholesky()
        .map_or_else(Matrix6::zeros, |cholesky| cholesky.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_is_joined_by_threes() {
        let pairs = (0..8).map(|item| [item, item + 1]).collect();
        let (groups, count) = join(9, pairs);
        assert_eq!(groups, [0, 0, 1, 1, 1, 2, 2, 2, 2]);
        assert_eq!(count, 3);
    }
}
