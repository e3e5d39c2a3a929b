//! A fibre as numbers: what a spec is checked with before a job is taken, and what the engine builds on.
//!
//! [`Section`] and [`Elasticity`] say what the fibre is; [`divide`] finds the length of its segments and
//! the stiffness of its springs, which the closed forms of [`springs`] give and the signs of [`window`]
//! bound; [`ring_centres`] places rings along a line. Lengths are in µm, forces in mN, moduli in GPa = mN/µm².
mod error;
mod line;
mod section;
pub mod springs;
pub mod window;

pub use error::FibreError;
pub use line::{line_length_um, ring_centres};
pub use section::{Elasticity, Ring, Section, WALL_DENSITY_KG_PER_M3};
pub use springs::{Segment, Springs};
pub use window::{Divided, Division, OnInadmissible, Window, divide, divide_piece};
