//! Groups of nodes as rigid bodies, all at once: the motions that single fibres do not see.
//!
//! A group's six motions t, ω move its node at X by t + ω × (X - C), with the centre C of its nodes. The
//! matrix is the network's own between such motions, PᵀKP; a Cholesky factor solves it. While parts break
//! it may grow old: the network only becomes softer, so that what an old factor moves is too little and
//! never too much.
//!
//! Small trusses have groups of one node, whose displacements are all that there is, so that the factor is
//! that of the truss: bars are hinged everywhere, and rigid pieces know nothing of how they fold. How large groups are
//! changes little of that, and neither does it help to let every node free across the sheet, where bars fold most
//! easily. What helps is that bars are taut: a sheet of 166 000 unknowns takes 2473 iterations with 1e-9, and 392 with
//! 1e-4.
use std::ops::Range;

use loadframe_api::spec::paper_tensile::equilibrium::FACTORED_TRUSS;
use loadframe_numerics::Team;
use nalgebra::Vector3;

use super::super::element::{Ends, Matrix12, PARTS};
use super::super::error::FrameError;
use super::super::factor::Factor;
use super::groups::{Groups, Link, NONE};
use super::operator::{Operator, slices};
use super::points::parts;
use super::scalar::Scalar;

/// Most nodes of a group but for what is [left over](Groups). A sheet of beams of 55 000 nodes takes 92 iterations with
/// 64 and 76 with 32, which have three times the numbers in their factor: as long.
const NODES: u32 = 64;
/// The same of trusses, whose iterations hardly know how large groups are: taut ones of 655 000 unknowns took 362 to
/// their first equilibrium with 64, 389 with 128, 420 with 256, 511 with 1024; 15.0, 5.0, 1.8, and 0.2 million numbers
/// are in the factor then.
const NODES_OF_TRUSS: u32 = 256;
/// What raises the diagonal, as a share of it: motions that nothing resists.
const RAISED: f64 = 1e-9;
/// The same where each node is a group: far below what keeps loose bars in place.
const RAISED_OF_ALL: f64 = 1e-14;

/// The groups, and the factor of their motions.
#[derive(Debug)]
pub(super) struct Bodies {
    groups: Groups,
    centres: Vec<Vector3<f64>>,
    /// Motions of a body: 6, or 3 of a node that is one by itself.
    motions_of_each: usize,
    factor: Factor,
    unknowns: Vec<f64>,
    motions: Vec<[Vector3<f64>; 2]>,
}

impl Bodies {
    /// Groups the free nodes, and factors what is active between them.
    ///
    /// # Errors
    /// [`FrameError`] when the factor does not fit into memory or a value is not finite.
    pub(super) fn new<const M: usize>(operator: &Operator<'_, M>) -> Result<Self, FrameError> {
        let network = operator.network;
        let is_small = M * network.fibre_nodes() <= FACTORED_TRUSS;
        let is_factored = M == 3 && is_small && !operator.is_grouped;
        let most = match (is_factored, M) {
            (true, _) => 1,
            (false, 3) => NODES_OF_TRUSS,
            (false, _) => NODES,
        };
        let groups = Groups::new(&operator.is_free, links(operator), most);
        let centres: Vec<Vector3<f64>> = (0..groups.len())
            .map(|group| {
                let nodes = groups.nodes(group);
                let places = nodes.iter().map(|&node| network.positions()[node as usize]);
                places.sum::<Vector3<f64>>() / nodes.len() as f64
            })
            .collect();
        let motions_of_each = if is_factored { M } else { 6 };
        let active = || (0..network.elements().len()).filter(|&index| operator.is_active[index]);
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for index in active() {
            let of = groups_of(operator, &groups, index);
            for (at, &first) in of.iter().enumerate() {
                pairs.extend(of[at + 1..].iter().map(|&second| [first, second]));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let all = pairs.iter().copied();
        let mut factor = Factor::of_pairs(motions_of_each, &centres, |_| true, all)?;
        factor.sum(active().flat_map(|index| blocks(operator, &groups, &centres, index)));
        let raised = if is_factored { RAISED_OF_ALL } else { RAISED };
        factor.factor_shifted(&centres, raised)?;
        Ok(Self {
            unknowns: vec![0.0; factor.size()],
            motions: vec![Default::default(); groups.len()],
            groups,
            centres,
            motions_of_each,
            factor,
        })
    }

    /// Unknowns of the factor and the numbers it stores.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.factor.size(), self.factor.stored()]
    }

    /// The motions that nodes have with their bodies under the forces `right`; 0 at those that are not free.
    pub(super) fn move_by<T: Scalar, const M: usize>(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[T; M]],
        motion: &mut [[T; M]],
    ) {
        self.solve(operator, team, right);
        let network = operator.network;
        let this = &*self;
        let work = |(fibres, own): (Range<usize>, &mut [[T; M]])| {
            let start = network.nodes_of(fibres.start).start;
            for (node, own) in (start..).zip(own) {
                *own = [T::zero(); M];
                // nodes that came loose since are still in their groups
                let group = this.groups.of_node[node];
                if group != NONE && operator.is_free[node] {
                    let [shift, turn] = this.motions[group as usize];
                    let arm = network.positions()[node] - this.centres[group as usize];
                    let moved = [shift + turn.cross(&arm), turn];
                    for (motion, own) in own.iter_mut().enumerate() {
                        *own = T::of(moved[motion / 3][motion % 3]);
                    }
                }
            }
        };
        team.map(slices(network, operator.pieces(), motion), work);
    }

    fn solve<T: Scalar, const M: usize>(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[T; M]],
    ) {
        let positions = operator.network.positions();
        let (groups, centres) = (&self.groups, &self.centres);
        team.fill(&mut self.motions, |start, forces| {
            for (group, sums) in (start..).zip(forces) {
                *sums = Default::default();
                for &node in groups.nodes(group) {
                    let [force, moment] = parts(&right[node as usize].map(T::wide));
                    let arm = positions[node as usize] - centres[group];
                    sums[0] += force;
                    sums[1] += moment + arm.cross(&force);
                }
            }
            0.0
        });
        let each = self.motions_of_each;
        for (group, forces) in self.motions.iter().enumerate() {
            if let Some(place) = self.factor.unknown(group as u32) {
                for motion in 0..each {
                    self.unknowns[place + motion] = forces[motion / 3][motion % 3];
                }
            }
        }
        self.factor.solve(&mut self.unknowns, 1);
        for (group, motions) in self.motions.iter_mut().enumerate() {
            *motions = Default::default();
            if let Some(place) = self.factor.unknown(group as u32) {
                for motion in 0..each {
                    motions[motion / 3][motion % 3] = self.unknowns[place + motion];
                }
            }
        }
    }
}

/// What joins nodes, by its stiffness against displacement; a point between nodes counts as the nearer.
fn links<const M: usize>(operator: &Operator<'_, M>) -> Vec<Link> {
    let network = operator.network;
    let elements = network.elements().iter().enumerate();
    let active = elements.filter(|(index, _)| operator.is_active[*index]);
    active
        .map(|(index, element)| Link {
            stiffness: element.stiffness[0],
            nodes: match index.checked_sub(network.segments()) {
                None => element.nodes,
                Some(bond) => operator.ties(bond).map(|tie| tie.nearer()),
            },
        })
        .collect()
}

/// The nodes that an element's two points move with, two and two.
fn nodes_of<const M: usize>(operator: &Operator<'_, M>, element: usize) -> [u32; 4] {
    let network = operator.network;
    let [first, second] = match element.checked_sub(network.segments()) {
        None => network.elements()[element].nodes.map(|node| [node; 2]),
        Some(bond) => operator.ties(bond).map(|tie| tie.nodes),
    };
    [first[0], first[1], second[0], second[1]]
}

/// The groups of these nodes, each once, ascending.
fn groups_of<const M: usize>(
    operator: &Operator<'_, M>,
    groups: &Groups,
    element: usize,
) -> Vec<u32> {
    let nodes = nodes_of(operator, element);
    let mut of = nodes.map(|node| groups.of_node[node as usize]).to_vec();
    of.retain(|&group| group != NONE);
    of.sort_unstable();
    of.dedup();
    of
}

/// What an element adds to the matrix, by pairs of groups.
fn blocks<const M: usize>(
    operator: &Operator<'_, M>,
    groups: &Groups,
    centres: &[Vector3<f64>],
    element: usize,
) -> Vec<([u32; 2], Matrix12)> {
    let of = groups_of(operator, groups, element);
    let columns: Vec<[[f64; PARTS]; 6]> = of
        .iter()
        .map(|&group| deformations(operator, groups, centres, element, group))
        .collect();
    let stiffness = operator.network.elements()[element].stiffness;
    let mut blocks = Vec::with_capacity(6);
    let mut add = |[a, b]: [usize; 2], has: [bool; 2]| {
        let is_there = |row: usize, column: usize| row / 6 != column / 6 || has[row / 6];
        let of_motion = |motion: usize| &columns[[a, b][motion / 6]][motion % 6];
        let mut matrix = [[0.0; 12]; 12];
        for (row, values) in matrix.iter_mut().enumerate() {
            for (column, value) in values.iter_mut().enumerate() {
                if is_there(row, column) {
                    let springs = stiffness.iter().zip(of_motion(row)).zip(of_motion(column));
                    *value = springs.map(|((c, one), other)| c * one * other).sum();
                }
            }
        }
        blocks.push(([of[a], of[b]], matrix));
    };
    if of.len() == 1 {
        // a block of its own, once
        add([0, 0], [true, false]);
    }
    for a in 0..of.len() {
        for b in a + 1..of.len() {
            // each group's own block comes with the pair of it and the first, or of the first and the second
            add([a, b], [(a, b) == (0, 1), a == 0]);
        }
    }
    blocks
}

/// How each motion of a group deforms an element.
fn deformations<const M: usize>(
    operator: &Operator<'_, M>,
    groups: &Groups,
    centres: &[Vector3<f64>],
    element: usize,
    group: u32,
) -> [[f64; PARTS]; 6] {
    let network = operator.network;
    let nodes = nodes_of(operator, element);
    std::array::from_fn(|motion| {
        let mut unit = Vector3::zeros();
        unit[motion % 3] = 1.0;
        let moved = nodes.map(|node| {
            if groups.of_node[node as usize] != group {
                return [Vector3::zeros(); 2];
            }
            let arm = network.positions()[node as usize] - centres[group as usize];
            match (motion < 3, M) {
                (true, _) => [unit, Vector3::zeros()],
                (false, 3) => [unit.cross(&arm), Vector3::zeros()],
                (false, _) => [unit.cross(&arm), unit],
            }
        });
        let [a, b, c, d] = moved;
        let ends: Ends = match element.checked_sub(network.segments()) {
            None => [a[0], a[1], c[0], c[1]],
            Some(bond) => {
                let [one, other] = operator.ties(bond);
                let one = one.motion(&[a[0], a[1], b[0], b[1]]);
                let other = other.motion(&[c[0], c[1], d[0], d[1]]);
                [one[0], one[1], other[0], other[1]]
            }
        };
        network.elements()[element].deformation(&ends)
    })
}
