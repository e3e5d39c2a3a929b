//! The state of a scene, and a step of it.
//!
//! [`state`] is all that changes. [`listing`] makes the lists of contacts, [`patch`](self::patch) by patch; the
//! [`engine`] works through them and moves the bodies, which [`shares`] hands out; [`walls`] are those
//! of the engine by number; [`alone`] keeps the worst that any step had. Stages and observers are [`above`](crate::observe): nothing here knows why
//! a step is done, or who looks. Below: [`scene`](crate::scene).
pub(crate) mod alone;
pub(crate) mod engine;
pub(crate) mod listing;
pub(crate) mod patch;
mod shares;
pub(crate) mod state;
mod walls;
