//! A network packed for the solvers: which bonds act, and the kernels' view of them.
//!
//! Nodes have [`places`](super::places) and bonds slots in [`blocks`](super::blocks); both stay the
//! same when bonds break, because a bond that is broken or carries no load just does nothing.
use std::{ops::Range, sync::OnceLock};

use super::{
    Laws, Network, Row, Vector,
    blocks::{Block, Blocks},
    boundary::free_part,
    field::Field,
    incidence::Incidence,
    law::{BondLaw, StrainLaw},
    load_path::{Part, carries_load},
    places::{NONE, Places},
    strips::Strips,
};

/// Nodes and bonds as the solvers see them.
#[derive(Clone, Debug)]
pub(crate) struct Assembly {
    places: Places,
    /// Initial positions X [mm].
    pub(crate) positions: Field<f64>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) strips: Strips,
    /// Places of the ends of the bond in each slot.
    pub(crate) ends: Vec<[u32; 2]>,
    /// Number in the network of the bond in each slot, or [`NONE`].
    bonds: Vec<u32>,
    /// Slot of each bond.
    slots: Vec<u32>,
    /// l₀ [mm].
    pub(crate) rest_lengths: Vec<f64>,
    /// |X|² − l₀² [mm²], empty when all bonds begin at their rest length.
    pub(crate) excess: Vec<f64>,
    pub(crate) laws: Laws,
    /// Strain over which the kinks of all laws are rounded off, on the way to the true ones.
    pub(crate) rounding: Option<f64>,
    /// Nodes that are held along some axes, by their place, which is among the free ones.
    guided: Vec<(u32, [bool; 3])>,
    /// Places of the nodes of each set, ascending.
    sets: Vec<Vec<u32>>,
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
        let places = Places::new(network);
        let place = |node: u32| places.of[node as usize];
        let ends: Vec<[u32; 2]> = network.bonds.ends.iter().map(|e| e.map(place)).collect();
        let Blocks {
            blocks,
            bonds,
            ends,
            strips,
        } = Blocks::new(&ends, places.nodes.len());
        let slots = slots_of(&bonds, network.bonds.len());
        let given = &network.bonds;
        let of_bond = |bond: &u32| (*bond != NONE).then_some(*bond as usize);
        let rest_lengths = bonds.iter().map(|bond| match of_bond(bond) {
            Some(bond) => given.rest_lengths[bond],
            // of a bond that never acts any length will do
            None => 1.0,
        });
        let excess = bonds.iter().map(|bond| {
            let Some(bond) = of_bond(bond) else {
                return 0.0;
            };
            let [first, second] = given.ends[bond].map(|node| network.positions[node as usize]);
            let (length, rest) = ((first - second).norm(), given.rest_lengths[bond]);
            // as a product, so that it is exactly zero when the rest length is the distance
            (length - rest) * (length + rest)
        });
        let mut excess: Vec<f64> = excess.collect();
        if excess.iter().all(|excess| *excess == 0.0) {
            excess = Vec::new();
        }
        let laws = match &given.laws {
            Laws::Same(law) => Laws::Same(*law),
            Laws::Each(laws) => {
                let of_slot = |bond: &u32| laws[of_bond(bond).unwrap_or(0)];
                Laws::Each(bonds.iter().map(of_slot).collect())
            }
        };
        let heights = network.positions.iter().map(|node| node.z);
        let lowest = heights.clone().fold(f64::INFINITY, f64::min);
        let mut ways = network.sets.iter().filter_map(|set| set.ways[2]);
        let is_level = ways.all(|way| way == 0.0);
        let is_flat = is_level && heights.fold(f64::NEG_INFINITY, f64::max) <= lowest;
        let mut sets = vec![Vec::new(); network.sets.len()];
        let mut guided = Vec::new();
        for (place, node) in (0..).zip(&places.nodes) {
            if *node == NONE {
                continue;
            }
            if let Some(set) = network.holds[*node as usize] {
                sets[usize::from(set)].push(place);
                let set = &network.sets[usize::from(set)];
                if !set.is_fixed() {
                    guided.push((place, set.held()));
                }
            }
        }
        let dimensions = if is_flat { 2 } else { 3 };
        let mut assembly = Self {
            rest_lengths: rest_lengths.collect(),
            excess,
            laws,
            rounding: None,
            guided,
            sets,
            acts: vec![0; bonds.len()],
            acting: 0,
            dimensions,
            incidence: OnceLock::new(),
            positions: Field::default(),
            places,
            blocks,
            strips,
            ends,
            bonds,
            slots,
        };
        assembly.positions = Field::of(&assembly.pick(&network.positions), dimensions);
        assembly
    }

    /// Lets the intact bonds that carry load act.
    pub(crate) fn load(&mut self, network: &Network, intact: &[bool], parts: &[Part]) {
        let bonds = self
            .slots
            .iter()
            .zip(intact.iter().zip(&network.bonds.ends));
        self.acting = 0;
        for (slot, (intact, ends)) in bonds {
            let acts = *intact && carries_load(network, parts, *ends);
            self.acts[*slot as usize] = u8::from(acts);
            self.acting += usize::from(acts);
        }
    }

    /// Lets a bond act no more.
    pub(crate) fn release(&mut self, bond: usize) {
        let acts = &mut self.acts[self.slots[bond] as usize];
        self.acting -= usize::from(std::mem::take(acts));
    }

    /// Whether the ends of a bond hang together through free nodes near them. False may also mean
    /// that they do so by a longer way.
    pub(crate) fn is_bridged(&self, bond: usize) -> bool {
        /// Nodes looked at: those a few bonds away.
        const NEAR: usize = 64;
        let [first, second] = self.ends[self.slot(bond)];
        if ![first, second]
            .iter()
            .all(|end| self.free().contains(&(*end as usize)))
        {
            return false;
        }
        let mut met = vec![first];
        let mut next = 0;
        while next < met.len() && met.len() < NEAR {
            for neighbour in self.free_neighbours(met[next] as usize) {
                if neighbour == second {
                    return true;
                }
                if !met.contains(&neighbour) {
                    met.push(neighbour);
                }
            }
            next += 1;
        }
        false
    }

    /// Whether nothing connects the jaws.
    pub(crate) fn is_empty(&self) -> bool {
        self.acting == 0
    }

    pub(crate) fn acts(&self, slot: usize) -> bool {
        self.acts[slot] != 0
    }

    /// All bonds, whether they act or not.
    pub(crate) fn bonds(&self) -> usize {
        self.slots.len()
    }

    pub(crate) fn slot(&self, bond: usize) -> usize {
        self.slots[bond] as usize
    }

    /// Slot of each bond, in the order of the network.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = usize> {
        self.slots.iter().map(|slot| *slot as usize)
    }

    /// Number in the network of the bond in a slot, if there is one.
    pub(crate) fn bond_in(&self, slot: usize) -> Option<usize> {
        let bond = self.bonds[slot];
        (bond != NONE).then_some(bond as usize)
    }

    /// From the place of the first free node to that of the last: the unknowns.
    pub(crate) fn free(&self) -> Range<usize> {
        self.places.free.clone()
    }

    /// Number of places, those of no node included.
    pub(crate) fn places(&self) -> usize {
        self.places.nodes.len()
    }

    /// Two when all nodes lie in one plane, which they then never leave; else three.
    pub(crate) fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// Number in the network of the node at a place.
    pub(crate) fn node(&self, place: usize) -> usize {
        self.places.nodes[place] as usize
    }

    /// The slots of the bonds at each place, listed when first asked for.
    pub(crate) fn incidence(&self) -> &Incidence {
        self.incidence.get_or_init(|| {
            let is_bond = |slot: usize| self.bonds[slot] != NONE;
            Incidence::new(self.places(), &self.ends, is_bond)
        })
    }

    /// The free places at the other ends of the acting bonds of a free place, one for each bond.
    pub(crate) fn free_neighbours(&self, place: usize) -> impl Iterator<Item = u32> {
        let free = self.free();
        let around = self.incidence().around(place);
        around
            .filter(move |(slot, other)| {
                self.acts(*slot as usize) && free.contains(&(*other as usize))
            })
            .map(|(_, other)| other)
    }

    /// The places of the nodes held by the bottom and by the top jaw.
    pub(crate) fn held(&self) -> [Range<usize>; 2] {
        let Range { start, end } = self.free();
        let after = self.places.nodes[end..].iter();
        let top = after.take_while(|node| **node != NONE).count();
        [0..start, end..end + top]
    }

    /// The places of the free nodes row by row; nodes of no row are rows of one.
    pub(crate) fn rows(&self) -> Vec<(Range<usize>, Row)> {
        let mut rows = Vec::new();
        let mut given = self.places.rows.iter().peekable();
        let mut place = self.free().start;
        while place < self.free().end {
            if let Some((first, row)) = given.next_if(|(first, _)| *first == place) {
                place += row.count as usize;
                rows.push((*first..place, *row));
                continue;
            }
            if self.places.nodes[place] != NONE {
                let row = Row {
                    first: self.places.nodes[place],
                    count: 1,
                    origin: self.positions.at(place),
                    spacing: 0.0,
                };
                rows.push((place..place + 1, row));
            }
            place += 1;
        }
        rows
    }

    /// A nodal array of the network by places, zero where there is no node.
    pub(crate) fn pick(&self, of_network: &[Vector]) -> Vec<Vector> {
        let of_place = |node: &u32| of_network.get(*node as usize).copied();
        let places = self.places.nodes.iter();
        places
            .map(|node| of_place(node).unwrap_or_default())
            .collect()
    }

    /// The same into a field that is there already.
    pub(crate) fn pick_into(&self, of_network: &[Vector], field: &mut Field<f64>) {
        let [x, y, z] = field.components_mut();
        for (place, node) in self.places.nodes.iter().enumerate() {
            let vector = of_network.get(*node as usize).copied().unwrap_or_default();
            x[place] = vector.x;
            y[place] = vector.y;
            if let Some(z) = z.get_mut(place) {
                *z = vector.z;
            }
        }
    }

    /// Writes the free nodes' entries back into a nodal array of the network.
    pub(crate) fn put(&self, values: &Field<f64>, of_network: &mut [Vector]) {
        for place in self.free() {
            if let Some(value) = of_network.get_mut(self.node(place)) {
                *value = values.at(place);
            }
        }
    }

    /// Nodes that are held along some axes, by their place, ascending.
    pub(crate) fn guided(&self) -> &[(u32, [bool; 3])] {
        &self.guided
    }

    /// Along which axes the node at a free place is held, where it is along any.
    pub(crate) fn guide_of(&self, place: usize) -> Option<[bool; 3]> {
        self.guide_at(place).map(|guide| self.guided[guide].1)
    }

    /// Which of [`Assembly::guided`] is at a place, if any.
    pub(crate) fn guide_at(&self, place: usize) -> Option<usize> {
        let found = self
            .guided
            .binary_search_by_key(&place, |(of, _)| *of as usize);
        found.ok()
    }

    /// The part of a vector at a free place along which its node can move.
    pub(crate) fn free_part(&self, place: usize, vector: Vector) -> Vector {
        match self.guide_of(place) {
            Some(held) => free_part(held, &vector),
            None => vector,
        }
    }

    /// Places of the nodes of each set, ascending.
    pub(crate) fn sets(&self) -> &[Vec<u32>] {
        &self.sets
    }

    /// The state of the bond in a slot whose ends are displaced by `first` and `second`, (4)-(7).
    #[inline]
    pub(crate) fn respond(&self, slot: usize, first: &Vector, second: &Vector) -> BondState {
        if self.acts(slot) {
            self.respond_intact(slot, first, second)
        } else {
            BondState::default()
        }
    }

    /// The same, as if the bond acted.
    #[inline]
    pub(crate) fn respond_intact(&self, slot: usize, first: &Vector, second: &Vector) -> BondState {
        let ends = self.ends[slot].map(|place| self.positions.at(place as usize));
        let span = ends[1] - ends[0];
        let shift = second - first;
        let rest_length = self.rest_lengths[slot];
        let excess = self.excess.get(slot).copied().unwrap_or(0.0);
        let vector = span + shift;
        let length = vector.norm();
        let strain =
            (shift.dot(&(span + vector)) + excess) / ((length + rest_length) * rest_length);
        let law: BondLaw = self.laws.of(slot);
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

/// The slot of each of so many bonds, given the bond in each slot.
fn slots_of(bonds: &[u32], count: usize) -> Vec<u32> {
    let mut slots = vec![NONE; count];
    for (slot, bond) in bonds.iter().enumerate() {
        if *bond != NONE {
            slots[*bond as usize] = slot as u32;
        }
    }
    slots
}
