//! Telling other machines what happened: signed messages to addresses that people chose.
//!
//! When which is sent, [`crate::telling`] knows. [`address`] says where messages may go, [`message`] what
//! they look like.
pub mod address;
mod message;

use std::time::Duration;

use loadframe_api::Timestamp;

pub use address::{AddressError, Addresses};
pub use message::{SIGNATURE, signature};

use crate::store::people::Due;

/// The other side answers in this time, or not.
const PATIENCE: Duration = Duration::from_secs(10);

/// Why a message was not taken.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SendError {
    #[error("{0}")]
    Address(#[from] AddressError),
    #[error("the address cannot be reached: {0}")]
    Unreachable(String),
    #[error("it answered {0}; messages are taken with 200 to 299, and redirects are not followed")]
    Refused(u16),
}

pub(crate) async fn send(
    addresses: &Addresses,
    due: &Due,
    now: Timestamp,
) -> Result<(), SendError> {
    let to = addresses.look_up(&due.address).await?;
    let body = message::body(due, now);
    let unreachable = |error: reqwest::Error| {
        let causes = std::iter::successors(Some(&error as &dyn std::error::Error), |error| {
            error.source()
        });
        let causes: Vec<String> = causes.map(ToString::to_string).collect();
        SendError::Unreachable(causes.join(": "))
    };
    // a second installation finds the first
    let _ = rustls::crypto::ring::default_provider().install_default();
    let client = reqwest::Client::builder()
        .timeout(PATIENCE)
        .redirect(reqwest::redirect::Policy::none())
        .no_proxy()
        // the very addresses that were looked at: the name may lead elsewhere by now
        .resolve_to_addrs(&to.host, &to.sockets)
        .user_agent(concat!("loadframe/", env!("CARGO_PKG_VERSION")));
    let client = match to.url.scheme() {
        "http" => client.tls_certs_only([]),
        _ => client,
    };
    let client = client.build().map_err(unreachable)?;
    let answer = client
        .post(to.url)
        .header("content-type", "application/json")
        .header(SIGNATURE, signature(&due.secret, now, &body))
        .body(body)
        .send()
        .await
        .map_err(|error| unreachable(error.without_url()))?;
    match answer.status() {
        status if status.is_success() => Ok(()),
        status => Err(SendError::Refused(status.as_u16())),
    }
}
