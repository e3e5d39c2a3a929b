//! Rest of a large network without a factor of all of it: preconditioned conjugate gradients.
//!
//! `operator` applies the stiffness element by element, without a matrix. The preconditioner is a sum of
//! three: `chains`, each fibre by itself with its bonds held at their other ends, solved exactly by blocks
//! along the fibre; `clumps`, neighbours that hang together, as rigid bodies each by itself; and `coarse`, motions of neighbourhoods as rigid bodies, which a grid of bilinear
//! elements over the sheet joins, solved by a Cholesky factor. Together they leave few iterations
//! whatever the size of the sheet: two-level decomposition of networks [GortzHellmanMalqvist2024].
//! `conjugate` iterates and estimates its error in energy; `rest` starts from the last equilibrium,
//! stops when what breaks next is known well enough, and takes out what breaks.
//!
//! Passes are shared among threads by fixed pieces, sums go in a fixed order: the bits do not know
//! the number of threads.
mod chains;
mod clumps;
mod coarse;
mod conjugate;
mod operator;
mod rest;
mod system;

pub(crate) use rest::{Relaxation, Start};
