//! Which part of a network hangs between sets of held nodes.
use loadframe_api::DisjointSets;

use super::Network;

/// What a node hangs on, through intact bonds and nodes that are free along some axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Several sets, such as both jaws: it carries load.
    Loaded,
    /// This set only, or fixed in it: it moves with it.
    With(u16),
    /// Nothing: it rests.
    AtRest,
}

impl Part {
    /// Together with a set.
    fn and(self, set: u16) -> Self {
        match self {
            Self::AtRest => Self::With(set),
            Self::With(own) if own == set => self,
            Self::With(_) | Self::Loaded => Self::Loaded,
        }
    }
}

/// The part each node belongs to.
pub(crate) fn parts(network: &Network, intact: &[bool]) -> Vec<Part> {
    let nodes = network.positions.len() as u32;
    let intact_bonds = || {
        let bonds = network.bonds.ends.iter().zip(intact);
        bonds.filter(|(_, intact)| **intact).map(|(ends, _)| *ends)
    };
    // fixed nodes do not join parts, they only mark them: two parts on one jaw stay apart
    let mut sets = DisjointSets::new(nodes as usize);
    for [first, second] in intact_bonds() {
        if !network.is_fixed(first) && !network.is_fixed(second) {
            sets.join(first, second);
        }
    }
    let mut reached = vec![Part::AtRest; nodes as usize];
    let mut reach = |node: u32, set: u16| {
        let part = &mut reached[sets.root(node) as usize];
        *part = part.and(set);
    };
    for [first, second] in intact_bonds() {
        for (node, other) in [(first, second), (second, first)] {
            if let Some(set) = network.holds[other as usize] {
                reach(node, set);
            }
        }
    }
    // a node that a guide holds hangs on it without a bond
    for node in 0..nodes {
        if let Some(set) = network.holds[node as usize] {
            reach(node, set);
        }
    }
    let part = |node: u32| match network.holds[node as usize] {
        Some(set) if network.is_fixed(node) => Part::With(set),
        _ => reached[sets.root(node) as usize],
    };
    (0..nodes).map(part).collect()
}

/// Whether an intact bond with these `ends` carries load, given the parts of all nodes.
pub(crate) fn carries_load(network: &Network, parts: &[Part], ends: [u32; 2]) -> bool {
    let are_loaded = ends.map(|node| parts[node as usize] == Part::Loaded);
    let holds = ends.map(|node| network.holds[node as usize]);
    are_loaded[0]
        || are_loaded[1]
        || (ends.iter().all(|node| network.is_fixed(*node)) && holds[0] != holds[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Bonds, Vector,
        boundary::{BOTTOM, Hold, Set, TOP},
    };

    fn network(holds: &[Hold], ends: &[[u32; 2]]) -> Network {
        Network {
            positions: vec![Vector::zeros(); holds.len()],
            holds: holds.to_vec(),
            bonds: Bonds {
                ends: ends.to_vec(),
                ..Bonds::default()
            },
            sets: Set::jaws(),
            rows: Vec::new(),
        }
    }

    #[test]
    fn parts_follow_the_intact_bonds() {
        let (bottom, top, free) = (Some(BOTTOM), Some(TOP), None);
        // 0 bottom - 2 - 3 - top 1, 4 hangs on the top jaw, 5 on the bottom jaw, 6 on nothing
        let holds = [bottom, top, free, free, free, free, free];
        let ends = [[0, 2], [2, 3], [3, 1], [4, 1], [0, 5]];
        let network = network(&holds, &ends);
        let whole = parts(&network, &[true; 5]);
        assert_eq!(whole[2..4], [Part::Loaded; 2]);
        assert_eq!(
            whole[4..],
            [Part::With(TOP), Part::With(BOTTOM), Part::AtRest]
        );
        let cut = parts(&network, &[true, false, true, true, true]);
        assert_eq!(cut[2..4], [Part::With(BOTTOM), Part::With(TOP)]);
    }

    #[test]
    fn a_bond_from_jaw_to_jaw_carries_load_and_one_within_a_jaw_does_not() {
        let network = network(&[Some(BOTTOM), Some(TOP), Some(TOP)], &[[0, 1], [1, 2]]);
        let parts = parts(&network, &[true, true]);
        assert!(carries_load(&network, &parts, [0, 1]));
        assert!(!carries_load(&network, &parts, [1, 2]));
    }
}
