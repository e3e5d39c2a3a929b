pub mod error;
pub mod flexure;
pub mod lattice;
pub mod load;
pub mod material;
mod matrix;
pub mod measure;
pub mod motion;
pub mod section;
pub mod solve;
pub mod stiffness;
pub mod supports;
#[cfg(test)]
mod tests;
