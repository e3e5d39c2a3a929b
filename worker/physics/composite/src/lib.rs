//! Sections of composites: fibres in a matrix as a lattice of bonded particles.
//!
//! From the bottom up: [`section`] lays what is described on a grid, [`lattice`] holds the particles
//! together, [`supports`] and [`load`] act on them, [`solve`] finds their rest and [`motion`] moves them
//! in time, [`measure`] reads off, [`flexure`] bends on rollers, [`breaking`] lets parts crack one by
//! one. [`bending`] is the job that calls them.
pub mod bending;
pub mod breaking;
pub mod cell;
pub mod flexure;
pub mod homogenise;
pub mod lattice;
pub mod load;
mod matrix;
pub mod measure;
pub mod motion;
pub mod section;
pub mod solve;
pub mod supports;
#[cfg(test)]
mod tests;

pub use loadframe_api::section::{error, material, stiffness, strength};
