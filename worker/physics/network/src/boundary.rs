//! What is prescribed at the boundary of a network: sets of nodes that move alike.
//!
//! The load parameter is the way λ of the moving jaw [mm]. Along each axis the nodes of a [`Set`] either
//! are free or have the displacement c λ, with a constant c of the set, 0 where it rests. What holds them
//! there are reactions, which are told set by set. The jaws are the two sets that every tensile specimen
//! has; their nodes are held along all axes. A node belongs to one set at most: where two would meet, what
//! is held there is a set of its own.
//!
//! Nodes held along all axes are no unknowns ([`places`](super::places)). Those held along some, *guided*
//! ones, are among the free ones, so that kernels ask of no node what holds it; what its guide takes is put
//! aside after every sum of forces, and the preconditioner moves it along its free axes alone. Of a network
//! without guides neither costs anything.
//!
//! Sections of a composite are held otherwise, displacement by displacement: faces are prescribed, and two of
//! them meet in one particle, each with an axis of its own. What is held there leaves the matrix before it
//! is factored, and reactions are read of faces.
use super::Vector;

/// The jaw at rest, among the sets of a network.
pub(crate) const BOTTOM: u16 = 0;
/// The jaw that moves along +y.
pub(crate) const TOP: u16 = 1;

/// Number of the set that a node belongs to; none for a node that is free along all axes.
pub(crate) type Hold = Option<u16>;

/// Nodes that are held alike.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Set {
    pub(crate) name: String,
    /// c along x, y and z, displacement over λ [-]; none along an axis in which its nodes are free.
    pub(crate) ways: [Option<f64>; 3],
}

impl Set {
    /// The two jaws, [`BOTTOM`] and [`TOP`].
    pub(crate) fn jaws() -> Vec<Self> {
        [("bottom", 0.0), ("top", 1.0)]
            .map(|(name, way)| Self {
                name: name.to_owned(),
                ways: [Some(0.0), Some(way), Some(0.0)],
            })
            .into()
    }

    /// Whether its nodes are held along all axes.
    pub(crate) fn is_fixed(&self) -> bool {
        self.ways.iter().all(Option::is_some)
    }

    /// Whether it goes nowhere.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.ways.iter().flatten().all(|way| *way == 0.0)
    }

    /// Along which axes its nodes are held.
    pub(crate) fn held(&self) -> [bool; 3] {
        self.ways.map(|way| way.is_some())
    }

    /// Displacement at λ [mm] along the axes that it holds, 0 along the others.
    pub(crate) fn displacement(&self, load: f64) -> Vector {
        Vector::from(self.ways.map(|way| way.unwrap_or(0.0) * load))
    }
}

/// The part of a vector along the axes that are not `held`.
pub(crate) fn free_part(held: [bool; 3], vector: &Vector) -> Vector {
    Vector::from_fn(|axis, _| if held[axis] { 0.0 } else { vector[axis] })
}

#[cfg(test)]
mod tests;
