//! Why a tube has no rest.
use loadframe_api::fibre::FibreError;
use thiserror::Error;

/// Why there is no tube, or no rest of it.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TubeError {
    /// There is no such fibre.
    #[error(transparent)]
    Fibre(#[from] FibreError),
    /// The tube has no stable equilibrium under its supports.
    #[error("point {point} of the tube is held by nothing, or gives way")]
    Unstable { point: usize },
    /// The factor of the equations does not fit into memory.
    #[error("the equations of {points} points do not fit into memory")]
    TooLarge { points: usize },
    /// Forces could not be balanced.
    #[error(
        "no equilibrium at a displacement of {displacement_um} µm: residual {residual:e} of the largest \
         force after {rounds} rounds, allowed {limit:e}"
    )]
    NotConverged {
        displacement_um: f64,
        residual: f64,
        limit: f64,
        rounds: u32,
    },
    /// The tube does not buckle, or its mode was not found.
    #[error("no buckling load was found in {rounds} rounds; the last change was {change:e}")]
    NoBuckling { rounds: u32, change: f64 },
}
