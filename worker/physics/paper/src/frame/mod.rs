//! Networks of fibres with bonds between them: pulled, and broken.
//!
//! Knows centre lines, sections and bonds; knows no pulp and no generator. A description
//! ([`FrameFibre`], [`FrameBond`], [`FrameModel`]) becomes a [`Network`] once; a [`Pull`] holds it in the jaws
//! and goes from break to break; [`Network::rest`] is its equilibrium under loads. All this is for small
//! displacements; [`LargePull`] and [`Network::rest_at_large`] are for large ones, and slower by far.
//!
//! From the bottom up: `places` puts nodes on centre lines, `element` is what joins two of them, `tie` holds
//! bonds between nodes, `clusters` says what hangs together, `survey` looks at what every part bears, `together` says what of it breaks at once. Two roads lead to
//! rest, and `held` chooses: `equilibrium` with a factor of all (`order`, `factor`), exact and for small sheets,
//! and `gradients`, by iterations, for large ones; `load` is rest under loads. `events` are what happens in a pull, `state`
//! is what it remembers and measures, `pulling` what every pull can be asked: `pull` drives, `yielding` where
//! fibres yield, `moving` where masses are in motion, and which of them a network needs is `chosen`. `large` does all for large motions.
//!
//! Fibres are beams or bars, or `tubes` of points and springs: other nodes and other springs, the same equilibrium
//! with a factor (`springs` is what it asks of them), the same events.
//!
//! A bond resists the relative displacement of its two centre-line points equally in all directions,
//! and their relative rotation. When the points are apart (by the radii of the fibres) this resists a
//! rigid rotation of the pair, too, and a shear force on it leaves a moment: the bond is a law between
//! two points, not a body. For the flat sheets of tensile tests rotations are about z, across which
//! the points are apart, and neither matters.
//!
//! A truss is loose across its fibres and at their ends. Its bars are taut by a strain of 1e-9, or by one that is
//! given ([`Network::with_taut_bars`]), which holds what is loose and carries nothing else;
//! [`PullMeasures::largest_taut_share`] is the share of
//! the energy in it: where that is not small, the truss is a mechanism and its force means nothing.
//! That is so for every sheet of fibres shorter than the distance of the jaws: n crossings of a fibre
//! make n - 1 bars, one less than holds them all. Such a truss carries only once its fibres have turned.
mod balance;
mod chosen;
mod clusters;
mod element;
mod equilibrium;
mod error;
mod events;
mod factor;
mod gradients;
mod held;
mod input;
mod large;
mod load;
mod moving;
mod network;
mod order;
mod places;
mod pull;
mod pulling;
mod springs;
mod state;
mod survey;
#[cfg(test)]
mod tests;
mod tie;
mod together;
mod tubes;
mod yielding;

pub use chosen::pull;
pub use clusters::Standing;
pub use equilibrium::Refactoring;
pub use error::FrameError;
pub use events::{Bore, Broken, Event, PullEnd, Step};
pub use held::{Means, Solver};
pub use input::{
    Attachment, BeamSection, FrameBond, FrameFibre, FrameModel, Level, NodeLoad, Yielding,
};
pub use large::{LargePull, LargePullTest, LargeStep};
pub use load::Rest;
pub use moving::{MotionReport, MotionTest};
pub use network::{Drawing, Network};
pub use places::Jaw;
pub use pull::{Pull, PullTest};
pub use pulling::{CurvePoint, Loads, Pulling, run};
pub use state::{PullCost, PullMeasures, PullState};
