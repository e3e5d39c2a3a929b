//! The bonds of each node.
use std::ops::Range;

/// For each node its bonds by ascending number: the order in which a loop over bonds would reach
/// it, so that gathering per node and scattering per bond give the same bits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Incidence {
    starts: Vec<u32>,
    bonds: Vec<u32>,
    /// The node at the other end of each.
    others: Vec<u32>,
}

impl Incidence {
    /// Of the bonds that `is_bond` says are some.
    pub(crate) fn new(nodes: usize, ends: &[[u32; 2]], is_bond: impl Fn(usize) -> bool) -> Self {
        let bonds = || ends.iter().enumerate().filter(|(bond, _)| is_bond(*bond));
        let mut starts = vec![0; nodes + 1];
        for node in bonds().flat_map(|(_, ends)| ends) {
            starts[*node as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut of_nodes = vec![0; starts[nodes] as usize];
        let mut others = of_nodes.clone();
        for (bond, [first, second]) in bonds() {
            for (node, other) in [(first, second), (second, first)] {
                let place = &mut next[*node as usize];
                of_nodes[*place as usize] = bond as u32;
                others[*place as usize] = *other;
                *place += 1;
            }
        }
        Self {
            starts,
            bonds: of_nodes,
            others,
        }
    }

    /// The bonds of `node`, ascending.
    pub(crate) fn of(&self, node: usize) -> &[u32] {
        &self.bonds[self.range(node)]
    }

    /// The same, each with the node at its other end.
    pub(crate) fn around(&self, node: usize) -> impl Iterator<Item = (u32, u32)> {
        let range = self.range(node);
        let bonds = self.bonds[range.clone()].iter().copied();
        bonds.zip(self.others[range].iter().copied())
    }

    fn range(&self, node: usize) -> Range<usize> {
        self.starts[node] as usize..self.starts[node + 1] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bond_is_found_at_both_ends_in_order() {
        let ends = [[2, 0], [0, 1], [0, 0], [1, 2]];
        let incidence = Incidence::new(4, &ends, |bond| bond != 2);
        assert_eq!(incidence.of(0), [0, 1]);
        assert_eq!(incidence.of(1), [1, 3]);
        assert_eq!(incidence.of(2), [0, 3]);
        assert!(incidence.of(3).is_empty());
        assert_eq!(incidence.around(2).collect::<Vec<_>>(), [(0, 0), (3, 1)]);
    }
}
