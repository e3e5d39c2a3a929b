//! Making a specimen: how large its grains are, what shape they have, where they start.
//!
//! [`Sizes`] draws radii, also from a sieve curve; [`insert`] places spheres at random without
//! overlaps in a [`Region`] and [`place_regularly`] on a lattice; [`bounding_radius`] says what room a
//! grain needs and [`random_rotation`] turns it, so that a
//! clump goes where its bounding sphere went.
//! Everything takes its random numbers from the generator it is given, in a fixed order: the same
//! generator gives the same specimen. Lengths [m].
mod insertion;
mod placement;
mod region;
mod sizes;

pub(crate) use insertion::{insert, insert_some};
pub(crate) use placement::{bounding_radius, place_regularly, random_rotation};
pub(crate) use region::Region;
pub(crate) use sizes::{Amount, Sizes};
