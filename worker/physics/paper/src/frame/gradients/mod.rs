//! Rest of a large network without a factor of all of it: preconditioned conjugate gradients.
//!
//! `operator` applies the stiffness element by element, without a matrix. The preconditioner is a `cycle`
//! of two levels: `chains`, each fibre by itself with its bonds held at their other ends, solved exactly by
//! blocks along the fibre; and `bodies`, groups of some fifty nodes as rigid bodies, all at once,
//! by a Cholesky factor, `groups` being what hangs together by stiff links; `coupling` is what bonds do between
//! fibres, `points` how these hang on the nodes of beams and of bars, and `scalar` in which numbers all this is done. Together they leave about as
//! many iterations whatever the size of the sheet, as two levels do in networks [GortzHellmanMalqvist2024].
//! `system` iterates with both, as [`loadframe_numerics::equilibrium`] does, to an error in energy; `rest`
//! starts from the last equilibrium, stops when what breaks next is known well enough, and takes out what
//! breaks.
//!
//! Passes are shared among threads by fixed pieces, sums go in a fixed order: the bits do not know
//! the number of threads.
mod bodies;
mod chains;
mod coupling;
mod cycle;
mod groups;
mod operator;
mod points;
mod rest;
mod scalar;
mod system;
#[cfg(test)]
mod tests;

pub(crate) use rest::{Relaxation, Start};
