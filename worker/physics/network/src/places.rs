//! Where the kernels keep each node.
//!
//! First the nodes held along all axes that rest, those of the bottom jaw, then the free ones, then those
//! that move, of the top jaw, so that unknowns are a slice and no loop asks what is held. Nodes held along
//! some axes are among the free ones, and few. Free nodes keep their order; rows of
//! them begin at equal distances, which lets bonds that lie side by side in one row go on side by
//! side in the next. The places this leaves over belong to no node, and neither do the last
//! [`LANES`] or more, which vectors may touch: their number is whole vectors.
use std::ops::Range;

use super::{Network, Row, boundary::Set, field::LANES};

/// Stands for no node and for no bond.
pub(crate) const NONE: u32 = u32::MAX;

#[derive(Clone, Debug)]
pub(crate) struct Places {
    /// Number in the network of the node at each place, or [`NONE`].
    pub(crate) nodes: Vec<u32>,
    /// Place of each node of the network.
    pub(crate) of: Vec<u32>,
    /// From the first to the last free node.
    pub(crate) free: Range<usize>,
    /// Rows of free nodes and where they begin, in order.
    pub(crate) rows: Vec<(usize, Row)>,
}

impl Places {
    pub(crate) fn new(network: &Network) -> Self {
        let count = network.positions.len();
        let mut places = Self {
            nodes: Vec::with_capacity(count + LANES),
            of: vec![NONE; count],
            free: 0..0,
            rows: Vec::new(),
        };
        places.take_fixed(network, Set::is_at_rest);
        places.take_free(network);
        places.take_fixed(network, |set| !set.is_at_rest());
        places.fill_up();
        places
    }

    fn fill_up(&mut self) {
        let whole = (self.nodes.len() + LANES).next_multiple_of(LANES);
        self.nodes.resize(whole, NONE);
    }

    fn take(&mut self, node: u32) {
        let place = &mut self.of[node as usize];
        if *place == NONE {
            *place = self.nodes.len() as u32;
            self.nodes.push(node);
        }
    }

    /// In the order of their bonds, so that bonds side by side are so at the jaws too.
    fn take_fixed(&mut self, network: &Network, is_wanted: impl Fn(&Set) -> bool) {
        let met = network.bonds.ends.iter().flatten().copied();
        let all = met.chain(0..network.positions.len() as u32);
        let is_wanted = |node: u32| {
            let set = network.set_of(node);
            set.is_some_and(|set| set.is_fixed() && is_wanted(set))
        };
        all.filter(|node| is_wanted(*node))
            .for_each(|node| self.take(node));
    }

    fn take_free(&mut self, network: &Network) {
        let first = self.nodes.len();
        let is_free = |node: u32| !network.is_fixed(node);
        let width = network.rows.iter().map(|row| row.count as usize).max();
        let mut rows = network.rows.iter().peekable();
        for node in 0..network.positions.len() as u32 {
            let begins = |row: &&Row| row.first == node;
            let row = rows.next_if(begins);
            if !is_free(node) {
                continue;
            }
            if let (Some(row), Some(width)) = (row, width) {
                let taken = self.nodes.len() - first;
                let begin = first + taken.next_multiple_of(width);
                self.nodes.resize(begin, NONE);
                self.rows.push((begin, *row));
            }
            self.take(node);
        }
        self.free = first..self.nodes.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Bonds, Vector,
        boundary::{BOTTOM, TOP},
    };

    #[test]
    fn rows_of_free_nodes_begin_at_equal_distances_between_the_held_nodes() {
        let row = |first, count| Row {
            first,
            count,
            origin: Vector::zeros(),
            spacing: 1.0,
        };
        let network = Network {
            positions: vec![Vector::zeros(); 8],
            holds: vec![Some(TOP), None, None, None, None, None, Some(BOTTOM), None],
            sets: Set::jaws(),
            bonds: Bonds::default(),
            rows: vec![row(1, 2), row(3, 3)],
        };
        let places = Places::new(&network);
        assert_eq!(places.nodes[..9], [6, 1, 2, NONE, 3, 4, 5, 7, 0]);
        assert_eq!(places.nodes[9..], [NONE; 2 * LANES - 9]);
        assert_eq!(places.free, 1..8);
        assert_eq!(places.of, [8, 1, 2, 4, 5, 6, 0, 7]);
    }
}
