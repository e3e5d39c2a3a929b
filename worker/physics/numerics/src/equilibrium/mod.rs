//! Ways to equilibrium, whatever hangs together and by whatever forces.
//!
//! [`settle`] is Newton's method: it looks whether forces balance and asks a [`Newton`] for a step until
//! they do. A step solves linear equations, by a factor ([`SparseCholesky`](crate::SparseCholesky)) or by
//! preconditioned conjugate gradients ([`iterate`]) on what is [`Iterated`], and goes as far as it leads
//! down, by [`halved`] lengths where nothing better is known. Where unknowns are motions of nodes in double
//! precision, [`Gradients`] has the vectors, and equations only say how they are applied and what
//! preconditions them ([`Preconditioned`]).
//!
//! What a force or a stiffness is, whoever asks knows; so do the units. Nothing here allocates once vectors
//! are there, but for lists of pieces that go to several threads.
mod conjugate;
mod gradients;
mod newton;
#[cfg(test)]
mod tests;

pub use conjugate::{Ended, Iterated, iterate};
pub use gradients::{Enough, Found, Gradients, Preconditioned};
pub use newton::{Newton, Settled, Unbalanced, halved, settle};
