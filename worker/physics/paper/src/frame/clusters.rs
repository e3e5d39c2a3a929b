//! What hangs together, and whether it reaches the jaws.
use super::places::Jaw;

/// What a node's cluster is held by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// By no jaw: it carries nothing.
    Loose,
    /// By one jaw: it goes with it.
    Hanging(Jaw),
    /// By both: it is stretched.
    Spanning,
}

/// The standing of every node, from what joins them.
pub(crate) fn standings(
    jaws: &[Option<Jaw>],
    joined: impl Iterator<Item = [u32; 2]>,
) -> Vec<Standing> {
    let mut parents: Vec<u32> = (0..jaws.len() as u32).collect();
    for [a, b] in joined {
        let (a, b) = (root(&mut parents, a), root(&mut parents, b));
        // the lower number leads: trees stay shallow by halving, and the result has no order
        parents[a.max(b) as usize] = a.min(b);
    }
    let mut held = vec![[false; 2]; jaws.len()];
    for (node, jaw) in jaws.iter().enumerate() {
        if let Some(jaw) = jaw {
            let root = root(&mut parents, node as u32);
            held[root as usize][usize::from(*jaw == Jaw::Right)] = true;
        }
    }
    (0..jaws.len() as u32)
        .map(|node| match held[root(&mut parents, node) as usize] {
            [false, false] => Standing::Loose,
            [true, false] => Standing::Hanging(Jaw::Left),
            [false, true] => Standing::Hanging(Jaw::Right),
            [true, true] => Standing::Spanning,
        })
        .collect()
}

fn root(parents: &mut [u32], mut node: u32) -> u32 {
    while parents[node as usize] != node {
        let above = parents[parents[node as usize] as usize];
        parents[node as usize] = above;
        node = above;
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_know_the_jaws_that_hold_them() {
        let jaws = [
            Some(Jaw::Left),
            None,
            None,
            Some(Jaw::Right),
            None,
            None,
            None,
            Some(Jaw::Right),
        ];
        let joined = [[2, 1], [0, 1], [2, 3], [5, 4], [7, 6]];
        let found = standings(&jaws, joined.into_iter());
        use Standing::{Hanging, Loose, Spanning};
        let right = Hanging(Jaw::Right);
        assert_eq!(
            found,
            [
                Spanning, Spanning, Spanning, Spanning, Loose, Loose, right, right
            ]
        );
        let cut = standings(&jaws, joined.into_iter().filter(|pair| *pair != [2, 1]));
        let left = Hanging(Jaw::Left);
        assert_eq!(cut, [left, left, right, right, Loose, Loose, right, right]);
    }
}
