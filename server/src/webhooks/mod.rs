//! Telling other machines what happened: signed messages to addresses that people chose.
//!
//! What is to be told lies in the store's outbox, written by the change that it tells of, until the other
//! side has taken it: a message comes at least once, whenever this server is killed. Events that come
//! together go in one message. [`address`] says where messages may go, [`message`] what they look like.
pub mod address;
mod message;

use std::time::Duration;

use futures_util::{StreamExt, stream};
use loadframe_api::Timestamp;

pub use address::{AddressError, Addresses};
pub use message::{SIGNATURE, signature};

use crate::store::Store;
use crate::store::people::Due;

/// How often the outbox is looked at.
const EVERY: Duration = Duration::from_secs(2);
/// Messages on their way at once.
const AT_ONCE: usize = 8;
/// The other side answers in this time, or not.
const PATIENCE: Duration = Duration::from_secs(10);

/// Tells what is to be told, until dropped.
pub(crate) async fn keep_telling(store: Store, addresses: Addresses) {
    loop {
        tokio::time::sleep(EVERY).await;
        if let Err(error) = tell(&store, &addresses, Timestamp::now()).await {
            tracing::error!(%error, "the outbox could not be read");
        }
    }
}

/// Sends every message that is due as of `now`; tells how many were taken.
///
/// # Errors
/// The store's.
pub async fn tell(
    store: &Store,
    addresses: &Addresses,
    now: Timestamp,
) -> Result<usize, crate::store::StoreError> {
    let due = store.due_messages(now).await?;
    let sent = stream::iter(due).map(|due| async move {
        let error = send(addresses, &due, now).await.err();
        if let Some(error) = &error {
            tracing::warn!(webhook = %due.id, %error, "a webhook was not told");
        }
        let is_taken = error.is_none();
        store
            .note_telling(&due, error.map(|of| of.to_string()), now)
            .await?;
        Ok(is_taken)
    });
    let taken: Vec<Result<bool, crate::store::StoreError>> =
        sent.buffer_unordered(AT_ONCE).collect().await;
    let taken: Vec<bool> = taken.into_iter().collect::<Result<_, _>>()?;
    Ok(taken.into_iter().filter(|is_taken| *is_taken).count())
}

/// Why a message was not taken.
#[derive(Debug, thiserror::Error)]
enum SendError {
    #[error("{0}")]
    Address(#[from] AddressError),
    #[error("the address cannot be reached: {0}")]
    Unreachable(String),
    #[error("it answered {0}; messages are taken with 200 to 299, and redirects are not followed")]
    Refused(u16),
}

async fn send(addresses: &Addresses, due: &Due, now: Timestamp) -> Result<(), SendError> {
    let to = addresses.look_up(&due.url).await?;
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
