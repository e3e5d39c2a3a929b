//! The service by its router: every test has its own store in a fresh folder, and no socket but where
//! connections are what is tested.
mod access;
mod archive;
mod compare;
mod connections;
mod curve;
#[path = "../shared/database.rs"]
mod database;
mod errors;
mod events;
mod files;
mod foreign;
mod formulas;
mod guide;
mod jobs;
mod kinds;
mod many_previews;
mod names;
mod openapi;
#[path = "../shared/outcome.rs"]
mod outcome;
mod pace;
mod page;
mod people;
mod preview;
mod service;
mod support;
mod tls;
mod values;
