//! The loaded part of a network, packed for the solvers.
//!
//! Nodes are renumbered, free ones first, so that unknowns are a slice and held nodes need no test
//! in any loop. Order is kept otherwise: neighbours in the network stay neighbours in memory.
use std::sync::OnceLock;

use super::{
    Hold, Network, Vector,
    incidence::Incidence,
    law::BondLaw,
    load_path::{Part, carries_load},
};

/// Loaded nodes and bonds; constant while bonds do not break.
#[derive(Clone, Debug)]
pub(crate) struct Assembly {
    /// Number in the network of each node, free nodes first.
    nodes: Vec<u32>,
    free: usize,
    /// Local numbers of the held nodes of each jaw.
    bottom: Vec<u32>,
    top: Vec<u32>,
    /// Number in the network of each bond, ascending.
    pub(crate) bonds: Vec<u32>,
    pub(crate) ends: Vec<[u32; 2]>,
    pub(crate) shapes: Vec<BondShape>,
    incidence: OnceLock<Incidence>,
}

/// What a bond's force follows from, beside the displacements of its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BondShape {
    /// X, from the first node to the second before the test [mm].
    span: Vector,
    /// |X|² − l₀² [mm²].
    excess: f64,
    /// l₀ [mm].
    rest_length: f64,
    law: BondLaw,
}

/// How a bond responds at some displacements, (6) and (7).
#[derive(Clone, Copy, Debug)]
pub(crate) struct BondState {
    /// n, from the first node to the second; zero for a bond without length.
    pub(crate) direction: Vector,
    /// T [N].
    pub(crate) tension: f64,
    /// a = T'/l₀ [N/mm].
    pub(crate) axial: f64,
    /// b = T/l [N/mm].
    pub(crate) transverse: f64,
}

/// Below this length in units of l₀ a bond has no direction: rounding of its end points would
/// decide where it points.
const NO_LENGTH: f64 = 1e-13;

impl BondShape {
    /// Strain and current vector of a bond whose ends moved apart by `shift`, (4).
    #[inline]
    fn stretch(&self, shift: &Vector) -> (f64, Vector, f64) {
        let vector = self.span + shift;
        let length = vector.norm();
        let elongation =
            (shift.dot(&(self.span + vector)) + self.excess) / (length + self.rest_length);
        (elongation / self.rest_length, vector, length)
    }

    /// State and energy [N mm] of a bond whose ends moved apart by `shift`.
    #[inline]
    pub(crate) fn respond(&self, shift: &Vector) -> (BondState, f64) {
        let (strain, vector, length) = self.stretch(shift);
        let tension = self.law.tension(strain);
        let inverse = if length > NO_LENGTH * self.rest_length {
            1.0 / length
        } else {
            0.0
        };
        let state = BondState {
            direction: vector * inverse,
            tension,
            axial: self.law.slope(strain) / self.rest_length,
            transverse: tension * inverse,
        };
        (state, self.rest_length * self.law.energy(strain))
    }

    pub(crate) fn strain(&self, shift: &Vector) -> f64 {
        self.stretch(shift).0
    }
}

impl Assembly {
    /// Packs the intact bonds that carry load.
    pub(crate) fn new(network: &Network, intact: &[bool], parts: &[Part]) -> Self {
        const ABSENT: u32 = u32::MAX;
        let bonds = &network.bonds;
        let is_loaded = |bond: &u32| {
            intact[*bond as usize] && carries_load(network, parts, bonds.ends[*bond as usize])
        };
        let loaded: Vec<u32> = (0..bonds.len() as u32).filter(is_loaded).collect();

        let mut local = vec![ABSENT; network.positions.len()];
        for node in loaded.iter().flat_map(|bond| bonds.ends[*bond as usize]) {
            local[node as usize] = 0;
        }
        let mut nodes = Vec::new();
        let mut collect = |hold: Hold| {
            let from = nodes.len();
            for (node, place) in local.iter_mut().enumerate() {
                if *place != ABSENT && network.holds[node] == hold {
                    *place = nodes.len() as u32;
                    nodes.push(node as u32);
                }
            }
            from as u32..nodes.len() as u32
        };
        let free = collect(Hold::Free).len();
        let bottom = collect(Hold::Bottom).collect();
        let top = collect(Hold::Top).collect();

        let shape = |bond: &u32| {
            let bond = *bond as usize;
            let [first, second] = bonds.ends[bond].map(|node| network.positions[node as usize]);
            BondShape::new(second - first, bonds.rest_lengths[bond], bonds.laws[bond])
        };
        let ends_of = |bond: &u32| bonds.ends[*bond as usize].map(|node| local[node as usize]);
        let ends: Vec<[u32; 2]> = loaded.iter().map(ends_of).collect();
        Self {
            shapes: loaded.iter().map(shape).collect(),
            incidence: OnceLock::new(),
            nodes,
            free,
            bottom,
            top,
            bonds: loaded,
            ends,
        }
    }

    /// Whether nothing connects the jaws.
    pub(crate) fn is_empty(&self) -> bool {
        self.bonds.is_empty()
    }

    /// Number of free nodes: the unknowns are the first `free()` entries of a nodal array.
    pub(crate) fn free(&self) -> usize {
        self.free
    }

    /// Number of nodes, held ones included.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number in the network of a node.
    pub(crate) fn network_node(&self, node: usize) -> usize {
        self.nodes[node] as usize
    }

    /// The bonds of each node. Listed when first asked for: Newton's method on one thread, which
    /// repacks after every breaking round, has no use for it.
    pub(crate) fn incidence(&self) -> &Incidence {
        let nodes = self.nodes();
        self.incidence
            .get_or_init(|| Incidence::new(nodes, &self.ends))
    }

    /// How far the second end of a bond moved away from the first [mm].
    #[inline]
    pub(crate) fn shift(&self, bond: usize, displacements: &[Vector]) -> Vector {
        let [first, second] = self.ends[bond];
        displacements[second as usize] - displacements[first as usize]
    }

    /// The part of a nodal array of the network that belongs to this assembly.
    pub(crate) fn pick(&self, of_network: &[Vector]) -> Vec<Vector> {
        let nodes = self.nodes.iter();
        nodes.map(|node| of_network[*node as usize]).collect()
    }

    /// Writes the free nodes' entries back into a nodal array of the network.
    pub(crate) fn put(&self, values: &[Vector], of_network: &mut [Vector]) {
        for (node, value) in self.nodes[..self.free].iter().zip(values) {
            of_network[*node as usize] = *value;
        }
    }

    /// Forces of the loaded bonds on the jaws along y [N], tension positive: top, bottom.
    pub(crate) fn jaw_forces(&self, resultants: &[Vector]) -> [f64; 2] {
        let along_y = |nodes: &[u32]| {
            let nodes = nodes.iter();
            nodes.map(|node| resultants[*node as usize].y).sum::<f64>()
        };
        // a difference, because the negative of zero is written as -0
        [0.0 - along_y(&self.top), along_y(&self.bottom)]
    }
}

impl BondShape {
    pub(crate) fn new(span: Vector, rest_length: f64, law: BondLaw) -> Self {
        let length = span.norm();
        Self {
            span,
            // as a product, so that it is exactly zero when the rest length is the distance
            excess: (length - rest_length) * (length + rest_length),
            rest_length,
            law,
        }
    }
}
