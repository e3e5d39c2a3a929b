//! The stiffness of what is active, applied to a motion of the nodes of fibres.
//!
//! First the motion of every bond's two points, then every fibre: its segments, and what its bonds do to it.
//! Each fibre writes only to its own nodes, in a fixed order.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::Vector3;

use super::super::element::Element;
use super::super::network::Network;
use super::super::tie::Tie;
use super::points::{OF_BARS, Points, add, ends_of, parts};

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
    /// Whether nodes of a small truss are grouped as those of others are.
    pub(super) is_grouped: bool,
    /// The points of bonds, fibre by fibre and along each: those of a fibre are
    /// `first_point[fibre]..first_point[fibre + 1]`.
    first_point: Vec<u32>,
    points: Points<f64, M>,
    /// Number of each point among those of the network.
    numbers: Vec<u32>,
    /// The two points of each bond.
    ends: Vec<[u32; 2]>,
    /// Fibres that are one piece of work.
    pieces: Vec<Range<usize>>,
    /// Segments of bars; those of beams are read from the network.
    bars: Vec<Bar>,
}

/// A segment of a bar: what it resists along itself and, taut, across [mN/µm].
#[derive(Debug, Clone, Copy)]
struct Bar {
    along: Vector3<f64>,
    axial: f64,
    across: f64,
}

impl<'n, const M: usize> Operator<'n, M> {
    pub(super) fn new(network: &'n Network, is_whole: &[bool]) -> Self {
        let segments = network.segments();
        let ends = network.elements()[segments..].iter();
        let numbers: Vec<u32> = ends.flat_map(|element| element.nodes).collect();
        let ties: Vec<Tie> = numbers
            .iter()
            .map(|&number| tie(network, is_whole, number))
            .collect();
        // nodes are numbered fibre by fibre, so that those of a fibre follow one another
        let mut order: Vec<usize> = (0..ties.len()).collect();
        order.sort_by_key(|&place| (ties[place].nodes[0], place));
        let mut ends = vec![[0; 2]; network.bonds()];
        for (at, &place) in order.iter().enumerate() {
            ends[place / 2][place % 2] = at as u32;
        }
        let points = order
            .iter()
            .map(|&place| (ties[place], ends[place / 2][1 - place % 2]));
        let points = Points::new(points);
        let numbers = order.iter().map(|&place| numbers[place]).collect();
        let first_point = (0..=network.fibres())
            .map(|fibre| {
                let node = if fibre < network.fibres() {
                    network.nodes_of(fibre).start
                } else {
                    network.fibre_nodes()
                };
                order.partition_point(|&place| (ties[place].nodes[0] as usize) < node) as u32
            })
            .collect();
        Self {
            network,
            is_free: vec![false; network.fibre_nodes()],
            is_active: vec![false; network.elements().len()],
            is_grouped: false,
            bars: if M == OF_BARS {
                bars(network)
            } else {
                Vec::new()
            },
            first_point,
            points,
            numbers,
            ends,
            pieces: pieces(network),
        }
    }

    /// Places of the points on a fibre.
    pub(super) fn places(&self, fibre: usize) -> Range<usize> {
        self.first_point[fibre] as usize..self.first_point[fibre + 1] as usize
    }

    /// The same of fibres that follow one another.
    pub(super) fn places_of(&self, fibres: Range<usize>) -> Range<usize> {
        self.first_point[fibres.start] as usize..self.first_point[fibres.end] as usize
    }

    /// All points of bonds, those of a fibre after one another.
    pub(super) fn points(&self) -> &Points<f64, M> {
        &self.points
    }

    /// How the two points of a bond move with their nodes.
    pub(super) fn ties(&self, bond: usize) -> [Tie; 2] {
        self.ends[bond].map(|at| self.points.tie(at as usize))
    }

    pub(super) fn pieces(&self) -> &[Range<usize>] {
        &self.pieces
    }

    /// Makes elements active or not.
    pub(super) fn set_active(&mut self, element: usize, is_active: bool) {
        self.is_active[element] = is_active;
        if let Some(bond) = element.checked_sub(self.network.segments()) {
            let stiffness = self.network.elements()[element].stiffness;
            let stiffness = if is_active {
                [stiffness[0], stiffness[3]]
            } else {
                [0.0; 2]
            };
            for at in self.ends[bond] {
                self.points.set_stiffness(at as usize, stiffness);
            }
        }
    }

    /// Ties the points of bonds on a fibre anew, by what is whole of it.
    pub(super) fn tie_again(&mut self, fibre: usize, is_whole: &[bool]) {
        for at in self.places(fibre) {
            let tie = tie(self.network, is_whole, self.numbers[at]);
            self.points.set_tie(at, tie);
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
        self.points.follow(team, motion);
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
        // each fibre before has a segment less than nodes
        let segment = nodes.start - fibre;
        for (at, index) in (segment..segment + nodes.len() - 1).enumerate() {
            if !self.is_active[index] {
                continue;
            }
            if M == OF_BARS {
                let [from, to] = [0, 1].map(|end| parts(&motion[nodes.start + at + end])[0]);
                let Bar {
                    along,
                    axial,
                    across,
                } = self.bars[index];
                let apart = to - from;
                let force = apart * across + along * ((axial - across) * along.dot(&apart));
                add(&mut own[at], -force, Vector3::zeros());
                add(&mut own[at + 1], force, Vector3::zeros());
            } else {
                let element = &self.network.elements()[index];
                let deformation = element.deformation(&ends_of(motion, element.nodes));
                let forces = element.forces(&element.loads(&deformation));
                add(&mut own[at], forces[0], forces[1]);
                add(&mut own[at + 1], forces[2], forces[3]);
            }
        }
        for at in self.places(fibre) {
            if let Some(load) = self.points.held(at) {
                self.points.add(at, &load, own, first);
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

fn bars(network: &Network) -> Vec<Bar> {
    let segments = &network.elements()[..network.segments()];
    let bar = |element: &Element| Bar {
        along: element.axes.row(0).transpose(),
        axial: element.stiffness[0],
        across: element.stiffness[1],
    };
    segments.iter().map(bar).collect()
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
