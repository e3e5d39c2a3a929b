//! People and sharing, over the router.
mod accounts;
mod comparing;
pub(crate) mod group;
mod matrix;
mod sharing;
mod streams;
