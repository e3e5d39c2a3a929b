//! People and sharing, over the router.
mod accounts;
mod audited;
mod comparing;
mod everything;
pub(crate) mod group;
mod issuer;
mod limits;
mod mails;
mod matrix;
mod order;
mod proxy;
mod secrets;
mod sharing;
mod single_sign_on;
mod streams;
mod trash;
mod webhooks;
