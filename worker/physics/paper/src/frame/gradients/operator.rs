//! The stiffness of what is active, applied to a motion of the nodes of fibres.
//!
//! First the motion of every bond's two points, then every fibre: its segments, and what its bonds do to it.
//! Points are in the order of fibres, so that what is read is read in a row, but for the motion of the
//! other point of a bond. Each fibre writes only to its own nodes, in a fixed order.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::{RealField, Vector3};

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
    /// Whether nodes of a small truss are grouped as those of others are.
    pub(super) is_grouped: bool,
    /// The points of bonds, fibre by fibre and along each: those of a fibre are
    /// `first_point[fibre]..first_point[fibre + 1]`.
    first_point: Vec<u32>,
    points: Vec<Point>,
    /// The two points of each bond.
    ends: Vec<[u32; 2]>,
    /// Fibres that are one piece of work.
    pieces: Vec<Range<usize>>,
    /// Displacement and rotation of the points.
    moved: Vec<[Vector3<f64>; 2]>,
}

/// One of the two points of a bond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) tie: Tie,
    /// The other point of the bond.
    pub(super) other: u32,
    /// Number of the point among those of the network.
    number: u32,
    /// Stiffness of the bond against displacement and rotation, the same in all directions; 0 when it is not
    /// active.
    pub(super) stiffness: [f64; 2],
}

/// Motion of two nodes.
#[inline]
pub(super) fn ends_of<T: RealField + Copy, const M: usize>(
    motion: &[[T; M]],
    nodes: [u32; 2],
) -> [Vector3<T>; 4] {
    let [first, second] = nodes.map(|node| parts(&motion[node as usize]));
    [first[0], first[1], second[0], second[1]]
}

/// Displacement and rotation of a node.
#[inline]
pub(super) fn parts<T: RealField + Copy, const M: usize>(motion: &[T; M]) -> [Vector3<T>; 2] {
    let mut parts = [Vector3::zeros(); 2];
    for (index, value) in motion.iter().enumerate() {
        parts[index / 3][index % 3] = *value;
    }
    parts
}

/// Adds a force and a moment on a node.
#[inline]
pub(super) fn add<T: RealField + Copy, const M: usize>(
    to: &mut [T; M],
    force: Vector3<T>,
    moment: Vector3<T>,
) {
    for (index, value) in to.iter_mut().enumerate() {
        *value += if index < 3 {
            force[index]
        } else {
            moment[index - 3]
        };
    }
}

/// Adds a force and a moment on a point to the nodes of its fibre, whose first is `first`.
#[inline]
pub(super) fn add_spread<T: RealField + Copy, const M: usize>(
    own: &mut [[T; M]],
    first: u32,
    tie: &Tie<T>,
    loads: [Vector3<T>; 2],
) {
    let forces = tie.spread(loads);
    let [at, next] = tie.nodes.map(|node| (node - first) as usize);
    add(&mut own[at], forces[0], forces[1]);
    if next != at {
        add(&mut own[next], forces[2], forces[3]);
    }
}

impl<'n, const M: usize> Operator<'n, M> {
    pub(super) fn new(network: &'n Network, is_whole: &[bool]) -> Self {
        let segments = network.segments();
        let mut points: Vec<(usize, Point)> = Vec::with_capacity(2 * network.bonds());
        for element in &network.elements()[segments..] {
            for number in element.nodes {
                let tie = tie(network, is_whole, number);
                let point = Point {
                    tie,
                    other: 0,
                    number,
                    stiffness: [0.0; 2],
                };
                points.push((points.len(), point));
            }
        }
        // nodes are numbered fibre by fibre, so that those of a fibre follow one another
        points.sort_by_key(|(place, point)| (point.tie.nodes[0], *place));
        let mut ends = vec![[0; 2]; network.bonds()];
        for (at, (place, _)) in points.iter().enumerate() {
            ends[place / 2][place % 2] = at as u32;
        }
        let points: Vec<Point> = points
            .into_iter()
            .map(|(place, point)| Point {
                other: ends[place / 2][1 - place % 2],
                ..point
            })
            .collect();
        let first_point = (0..=network.fibres())
            .map(|fibre| {
                let node = if fibre < network.fibres() {
                    network.nodes_of(fibre).start
                } else {
                    network.fibre_nodes()
                };
                points.partition_point(|point| (point.tie.nodes[0] as usize) < node) as u32
            })
            .collect();
        Self {
            network,
            is_free: vec![false; network.fibre_nodes()],
            is_active: vec![false; network.elements().len()],
            is_grouped: false,
            moved: vec![[Vector3::zeros(); 2]; points.len()],
            first_point,
            points,
            ends,
            pieces: pieces(network),
        }
    }

    /// Places of the points on a fibre.
    pub(super) fn places(&self, fibre: usize) -> Range<usize> {
        self.first_point[fibre] as usize..self.first_point[fibre + 1] as usize
    }

    /// All points of bonds, those of a fibre after one another.
    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }

    /// How the two points of a bond move with their nodes.
    pub(super) fn ties(&self, bond: usize) -> [Tie; 2] {
        self.ends[bond].map(|at| self.points[at as usize].tie)
    }

    pub(super) fn pieces(&self) -> &[Range<usize>] {
        &self.pieces
    }

    /// Makes elements active or not.
    pub(super) fn set_active(&mut self, element: usize, is_active: bool) {
        self.is_active[element] = is_active;
        if let Some(bond) = element.checked_sub(self.network.segments()) {
            let stiffness = self.network.elements()[element].stiffness;
            for at in self.ends[bond] {
                self.points[at as usize].stiffness = if is_active {
                    [stiffness[0], stiffness[3]]
                } else {
                    [0.0; 2]
                };
            }
        }
    }

    /// Ties the points of bonds on a fibre anew, by what is whole of it.
    pub(super) fn tie_again(&mut self, fibre: usize, is_whole: &[bool]) {
        for at in self.places(fibre) {
            let point = &mut self.points[at];
            point.tie = tie(self.network, is_whole, point.number);
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
        let points = &self.points;
        team.fill(&mut self.moved, |start, moved| {
            for (point, moved) in points[start..].iter().zip(moved) {
                *moved = point.tie.motion(&ends_of(motion, point.tie.nodes));
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
        // each fibre before has a segment less than nodes
        let segment = nodes.start - fibre;
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
        for at in self.places(fibre) {
            let point = &self.points[at];
            let [force, moment] = point.stiffness;
            if force > 0.0 {
                let [here, there] = [self.moved[at], self.moved[point.other as usize]];
                let loads = [(here[0] - there[0]) * force, (here[1] - there[1]) * moment];
                add_spread(own, first, &point.tie, loads);
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
