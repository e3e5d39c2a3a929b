//! Networks of bonds in equilibrium.
//!
//! **Model.** Nodes are points, bonds are straight and carry force along their line only. Some
//! nodes are held by the bottom jaw, which rests, some by the top jaw, which moves along +y, and some
//! may belong to other sets that are held along some axes ([`boundary`]). The
//! state of a network is the displacement of each node and whether each bond is intact.
//!
//! With X the initial vector from a bond's first node to its second, w the difference of their
//! displacements, l = |X + w| and n = (X + w)/l:
//!
//! - strain u = (l − l₀)/l₀; in floating point l − l₀ = (w·(2X + w) + |X|² − l₀²)/(l + l₀) (4),
//!   which keeps full relative precision however small the strain is;
//! - energy E = Σ l₀ φ(u) with φ of [`law::BondLaw::energy`] (5);
//! - force on the second node −T n, on the first +T n; the resultant of a node is −∂E/∂x (6);
//! - stiffness between the two nodes K = a n nᵀ + b (1 − n nᵀ), a = T'/l₀, b = T/l (7). In
//!   compression b < 0: bonds buckle, and E is not convex.
//!
//! **Data road.** [`Network`] is what a generator or a spec builds once and nothing changes after.
//! [`assembly`] packs it for the solvers, free nodes between held ones, with its bonds in the
//! [`blocks`] that vector instructions like. [`load_path`] finds which nodes hang between both
//! jaws; only intact bonds among these act, the others stay where they are and do nothing. A
//! [`configuration`] is an assembly at some displacements: energy, forces and the [`stiffness`] that
//! Newton's method follows. [`equilibrium`] moves the free nodes until their resultants vanish.
//! [`rupture`] says which bonds break then. The test itself (steps, curve, files) belongs to the
//! material: [`nonwoven`].
//!
//! **Parts without load.** What hangs on one jaw only, or on none, cannot carry force from jaw to
//! jaw: in equilibrium its pull on the jaw is zero. Such parts keep their shape, follow the jaw
//! they hang on, count as unloaded, and cost nothing. Bonds between two nodes of one jaw never
//! change length and count as unloaded as well.
pub(crate) mod assembly;
mod blocks;
pub(crate) mod boundary;
pub(crate) mod configuration;
pub(crate) mod equilibrium;
pub(crate) mod field;
mod incidence;
pub(crate) mod law;
pub(crate) mod load_path;
pub mod nonwoven;
mod places;
mod response;
mod rounded;
pub(crate) mod rupture;
#[cfg(test)]
mod sample;
mod stiffness;
mod strips;
mod sums;

use boundary::{Hold, Set};
use law::BondLaw;

/// A point or vector in space [mm], a force [N].
pub(crate) type Vector = nalgebra::Vector3<f64>;

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
