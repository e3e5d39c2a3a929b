//! Networks of bonds in equilibrium.
//!
//! **Model.** Nodes are points, bonds are straight and carry force along their line only. Some
//! nodes are held by the bottom jaw, which rests, some by the top jaw, which moves along +y, and some
//! may belong to other sets that are held along some axes ([`boundary`]). The
//! state of a network is the displacement of each node and whether each bond is intact.
//!
//! With X the initial vector from a bond's first node to its second, w the difference of their
//! displacements, l = |X + w| and n = (X + w)/l:
//!
//! - strain u = (l − l₀)/l₀; in floating point l − l₀ = (w·(2X + w) + |X|² − l₀²)/(l + l₀) (4),
//!   which keeps full relative precision however small the strain is;
//! - energy E = Σ l₀ φ(u) with φ of [`law::BondLaw::energy`] (5);
//! - force on the second node −T n, on the first +T n; the resultant of a node is −∂E/∂x (6);
//! - stiffness between the two nodes K = a n nᵀ + b (1 − n nᵀ), a = T'/l₀, b = T/l (7). In
//!   compression b < 0: bonds buckle, and E is not convex.
//!
//! **Data road.** [`Network`] is what a generator or a spec builds once and nothing changes after.
//! [`assembly`] packs it for the solvers, free nodes between held ones, with its bonds in the
//! [`blocks`] that vector instructions like. [`load_path`] finds which nodes hang between both
//! jaws; only intact bonds among these act, the others stay where they are and do nothing. A
//! [`configuration`] is an assembly at some displacements: energy, forces and the [`stiffness`] that
//! Newton's method follows. [`equilibrium`] moves the free nodes until their resultants vanish.
//! [`rupture`] says which bonds break then. The test itself (steps, curve, files) belongs to the
//! material: [`nonwoven`].
//!
//! **Parts without load.** What hangs on one jaw only, or on none, cannot carry force from jaw to
//! jaw: in equilibrium its pull on the jaw is zero. Such parts keep their shape, follow the jaw
//! they hang on, count as unloaded, and cost nothing. Bonds between two nodes of one jaw never
//! change length and count as unloaded as well.
pub(crate) mod assembly;
mod blocks;
pub(crate) mod boundary;
pub(crate) mod configuration;
pub(crate) mod equilibrium;
pub(crate) mod field;
mod incidence;
pub(crate) mod law;
pub(crate) mod load_path;
mod network;
pub mod nonwoven;
mod places;
mod response;
mod rounded;
pub(crate) mod rupture;
#[cfg(test)]
mod sample;
mod stiffness;
mod strips;
mod sums;

pub(crate) use network::{Bonds, Laws, Network, Row};

/// A point or vector in space [mm], a force [N].
pub(crate) type Vector = nalgebra::Vector3<f64>;
