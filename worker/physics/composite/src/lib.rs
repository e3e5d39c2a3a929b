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

pub use loadframe_api::section::{error, material, stiffness};
