//! People and sharing, over the router.
mod accounts;
mod group;
mod issuer;
mod matrix;
mod order;
mod proxy;
mod secrets;
mod sharing;
mod single_sign_on;
mod streams;
mod webhooks;
