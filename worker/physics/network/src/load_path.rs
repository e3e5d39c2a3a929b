//! Which part of a network hangs between both jaws.
use loadframe_api::DisjointSets;

use super::{Hold, Network};

/// What a node hangs on, through intact bonds and free nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Both jaws: it carries load.
    Loaded,
    /// The top jaw only, or held by it: it moves with it.
    WithTop,
    /// The bottom jaw only, or held by it, or on nothing: it rests.
    AtRest,
}

const BOTTOM: u8 = 1;
const TOP: u8 = 2;

/// The part each node belongs to.
pub(crate) fn parts(network: &Network, intact: &[bool]) -> Vec<Part> {
    let nodes = network.positions.len();
    let hold = |node: u32| network.holds[node as usize];
    let intact_bonds = || {
        let bonds = network.bonds.ends.iter().zip(intact);
        bonds.filter(|(_, intact)| **intact).map(|(ends, _)| *ends)
    };
    // jaws do not join parts, they only mark them: two parts on one jaw stay apart
    let mut sets = DisjointSets::new(nodes);
    for [first, second] in intact_bonds() {
        if hold(first) == Hold::Free && hold(second) == Hold::Free {
            sets.join(first, second);
        }
    }
    let mut reached = vec![0; nodes];
    for [first, second] in intact_bonds() {
        for (node, other) in [(first, second), (second, first)] {
            reached[sets.root(node) as usize] |= match hold(other) {
                Hold::Free => 0,
                Hold::Bottom => BOTTOM,
                Hold::Top => TOP,
            };
        }
    }
    let part = |node| match (hold(node), reached[sets.root(node) as usize]) {
        (Hold::Top, _) | (Hold::Free, TOP) => Part::WithTop,
        (Hold::Free, both) if both == BOTTOM | TOP => Part::Loaded,
        _ => Part::AtRest,
    };
    (0..nodes as u32).map(part).collect()
}

/// Whether an intact bond with these `ends` carries load, given the parts of all nodes.
pub(crate) fn carries_load(network: &Network, parts: &[Part], ends: [u32; 2]) -> bool {
    let [first, second] = ends.map(|node| node as usize);
    let holds = [network.holds[first], network.holds[second]];
    parts[first] == Part::Loaded
        || parts[second] == Part::Loaded
        || holds == [Hold::Bottom, Hold::Top]
        || holds == [Hold::Top, Hold::Bottom]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bonds, Vector};

    fn network(holds: &[Hold], ends: &[[u32; 2]]) -> Network {
        Network {
            positions: vec![Vector::zeros(); holds.len()],
            holds: holds.to_vec(),
            bonds: Bonds {
                ends: ends.to_vec(),
                ..Bonds::default()
            },
            rows: Vec::new(),
        }
    }

    #[test]
    fn parts_follow_the_intact_bonds() {
        use Hold::{Bottom, Free, Top};
        // 0 bottom - 2 - 3 - top 1, 4 hangs on the top jaw, 5 on the bottom jaw, 6 on nothing
        let holds = [Bottom, Top, Free, Free, Free, Free, Free];
        let ends = [[0, 2], [2, 3], [3, 1], [4, 1], [0, 5]];
        let network = network(&holds, &ends);
        let whole = parts(&network, &[true; 5]);
        assert_eq!(whole[2..4], [Part::Loaded; 2]);
        assert_eq!(whole[4..], [Part::WithTop, Part::AtRest, Part::AtRest]);
        let cut = parts(&network, &[true, false, true, true, true]);
        assert_eq!(cut[2..4], [Part::AtRest, Part::WithTop]);
    }

    #[test]
    fn a_bond_from_jaw_to_jaw_carries_load_and_one_within_a_jaw_does_not() {
        let network = network(&[Hold::Bottom, Hold::Top, Hold::Top], &[[0, 1], [1, 2]]);
        let parts = parts(&network, &[true, true]);
        assert!(carries_load(&network, &parts, [0, 1]));
        assert!(!carries_load(&network, &parts, [1, 2]));
    }
}
