//! Nodes in groups that hang together, by the stiffest links first.
//!
//! A motion that is the same for a group cannot strain it: what a smooth motion strains is then all between
//! groups. That costs little where links inside are stiff and those between are soft, and much the other way
//! round: two bonds that are nearly at one place have a segment between them that is a thousand times as
//! stiff as others. So links are taken from the stiffest to the softest, as minimum spanning trees
//! are built [Kruskal1956], and each joins two groups unless these would be too large together; what is left
//! over goes to its neighbours then. Strength of links is what groups go by in algebraic multigrid methods, too,
//! and so is what becomes of the rest [VanekMandelBrezina1996].
use loadframe_api::DisjointSets;

/// A group that has found no room, and is smaller than this part of what others may be, goes to its stiffest
/// neighbour, however large that is. In a sheet of beams of 55 000 nodes three of four groups were such, and with them
/// went three of four numbers of the factor: 92 iterations without them, 93 with.
const LEFT_OVER: u32 = 4;

/// Not in any group.
pub(super) const NONE: u32 = u32::MAX;

/// What joins two nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    pub(super) stiffness: f64,
    pub(super) nodes: [u32; 2],
}

/// Free nodes, each in one group.
#[derive(Debug)]
pub(super) struct Groups {
    pub(super) of_node: Vec<u32>,
    /// Nodes of each group: `nodes[first[group]..first[group + 1]]`.
    first: Vec<u32>,
    nodes: Vec<u32>,
}

impl Groups {
    /// Joins free nodes to groups of about `most`. Of equally stiff links the first given comes first.
    pub(super) fn new(is_free: &[bool], mut links: Vec<Link>, most: u32) -> Self {
        links.retain(|link| link.nodes.iter().all(|&node| is_free[node as usize]));
        links.sort_by(|a, b| b.stiffness.total_cmp(&a.stiffness));
        let mut sets = DisjointSets::new(is_free.len());
        let mut sizes = vec![1; is_free.len()];
        for least in [0, most / LEFT_OVER] {
            for link in &links {
                let [a, b] = link.nodes.map(|node| sets.root(node));
                let [of_a, of_b] = [a, b].map(|root| sizes[root as usize]);
                if a != b && (of_a + of_b <= most || of_a.min(of_b) < least) {
                    sets.join(a, b);
                    sizes[sets.root(a) as usize] = of_a + of_b;
                }
            }
        }
        let mut of_root = vec![NONE; is_free.len()];
        let mut of_node = vec![NONE; is_free.len()];
        let mut first = vec![0];
        for node in (0..is_free.len()).filter(|&node| is_free[node]) {
            let group = &mut of_root[sets.root(node as u32) as usize];
            if *group == NONE {
                *group = first.len() as u32 - 1;
                first.push(0);
            }
            of_node[node] = *group;
            first[*group as usize + 1] += 1;
        }
        for group in 1..first.len() {
            first[group] += first[group - 1];
        }
        let mut next = first.clone();
        let mut nodes = vec![0; first[first.len() - 1] as usize];
        for (node, &group) in of_node.iter().enumerate() {
            if group != NONE {
                nodes[next[group as usize] as usize] = node as u32;
                next[group as usize] += 1;
            }
        }
        Self {
            of_node,
            first,
            nodes,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// Nodes of a group, ascending.
    pub(super) fn nodes(&self, group: usize) -> &[u32] {
        &self.nodes[self.first[group] as usize..self.first[group + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes in a row, with these stiffnesses between them.
    fn row<const N: usize>(stiffness: [f64; N]) -> Vec<Link> {
        let links = stiffness.into_iter().zip(0..);
        links
            .map(|(stiffness, at)| Link {
                stiffness,
                nodes: [at, at + 1],
            })
            .collect()
    }

    #[test]
    fn the_stiffest_links_are_inside_groups() {
        let links = row([1.0, 9.0, 2.0, 8.0, 3.0]);
        // 9 joins 1 and 2, 8 joins 3 and 4; 3 makes 3, 4, 5; then 1 makes 0, 1, 2, for 2 would make five
        let groups = Groups::new(&[true; 6], links, 3);
        assert_eq!(groups.of_node, [0, 0, 0, 1, 1, 1]);
        assert_eq!(groups.nodes(1), [3, 4, 5]);
    }

    #[test]
    fn what_is_left_over_goes_to_its_stiffest_neighbour() {
        // groups of four on both sides, and one between that has no room in either
        let links = row([9.0, 9.0, 9.0, 2.0, 3.0, 9.0, 9.0, 9.0]);
        let groups = Groups::new(&[true; 9], links.clone(), 4);
        assert_eq!(groups.of_node, [0, 0, 0, 0, 1, 2, 2, 2, 2]);
        let wide = row([
            9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 2.0, 3.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0,
        ]);
        let groups = Groups::new(&[true; 17], wide, 8);
        assert_eq!(groups.len(), 2);
        assert_eq!(groups.nodes(1).len(), 9);
    }

    #[test]
    fn held_nodes_are_in_no_group_and_lone_ones_in_their_own() {
        let mut is_free = [true; 5];
        is_free[2] = false;
        let groups = Groups::new(&is_free, row([1.0, 1.0, 1.0]), 4);
        assert_eq!(groups.of_node, [0, 0, NONE, 1, 2]);
        assert_eq!(groups.len(), 3);
    }
}
