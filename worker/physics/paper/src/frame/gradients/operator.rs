//! The stiffness of what is active, applied to a motion of the nodes of fibres.
//!
//! First every bond's force and moment, then every fibre: its segments, and what its bonds do to it.
//! Each fibre writes only to its own nodes, in a fixed order.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::Vector3;

use super::super::element::Ends;
use super::super::network::Network;
use super::super::tie::Tie;

/// Nodes of fibres that are one piece of work: some 0.1 ms.
const NODES_OF_PIECE: usize = 1024;

/// Motions or forces of nodes: displacement, then of beams rotation.
pub(super) type Nodal<const M: usize> = Vec<[f64; M]>;

/// What is active of a network.
#[derive(Debug)]
pub(super) struct Operator<'n, const M: usize> {
    pub(super) network: &'n Network,
    /// Whether a node of a fibre moves by what acts on it.
    pub(super) is_free: Vec<bool>,
    pub(super) is_active: Vec<bool>,
    /// The two points of each bond.
    pub(super) ends: Vec<[Tie; 2]>,
    /// Stiffness of bonds against displacement and rotation, the same in all directions.
    stiffness: Vec<[f64; 2]>,
    /// Bonds and sides on each fibre: `hooks[first_hook[fibre]..first_hook[fibre + 1]]`.
    first_hook: Vec<u32>,
    hooks: Vec<(u32, u8)>,
    /// Fibres that are one piece of work.
    pieces: Vec<Range<usize>>,
    /// Force and moment of each bond on its second point.
    bonds: Vec<[Vector3<f64>; 2]>,
}

/// Motion of two nodes.
pub(super) fn ends_of<const M: usize>(motion: &[[f64; M]], nodes: [u32; 2]) -> Ends {
    let [first, second] = nodes.map(|node| parts(&motion[node as usize]));
    [first[0], first[1], second[0], second[1]]
}

/// Displacement and rotation of a node.
pub(super) fn parts<const M: usize>(motion: &[f64; M]) -> [Vector3<f64>; 2] {
    let mut parts = [Vector3::zeros(); 2];
    for (index, value) in motion.iter().enumerate() {
        parts[index / 3][index % 3] = *value;
    }
    parts
}

fn add<const M: usize>(to: &mut [f64; M], force: Vector3<f64>, moment: Vector3<f64>) {
    for (index, value) in to.iter_mut().enumerate() {
        *value += if index < 3 {
            force[index]
        } else {
            moment[index - 3]
        };
    }
}

impl<'n, const M: usize> Operator<'n, M> {
    pub(super) fn new(network: &'n Network, is_whole: &[bool]) -> Self {
        let segments = network.segments();
        let elements = network.elements();
        let ends: Vec<[Tie; 2]> = (0..network.bonds())
            .map(|bond| {
                elements[segments + bond]
                    .nodes
                    .map(|point| tie(network, is_whole, point))
            })
            .collect();
        let mut first_hook = vec![0; network.fibres() + 1];
        for tie in ends.iter().flatten() {
            first_hook[network.fibre_of(tie.nodes[0]) + 1] += 1;
        }
        for fibre in 0..network.fibres() {
            first_hook[fibre + 1] += first_hook[fibre];
        }
        let mut next = first_hook.clone();
        let mut hooks = vec![(0, 0); 2 * ends.len()];
        for (bond, ties) in ends.iter().enumerate() {
            for (side, tie) in ties.iter().enumerate() {
                let next = &mut next[network.fibre_of(tie.nodes[0])];
                hooks[*next as usize] = (bond as u32, side as u8);
                *next += 1;
            }
        }
        // along each fibre, so that its nodes are met in order
        for fibre in 0..network.fibres() {
            let own = first_hook[fibre] as usize..first_hook[fibre + 1] as usize;
            hooks[own].sort_by_key(|&(bond, side)| ends[bond as usize][side as usize].nodes[0]);
        }
        Self {
            network,
            is_free: vec![false; network.fibre_nodes()],
            is_active: vec![false; elements.len()],
            stiffness: vec![[0.0; 2]; ends.len()],
            bonds: vec![[Vector3::zeros(); 2]; ends.len()],
            ends,
            first_hook,
            hooks,
            pieces: pieces(network),
        }
    }

    /// Bonds and sides on a fibre.
    pub(super) fn hooks(&self, fibre: usize) -> &[(u32, u8)] {
        &self.hooks[self.first_hook[fibre] as usize..self.first_hook[fibre + 1] as usize]
    }

    /// Stiffness of a bond against displacement and rotation; 0 when it is not active.
    pub(super) fn bond_stiffness(&self, bond: usize) -> [f64; 2] {
        self.stiffness[bond]
    }

    pub(super) fn pieces(&self) -> &[Range<usize>] {
        &self.pieces
    }

    /// Makes elements active or not.
    pub(super) fn set_active(&mut self, element: usize, is_active: bool) {
        self.is_active[element] = is_active;
        if let Some(bond) = element.checked_sub(self.network.segments()) {
            let stiffness = self.network.elements()[element].stiffness;
            self.stiffness[bond] = if is_active {
                [stiffness[0], stiffness[3]]
            } else {
                [0.0; 2]
            };
        }
    }

    /// Ties the points of bonds on a fibre anew, by what is whole of it.
    pub(super) fn tie_again(&mut self, fibre: usize, is_whole: &[bool]) {
        let own = self.first_hook[fibre] as usize..self.first_hook[fibre + 1] as usize;
        for &(bond, side) in &self.hooks[own] {
            let element = &self.network.elements()[self.network.segments() + bond as usize];
            let point = element.nodes[side as usize];
            self.ends[bond as usize][side as usize] = tie(self.network, is_whole, point);
        }
    }

    /// q = K p at nodes that are free, 0 at others; gives p·q over them.
    pub(super) fn apply(
        &mut self,
        team: &Team,
        motion: &[[f64; M]],
        forces: &mut [[f64; M]],
    ) -> f64 {
        self.pass(team, motion, forces, |node, force| {
            dot(force, &motion[node])
        })
    }

    /// r - K p at nodes that are free, 0 at others.
    pub(super) fn lack(
        &mut self,
        team: &Team,
        motion: &[[f64; M]],
        right: &[[f64; M]],
        lack: &mut [[f64; M]],
    ) {
        self.pass(team, motion, lack, |node, force| {
            for (force, right) in force.iter_mut().zip(&right[node]) {
                *force = right - *force;
            }
            0.0
        });
    }

    /// Gives K p at nodes that are free to `finish`, and sums its answers; 0 is left at others.
    fn pass(
        &mut self,
        team: &Team,
        motion: &[[f64; M]],
        forces: &mut [[f64; M]],
        finish: impl Fn(usize, &mut [f64; M]) -> f64 + Sync,
    ) -> f64 {
        let (ends, stiffness) = (&self.ends, &self.stiffness);
        team.fill(&mut self.bonds, |start, bonds| {
            for (bond, of_bond) in (start..).zip(bonds) {
                let [force, moment] = stiffness[bond];
                if force > 0.0 {
                    let [first, second] = ends[bond]
                        .each_ref()
                        .map(|tie| tie.motion(&ends_of(motion, tie.nodes)));
                    *of_bond = [
                        (second[0] - first[0]) * force,
                        (second[1] - first[1]) * moment,
                    ];
                }
            }
            0.0
        });
        let this = &*self;
        let work = |(fibres, own): (Range<usize>, &mut [[f64; M]])| {
            let mut sum = 0.0;
            let first = this.network.nodes_of(fibres.start).start;
            for fibre in fibres {
                let nodes = this.network.nodes_of(fibre);
                let own = &mut own[nodes.start - first..nodes.end - first];
                this.apply_to_fibre(fibre, motion, own);
                for (node, force) in nodes.zip(own) {
                    if this.is_free[node] {
                        sum += finish(node, force);
                    } else {
                        *force = [0.0; M];
                    }
                }
            }
            sum
        };
        let pieces = slices(self.network, &self.pieces, forces);
        team.map(pieces, work).into_iter().sum()
    }

    fn apply_to_fibre(&self, fibre: usize, motion: &[[f64; M]], own: &mut [[f64; M]]) {
        own.fill([0.0; M]);
        let nodes = self.network.nodes_of(fibre);
        let first = nodes.start as u32;
        let segment = self.network.first_segment(fibre);
        for index in segment..segment + nodes.len() - 1 {
            if self.is_active[index] {
                let element = &self.network.elements()[index];
                let deformation = element.deformation(&ends_of(motion, element.nodes));
                let forces = element.forces(&element.loads(&deformation));
                let at = (element.nodes[0] - first) as usize;
                add(&mut own[at], forces[0], forces[1]);
                add(&mut own[at + 1], forces[2], forces[3]);
            }
        }
        for &(bond, side) in self.hooks(fibre) {
            if self.stiffness[bond as usize][0] > 0.0 {
                let [force, moment] = self.bonds[bond as usize];
                let tie = &self.ends[bond as usize][side as usize];
                let forces = tie.spread(if side == 0 {
                    [-force, -moment]
                } else {
                    [force, moment]
                });
                add(
                    &mut own[(tie.nodes[0] - first) as usize],
                    forces[0],
                    forces[1],
                );
                if tie.nodes[1] != tie.nodes[0] {
                    add(
                        &mut own[(tie.nodes[1] - first) as usize],
                        forces[2],
                        forces[3],
                    );
                }
            }
        }
    }
}

/// a·b of a node.
pub(super) fn dot<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn tie(network: &Network, is_whole: &[bool], point: u32) -> Tie {
    match (point as usize).checked_sub(network.fibre_nodes()) {
        None => Tie::node(point),
        Some(index) => network.tie(&network.hanging()[index], is_whole),
    }
}

/// Fibres in pieces of about as many nodes.
fn pieces(network: &Network) -> Vec<Range<usize>> {
    let mut pieces = Vec::new();
    let mut start = 0;
    for fibre in 0..network.fibres() {
        let nodes = network.nodes_of(fibre).end - network.nodes_of(start).start;
        if nodes >= NODES_OF_PIECE || fibre + 1 == network.fibres() {
            pieces.push(start..fibre + 1);
            start = fibre + 1;
        }
    }
    pieces
}

/// The items of each piece's nodes, with its fibres.
pub(super) fn slices<'a, T>(
    network: &Network,
    pieces: &[Range<usize>],
    mut items: &'a mut [T],
) -> Vec<(Range<usize>, &'a mut [T])> {
    let mut slices = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let nodes = network.nodes_of(piece.end - 1).end - network.nodes_of(piece.start).start;
        let (own, rest) = items.split_at_mut(nodes);
        slices.push((piece.clone(), own));
        items = rest;
    }
    slices
}
