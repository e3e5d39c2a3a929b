//! Ways to equilibrium.
pub(crate) mod direct;
mod equations;
pub(crate) mod equilibrium;
pub(crate) mod multigrid;
mod order;

pub use equations::{LARGEST_FACTORED, Method};
pub use equilibrium::{Equilibrium, LoadPath, PathState, StaticOptions, equilibrium};
