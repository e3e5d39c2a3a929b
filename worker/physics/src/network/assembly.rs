//! A network packed for the solvers: which bonds act, and the kernels' view of them.
//!
//! Nodes are renumbered: those held by the bottom jaw, then the free ones, then those held by the
//! top jaw, so that unknowns are a slice and no loop asks what is held. Free nodes keep their order
//! and bonds their numbers: neighbours stay neighbours in memory, and runs stay runs when bonds
//! break, because a bond that is broken or carries no load stays where it is and just does nothing.
use std::{ops::Range, sync::OnceLock};

use super::{
    Hold, Laws, Network, Vector,
    blocks::{Block, blocks},
    field::Field,
    incidence::Incidence,
    law::BondLaw,
    load_path::{Part, carries_load},
};

/// Nodes and bonds as the solvers see them.
#[derive(Clone, Debug)]
pub(crate) struct Assembly {
    /// Number in the network of each node.
    nodes: Vec<u32>,
    free: Range<usize>,
    /// Initial positions X [mm].
    pub(crate) positions: Field<f64>,
    /// Local numbers of the ends of each bond.
    pub(crate) ends: Vec<[u32; 2]>,
    pub(crate) blocks: Vec<Block>,
    /// l₀ [mm].
    pub(crate) rest_lengths: Vec<f64>,
    /// |X|² − l₀² [mm²], empty when all bonds begin at their rest length.
    pub(crate) excess: Vec<f64>,
    pub(crate) laws: Laws,
    /// 1 for a bond that is intact and carries load, else 0.
    pub(crate) acts: Vec<u8>,
    acting: usize,
    dimensions: usize,
    incidence: OnceLock<Incidence>,
}

/// How a bond responds at some displacements, (6) and (7).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BondState {
    /// u [-].
    pub(crate) strain: f64,
    /// n, from the first node to the second; zero for a bond without length.
    pub(crate) direction: Vector,
    /// T [N].
    pub(crate) tension: f64,
    /// a = T'/l₀ [N/mm].
    pub(crate) axial: f64,
    /// b = T/l [N/mm].
    pub(crate) transverse: f64,
    /// l₀ φ(u) [N mm].
    pub(crate) energy: f64,
}

/// Below this length in units of l₀ a bond has no direction: rounding of its end points would
/// decide where it points.
pub(crate) const NO_LENGTH: f64 = 1e-13;

impl Assembly {
    /// Packs a network; no bond acts until [`Assembly::load`].
    pub(crate) fn new(network: &Network) -> Self {
        const ABSENT: u32 = u32::MAX;
        let count = network.positions.len();
        let mut nodes = Vec::with_capacity(count);
        let mut local = vec![ABSENT; count];
        let mut take = |node: u32| {
            if local[node as usize] == ABSENT {
                local[node as usize] = nodes.len() as u32;
                nodes.push(node);
            }
        };
        let held = |jaw: Hold| {
            // in the order of their bonds, so that runs are runs at the jaws too
            let met = network.bonds.ends.iter().flatten().copied();
            let all = met.chain(0..count as u32);
            all.filter(move |node| network.holds[*node as usize] == jaw)
        };
        held(Hold::Bottom).for_each(&mut take);
        let is_free = |node: &u32| network.holds[*node as usize] == Hold::Free;
        (0..count as u32).filter(is_free).for_each(&mut take);
        held(Hold::Top).for_each(&mut take);
        let bottom = network.holds.iter().filter(|hold| **hold == Hold::Bottom);
        let first_free = bottom.count();
        let free = (0..count as u32).filter(is_free).count();

        let bonds = &network.bonds;
        let ends_of = |ends: &[u32; 2]| ends.map(|node| local[node as usize]);
        let ends: Vec<[u32; 2]> = bonds.ends.iter().map(ends_of).collect();
        let excess = |(ends, rest): (&[u32; 2], &f64)| {
            let [first, second] = ends.map(|node| network.positions[node as usize]);
            let length = (first - second).norm();
            // as a product, so that it is exactly zero when the rest length is the distance
            (length - rest) * (length + rest)
        };
        let pairs = bonds.ends.iter().zip(&bonds.rest_lengths);
        let mut excess: Vec<f64> = pairs.map(excess).collect();
        if excess.iter().all(|excess| *excess == 0.0) {
            excess = Vec::new();
        }
        let heights = network.positions.iter().map(|node| node.z);
        let lowest = heights.clone().fold(f64::INFINITY, f64::min);
        let is_flat = heights.fold(f64::NEG_INFINITY, f64::max) <= lowest;
        let dimensions = if is_flat { 2 } else { 3 };
        let positions: Vec<Vector> = nodes
            .iter()
            .map(|node| network.positions[*node as usize])
            .collect();
        Self {
            positions: Field::of(&positions, dimensions),
            nodes,
            free: first_free..first_free + free,
            blocks: blocks(&ends),
            rest_lengths: bonds.rest_lengths.clone(),
            excess,
            laws: bonds.laws.clone(),
            acts: vec![0; ends.len()],
            acting: 0,
            dimensions,
            incidence: OnceLock::new(),
            ends,
        }
    }

    /// Lets the intact bonds that carry load act.
    pub(crate) fn load(&mut self, network: &Network, intact: &[bool], parts: &[Part]) {
        let bonds = self
            .acts
            .iter_mut()
            .zip(intact.iter().zip(&network.bonds.ends));
        self.acting = 0;
        for (acts, (intact, ends)) in bonds {
            *acts = u8::from(*intact && carries_load(network, parts, *ends));
            self.acting += usize::from(*acts);
        }
    }

    /// Whether nothing connects the jaws.
    pub(crate) fn is_empty(&self) -> bool {
        self.acting == 0
    }

    pub(crate) fn acts(&self, bond: usize) -> bool {
        self.acts[bond] != 0
    }

    /// All bonds, whether they act or not.
    pub(crate) fn bonds(&self) -> usize {
        self.ends.len()
    }

    /// The free nodes: the unknowns.
    pub(crate) fn free(&self) -> Range<usize> {
        self.free.clone()
    }

    /// Number of nodes, held ones included.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Two when all nodes lie in one plane, which they then never leave; else three.
    pub(crate) fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// Number in the network of a node.
    pub(crate) fn network_node(&self, node: usize) -> usize {
        self.nodes[node] as usize
    }

    /// The bonds of each node, listed when first asked for.
    pub(crate) fn incidence(&self) -> &Incidence {
        let nodes = self.nodes();
        self.incidence
            .get_or_init(|| Incidence::new(nodes, &self.ends))
    }

    /// The part of a nodal array of the network that belongs to this assembly.
    pub(crate) fn pick(&self, of_network: &[Vector]) -> Vec<Vector> {
        let nodes = self.nodes.iter();
        nodes.map(|node| of_network[*node as usize]).collect()
    }

    /// Writes the free nodes' entries back into a nodal array of the network.
    pub(crate) fn put(&self, values: &Field<f64>, of_network: &mut [Vector]) {
        for node in self.free() {
            of_network[self.network_node(node)] = values.at(node);
        }
    }

    /// Forces of the loaded bonds on the jaws along y [N], tension positive: top, bottom.
    pub(crate) fn jaw_forces(&self, resultants: &Field<f64>) -> [f64; 2] {
        let along_y = |nodes: Range<usize>| resultants.axis(1)[nodes].iter().sum::<f64>();
        // a difference, because the negative of zero is written as -0
        let top = 0.0 - along_y(self.free.end..self.nodes());
        [top, along_y(0..self.free.start)]
    }

    /// The state of one bond whose ends are displaced by `first` and `second`, (4)-(7).
    #[inline]
    pub(crate) fn respond(&self, bond: usize, first: &Vector, second: &Vector) -> BondState {
        if !self.acts(bond) {
            return BondState::default();
        }
        let ends = self.ends[bond].map(|node| self.positions.at(node as usize));
        let span = ends[1] - ends[0];
        let shift = second - first;
        let rest_length = self.rest_lengths[bond];
        let excess = self.excess.get(bond).copied().unwrap_or(0.0);
        let vector = span + shift;
        let length = vector.norm();
        let strain =
            (shift.dot(&(span + vector)) + excess) / ((length + rest_length) * rest_length);
        let law: BondLaw = self.laws.of(bond);
        let tension = law.tension(strain);
        let inverse = if length > NO_LENGTH * rest_length {
            1.0 / length
        } else {
            0.0
        };
        BondState {
            strain,
            direction: vector * inverse,
            tension,
            axial: law.slope(strain) / rest_length,
            transverse: tension * inverse,
            energy: rest_length * law.energy(strain),
        }
    }
}
