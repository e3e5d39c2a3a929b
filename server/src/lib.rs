//! The loadframe service: jobs come in over REST, wait in the store, are claimed by workers over
//! HTTP, and their results go out again.
//!
//! The road of a request: [`serve`] binds the address, [`connections`] accepts within limits and hands
//! every request to the router of [`http`]; its layers count, protect and authenticate; a handler reads the request with the
//! vocabulary of `loadframe-api` and asks the [`store`], which alone knows SQL and files.
//! What happens is told by [`telling`], through [`webhooks`] and [`mail`].
pub mod access;
pub mod config;
pub mod connections;
pub mod http;
pub mod mail;
pub mod queue;
mod serve;
pub mod single_sign_on;
pub mod store;
mod tasks;
pub mod telling;
pub mod webhooks;

pub use config::ServeConfig;
pub use serve::{ServeError, serve};

/// Version of the service.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Commit it was built from; without one, a hash of its sources.
pub const COMMIT: &str = env!("LOADFRAME_COMMIT");
