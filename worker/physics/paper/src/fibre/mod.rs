//! One fibre: a round hollow tube, as a mesh of points and springs, at rest under loads.
//!
//! In the order in which it is used: [`Section`] and [`Elasticity`] say what the fibre is; [`divide`]
//! finds the length of its segments and the stiffness of its springs, which the closed forms of
//! [`springs`] give and the signs of [`window`] bound; [`Tube`] holds points and springs; in
//! [`equilibrium`] it comes to rest, and [`measure`] reads E, ν, G, E I and the buckling load off.
//!
//! Knows no sheet, no bond, no job, and no time.
mod equations;
pub mod equilibrium;
mod error;
pub mod measure;
mod section;
pub mod springs;
mod tube;
pub mod window;

#[cfg(test)]
mod tests;

pub use error::FibreError;
pub use section::{Elasticity, Ring, Section, WALL_DENSITY_KG_PER_M3};
pub use springs::{Segment, Springs};
pub use tube::{Sort, Spring, Tube, half_angle};
pub use window::{Divided, Division, OnInadmissible, Window, divide};
