//! The order in which nodes are eliminated: nested dissection by where they are.
//!
//! The nodes are halved at the median of x or y, whichever spreads more; those of one half that have a
//! neighbour in the other separate the halves and come last. Segments between bonds are short, so that
//! few nodes do ([George1973] for grids). Leaves come as they are numbered, along their fibres.

/// So many nodes are not cut further.
const SMALLEST: usize = 16;

/// Node `i` at `places[i]` has the neighbours `neighbours[starts[i]..starts[i + 1]]`.
pub(crate) struct Graph<'a> {
    pub(crate) places: &'a [[f64; 2]],
    pub(crate) starts: &'a [u32],
    pub(crate) neighbours: &'a [u32],
}

/// All nodes in order of elimination.
pub(crate) fn nested_dissection(graph: &Graph) -> Vec<u32> {
    let mut nodes: Vec<u32> = (0..graph.places.len() as u32).collect();
    let mut order = Vec::with_capacity(nodes.len());
    // of each node: the half that it was last put in
    let mut half = vec![0; nodes.len()];
    let mut halves = 0;
    dissect(graph, &mut nodes, &mut half, &mut halves, &mut order);
    order
}

fn dissect(
    graph: &Graph,
    nodes: &mut [u32],
    half: &mut [u32],
    halves: &mut u32,
    order: &mut Vec<u32>,
) {
    if nodes.len() <= SMALLEST {
        nodes.sort_unstable();
        order.extend_from_slice(nodes);
        return;
    }
    let spread = |axis: usize| {
        let along = nodes.iter().map(|&node| graph.places[node as usize][axis]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    let axis = usize::from(spread(1) > spread(0));
    let middle = nodes.len() / 2;
    nodes.select_nth_unstable_by(middle, |&a, &b| {
        let [a_at, b_at] = [a, b].map(|node| graph.places[node as usize][axis]);
        a_at.total_cmp(&b_at).then(a.cmp(&b))
    });
    let (first, second) = nodes.split_at_mut(middle);
    let names = [*halves + 1, *halves + 2];
    *halves += 2;
    for (part, name) in [(&*first, names[0]), (&*second, names[1])] {
        for &node in part {
            half[node as usize] = name;
        }
    }
    let touches = |node: u32, name: u32| {
        let range = graph.starts[node as usize] as usize..graph.starts[node as usize + 1] as usize;
        graph.neighbours[range]
            .iter()
            .any(|&other| half[other as usize] == name)
    };
    let border = [(&*first, names[1]), (&*second, names[0])].map(|(part, other)| {
        part.iter()
            .copied()
            .filter(|&node| touches(node, other))
            .collect::<Vec<u32>>()
    });
    let side = usize::from(border[1].len() < border[0].len());
    let [mut separator, other] = border;
    if side == 1 {
        separator = other;
    }
    for &node in &separator {
        half[node as usize] = 0;
    }
    for (part, name) in [(first, names[0]), (second, names[1])] {
        let mut rest: Vec<u32> = part
            .iter()
            .copied()
            .filter(|&node| half[node as usize] == name)
            .collect();
        dissect(graph, &mut rest, half, halves, order);
    }
    separator.sort_unstable();
    order.extend(separator);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_has_one_place_and_separators_come_last() {
        // a chain of 64 nodes along x
        let places: Vec<[f64; 2]> = (0..64).map(|i| [f64::from(i), 0.0]).collect();
        let mut starts = vec![0];
        let mut neighbours = Vec::new();
        for i in 0..64_u32 {
            neighbours.extend(i.checked_sub(1));
            neighbours.extend((i < 63).then_some(i + 1));
            starts.push(neighbours.len() as u32);
        }
        let graph = Graph {
            places: &places,
            starts: &starts,
            neighbours: &neighbours,
        };
        let order = nested_dissection(&graph);
        assert_eq!(order[63], 31, "the last of the first half cuts the chain");
        let mut all = order;
        all.sort_unstable();
        assert_eq!(all, (0..64).collect::<Vec<u32>>());
    }
}
