//! Webhooks: addresses that programs are told at. What they are told lies in the [`outbox`](super::outbox).
use hmac::{Hmac, KeyInit, Mac};
use loadframe_api::Timestamp;
use loadframe_api::people::{Named, NewWebhook, WebhookEvent, WebhookMade, WebhookView};
use serde::{Deserialize, Serialize};
use sha2::Sha256;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, query_scalar, row};
use super::super::encoding::{json, parsed, wire_name};
use super::super::error::{Result, StoreError};
use super::checks::refused;
use super::webhook_key::Key;

/// Webhooks of a person.
const MOST: i64 = 50;
/// What a secret begins with, so that people and secret scanners know it.
const PREFIX: &str = "lfw_";

/// How somebody is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    Webhook,
    Mail,
}

row! {
    struct WebhookRow {
        id: Uuid,
        url: String,
        events: String,
        project: Option<Uuid>,
        project_name: Option<String>,
        created_at: i64,
        told_at: Option<i64>,
        failures: i64,
        last_error: Option<String>,
        waiting: i64,
    }
}

impl WebhookRow {
    fn view(self) -> Result<WebhookView> {
        let project = self.project.zip(self.project_name);
        Ok(WebhookView {
            id: self.id,
            url: self.url,
            events: parsed(&self.events, "events")?,
            project: project.map(|(id, name)| Named { id, name }),
            created_at: Timestamp(self.created_at),
            told_at: self.told_at.map(Timestamp),
            failures: u32::try_from(self.failures).unwrap_or(u32::MAX),
            last_error: self.last_error,
            waiting: self.waiting.unsigned_abs(),
        })
    }
}

impl Store {
    /// Makes a webhook of `person`, whose address was looked at.
    ///
    /// # Errors
    /// [`StoreError::Refused`] beyond the most that a person may have; the file system's.
    pub async fn create_webhook(&self, person: Uuid, new: NewWebhook) -> Result<WebhookMade> {
        let id = Uuid::now_v7();
        let secret = secret_of(&self.webhook_key().await?, id);
        let events = once_each(new.events);
        self.write(move |change| {
            Box::pin(async move {
                let count: i64 = query_scalar(
                    "SELECT COUNT(*) FROM webhooks
                     WHERE person = ? AND channel = 'webhook' AND removed_at IS NULL",
                )
                .bind(person)
                .fetch_one(&mut change.connection)
                .await?;
                if count >= MOST {
                    let detail = format!("you have {count} webhooks already");
                    return Err(refused(
                        "/url",
                        "too_many",
                        detail,
                        count,
                        "at most 50 of a person",
                    ));
                }
                query(
                    "INSERT INTO webhooks (id, person, project, url, events, created_at)
                     VALUES (?, ?, ?, ?, ?, ?)",
                )
                .bind(id)
                .bind(person)
                .bind(new.project)
                .bind(&new.url)
                .bind(json(&events)?)
                .bind(change.now.as_millis())
                .execute(&mut change.connection)
                .await?;
                // the path of an address may be a secret of its own
                let host = new.url.split('/').nth(2).unwrap_or("").to_owned();
                change.audit("webhook.made", Some(id), &host).await
            })
        })
        .await?;
        Ok(WebhookMade { id, secret })
    }

    /// Webhooks of a person, the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn webhooks(&self, person: Uuid) -> Result<Vec<WebhookView>> {
        let rows: Vec<WebhookRow> = query_as(
            "SELECT w.id, w.url, w.events, w.project, p.name AS project_name, w.created_at, w.told_at,
                    w.failures, w.last_error,
                    (SELECT COUNT(*) FROM outbox o WHERE o.webhook = w.id) AS waiting
             FROM webhooks w LEFT JOIN projects p ON p.id = w.project
             WHERE w.person = ? AND w.channel = 'webhook' AND w.removed_at IS NULL
             ORDER BY w.created_at DESC, w.id",
        )
        .bind(person)
        .fetch_all(self.reads())
        .await?;
        rows.into_iter().map(WebhookRow::view).collect()
    }

    /// Ends a webhook of this person; what it was not told yet is told no more.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn remove_webhook(&self, person: Uuid, id: Uuid) -> Result<()> {
        self.end_telling(person, id, Channel::Webhook).await
    }

    /// Ends a webhook, or e-mail to an address.
    pub(super) async fn end_telling(&self, person: Uuid, id: Uuid, channel: Channel) -> Result<()> {
        let word = wire_name(&channel)?;
        self.write(move |change| {
            Box::pin(async move {
                let removed = query(
                    "UPDATE webhooks SET removed_at = ?
                     WHERE id = ? AND person = ? AND channel = ? AND removed_at IS NULL",
                )
                .bind(change.now.as_millis())
                .bind(id)
                .bind(person)
                .bind(&word)
                .execute(&mut change.connection)
                .await?;
                if removed.rows_affected() == 0 {
                    let what = match channel {
                        Channel::Webhook => "webhook",
                        Channel::Mail => "address",
                    };
                    return Err(StoreError::NotFound(format!("{what} {id}")));
                }
                query("DELETE FROM outbox WHERE webhook = ?")
                    .bind(id)
                    .execute(&mut change.connection)
                    .await?;
                change.audit(&format!("{word}.removed"), Some(id), "").await
            })
        })
        .await
    }
}

/// The events that were chosen, each once.
pub(super) fn once_each(chosen: Vec<WebhookEvent>) -> Vec<WebhookEvent> {
    let mut events: Vec<WebhookEvent> = Vec::new();
    for event in chosen {
        if !events.contains(&event) {
            events.push(event);
        }
    }
    events
}

/// HMAC-SHA256 of the webhook's id under the key.
pub(super) fn secret_of(key: &Key, id: Uuid) -> String {
    use base64::Engine;
    use base64::engine::general_purpose::URL_SAFE_NO_PAD;
    let mac = Hmac::<Sha256>::new_from_slice(key).map(|mut mac| {
        mac.update(id.as_bytes());
        mac.finalize().into_bytes()
    });
    // a key of this length is always taken
    mac.map_or_else(
        |_| String::new(),
        |bytes| format!("{PREFIX}{}", URL_SAFE_NO_PAD.encode(bytes)),
    )
}
