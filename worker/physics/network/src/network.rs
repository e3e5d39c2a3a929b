//! Networks of bonds as they are built once.
use crate::Vector;
use crate::boundary::{Hold, Set};
use crate::law::BondLaw;

/// Nodes and bonds before the test.
#[derive(Clone, Debug)]
pub(crate) struct Network {
    /// Initial position of each node [mm].
    pub(crate) positions: Vec<Vector>,
    /// What holds each node.
    pub(crate) holds: Vec<Hold>,
    /// The jaws, and other sets of nodes that are held.
    pub(crate) sets: Vec<Set>,
    pub(crate) bonds: Bonds,
    /// Rows of nodes, by ascending number; nodes of no row stand alone.
    pub(crate) rows: Vec<Row>,
}

/// Nodes in a row along x, numbered in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row {
    /// Number of the first node.
    pub(crate) first: u32,
    pub(crate) count: u32,
    /// About where the first node is [mm].
    pub(crate) origin: Vector,
    /// About how far the next is [mm].
    pub(crate) spacing: f64,
}

/// The bonds of a network, one entry per bond in each array.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bonds {
    pub(crate) ends: Vec<[u32; 2]>,
    /// l₀ [mm].
    pub(crate) rest_lengths: Vec<f64>,
    pub(crate) laws: Laws,
    /// Tension at which the bond breaks [N]; infinite for one that never does.
    pub(crate) strengths: Vec<f64>,
}

/// The laws of bonds.
#[derive(Clone, Debug)]
pub(crate) enum Laws {
    /// One for all.
    Same(BondLaw),
    /// One for each.
    Each(Vec<BondLaw>),
}

impl Default for Laws {
    fn default() -> Self {
        Self::Each(Vec::new())
    }
}

impl Laws {
    #[inline]
    pub(crate) fn of(&self, bond: usize) -> BondLaw {
        match self {
            Self::Same(law) => *law,
            Self::Each(laws) => laws[bond],
        }
    }

    /// The largest of a parameter among them, at least zero.
    pub(crate) fn most(&self, parameter: impl Fn(&BondLaw) -> f64) -> f64 {
        match self {
            Self::Same(law) => parameter(law),
            Self::Each(laws) => laws.iter().map(parameter).fold(0.0, f64::max),
        }
    }
}

impl Network {
    /// The set that a node belongs to, if any.
    pub(crate) fn set_of(&self, node: u32) -> Option<&Set> {
        self.holds[node as usize].map(|set| &self.sets[usize::from(set)])
    }

    /// Whether a node is held along all axes.
    pub(crate) fn is_fixed(&self, node: u32) -> bool {
        self.set_of(node).is_some_and(Set::is_fixed)
    }

    /// Mean y of the nodes of a jaw [mm], `None` when it holds none.
    pub(crate) fn jaw_height(&self, jaw: u16) -> Option<f64> {
        let nodes = self.positions.iter().zip(&self.holds);
        let heights = nodes
            .filter(|(_, hold)| **hold == Some(jaw))
            .map(|(position, _)| position.y);
        let (sum, count) = heights.fold((0.0, 0), |(sum, count), y| (sum + y, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }
}

impl Bonds {
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Mean of the rest lengths [mm].
    pub(crate) fn mean_rest_length(&self) -> f64 {
        self.rest_lengths.iter().sum::<f64>() / self.len() as f64
    }
}
