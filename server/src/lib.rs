//! The loadframe service.
pub mod store;
