//! Sheets of paper: hollow fibres that touch and are bonded.
//!
//! From the bottom up: [`fibre`] is one fibre, its section and the mass-spring tube that stands for
//! it; [`sheet`] lays fibres down and finds where they touch; [`frame`] holds beams or bars together
//! by bonds, pulls, and breaks.
//!
//! Units throughout: lengths in µm, forces in mN, moduli and stresses in GPa = mN/µm², energies in
//! nJ = mN µm, masses in µg, times in µs.
pub mod fibre;
pub mod frame;
pub mod sheet;
pub mod tensile;
