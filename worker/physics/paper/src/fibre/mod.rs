//! One fibre: a round hollow tube, as a mesh of points and springs, at rest under loads.
//!
//! In the order in which it is used: `loadframe_api::fibre` says what the fibre is, how it is divided,
//! and how stiff its springs are; [`Tube`] holds points and springs; in [`equilibrium`] it comes to
//! rest, and [`measure`] reads E, ν, G, E I and the buckling load off.
//!
//! Knows no sheet, no bond, no job, and no time.
mod equations;
pub mod equilibrium;
mod error;
pub mod measure;
mod tube;

#[cfg(test)]
mod tests;

pub use error::TubeError;
pub use loadframe_api::fibre::{
    Divided, Division, Elasticity, FibreError, OnInadmissible, Ring, Section, Segment, Springs,
    Window, divide,
};
pub use tube::{Sort, Spring, Tube, half_angle};
