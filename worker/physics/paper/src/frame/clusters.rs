//! What hangs together, and whether it reaches the jaws.
use loadframe_api::DisjointSets;

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

/// Which clusters are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clusters {
    /// Those between both jaws: a pull stretches no others.
    Spanning,
    /// All that a jaw holds: loads bend these, too.
    Held,
}

impl Clusters {
    /// Whether a node of this standing is solved for.
    pub(crate) fn include(self, standing: Standing) -> bool {
        match self {
            Self::Spanning => standing == Standing::Spanning,
            Self::Held => standing != Standing::Loose,
        }
    }
}

/// The standing of every node, from what joins them.
pub(crate) fn standings(
    jaws: &[Option<Jaw>],
    joined: impl Iterator<Item = [u32; 2]>,
) -> Vec<Standing> {
    let mut sets = DisjointSets::new(jaws.len());
    for [a, b] in joined {
        sets.join(a, b);
    }
    let mut held = vec![[false; 2]; jaws.len()];
    for (node, jaw) in jaws.iter().enumerate() {
        if let Some(jaw) = jaw {
            held[sets.root(node as u32) as usize][usize::from(*jaw == Jaw::Right)] = true;
        }
    }
    (0..jaws.len() as u32)
        .map(|node| match held[sets.root(node) as usize] {
            [false, false] => Standing::Loose,
            [true, false] => Standing::Hanging(Jaw::Left),
            [false, true] => Standing::Hanging(Jaw::Right),
            [true, true] => Standing::Spanning,
        })
        .collect()
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
