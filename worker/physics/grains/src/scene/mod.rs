//! What a scene is made of, and how it starts.
//!
//! In the order of calls: [`specimen`] lists every body, [`model`] resolves spec and specimen into what
//! stays as it is, and the first [`particles`] and clumps; [`reserve`] takes those aside that a stage
//! puts in later, alone or in the places of others. Below: [`contact`](crate::contact), [`walls`](crate::walls),
//! [`motion`](crate::motion), [`generate`](crate::generate); nothing here moves.
pub(crate) mod model;
pub(crate) mod particles;
mod replacing;
pub(crate) mod reserve;
pub(crate) mod specimen;
