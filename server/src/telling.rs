//! Telling what happened, to machines by [`crate::webhooks`] and to people by [`crate::mail`].
//!
//! What is to be told lies in the store's outbox, written by the change that it tells of, until the other
//! side has taken it: a message comes at least once, whenever this server is killed. Events that come
//! together go in one message.
use std::sync::Arc;
use std::time::Duration;

use futures_util::{StreamExt, stream};
use loadframe_api::Timestamp;

use crate::mail::Mailer;
use crate::store::people::{Channel, Due};
use crate::store::{Store, StoreError};
use crate::webhooks::{self, Addresses};

/// How often the outbox is looked at.
const EVERY: Duration = Duration::from_secs(2);
/// Messages on their way at once.
const AT_ONCE: usize = 8;

/// The ways by which somebody is told.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    /// Where webhooks may lead.
    pub addresses: Addresses,
    /// The server's e-mail, where it has any.
    pub mailer: Option<Arc<Mailer>>,
}

/// Tells what is to be told, until dropped.
pub(crate) async fn keep_telling(store: Store, ways: Ways) {
    loop {
        tokio::time::sleep(EVERY).await;
        if let Err(error) = tell(&store, &ways, Timestamp::now()).await {
            tracing::error!(%error, "the outbox could not be read");
        }
    }
}

/// Sends every message that is due as of `now`; tells how many were taken.
///
/// # Errors
/// The store's.
pub async fn tell(store: &Store, ways: &Ways, now: Timestamp) -> Result<usize, StoreError> {
    let due = store.due_messages(now).await?;
    let sent = stream::iter(due).map(|due| async move {
        let error = send(ways, &due, now).await.err();
        if let Some(error) = &error {
            tracing::warn!(subscriber = %due.id, error, "a message was not taken");
        }
        let is_taken = error.is_none();
        store.note_telling(&due, error, now).await?;
        Ok(is_taken)
    });
    let taken: Vec<Result<bool, StoreError>> = sent.buffer_unordered(AT_ONCE).collect().await;
    let taken: Vec<bool> = taken.into_iter().collect::<Result<_, _>>()?;
    Ok(taken.into_iter().filter(|is_taken| *is_taken).count())
}

async fn send(ways: &Ways, due: &Due, now: Timestamp) -> Result<(), String> {
    match (due.channel, &ways.mailer) {
        (Channel::Webhook, _) => {
            let sent = webhooks::send(&ways.addresses, due, now).await;
            sent.map_err(|error| error.to_string())
        }
        (Channel::Mail, Some(mailer)) => mailer.send(due).await.map_err(|error| error.to_string()),
        (Channel::Mail, None) => Err("this server sends no e-mail any more".to_owned()),
    }
}
