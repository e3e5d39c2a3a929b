//! Fibres that yield along themselves, in a pull from event to event.
//!
//! `law` is the bilinear law of one segment, `strained` a network with what its segments have become longer
//! for good, `reach` tells how far the next event is, `relax` finds the rest after a break, and `pull`
//! drives; `asked` is what can be asked of it. What a small elongation does is a rest of its own, the rate: that of a network in which
//! the segments that flow are as soft as their hardening. Between events the rate is constant, so that
//! forces, energies and lengths are exact; an event is a segment that begins to yield, or a part
//! that breaks. A segment stops to flow where the rate would unload it.
//!
//! Only the force along a fibre makes it yield; bending, shear and torsion stay elastic, and bonds break
//! without having yielded.
mod asked;
mod law;
mod pull;
mod reach;
mod relax;
mod strained;
#[cfg(test)]
mod tests;

pub(crate) use pull::YieldingPull;
