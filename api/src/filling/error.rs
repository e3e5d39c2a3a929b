//! What can go wrong when a shape is filled.
use crate::surface::{Seams, StlError};

/// Why a shape cannot be filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FillError {
    #[error(transparent)]
    Stl(#[from] StlError),
    #[error("the surface is not closed: {} boundary edges and {} edges between triangles of opposite orientation", .0.boundary_edges, .0.misoriented_edges)]
    NotClosed(Seams),
    #[error("no sphere of radius {0} m fits into the shape")]
    NothingFits(f64),
}
