//! People and sharing, over the router.
mod accounts;
pub(crate) mod group;
mod matrix;
mod sharing;
mod streams;
