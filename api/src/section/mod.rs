//! Sections of composites as geometry and material: what a spec is checked with before a job is
//! taken, and what the engine builds on.
//!
//! [`material`] turns elastic constants into plane [`stiffness`]; [`fibre`] makes bands of fibres as
//! [`polygon`]s and finds those that overlap; [`lines`] are those of particles, [`solving`]
//! says by which way their equations are solved, [`contact`] how wide rollers press, [`error`] what is wrong.
pub mod contact;
pub mod error;
pub mod fibre;
pub mod lines;
pub mod material;
pub mod polygon;
pub mod settling;
pub mod solving;
pub mod stiffness;
pub mod strength;
