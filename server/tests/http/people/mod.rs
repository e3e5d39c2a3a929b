//! People and sharing, over the router.
mod accounts;
mod group;
mod limits;
mod matrix;
mod sharing;
mod streams;
