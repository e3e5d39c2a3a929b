//! Addresses that are told what happens.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::Named;
use crate::Timestamp;

/// What somebody can be told of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WebhookEvent {
    /// A job has succeeded or was cancelled.
    Ended,
    /// A job has failed or took longer than it may.
    Failed,
    /// A job was set aside after its workers fell silent.
    Quarantined,
    /// A share link to a job or to a project was made.
    Shared,
    /// A person's files have come to nine tenths of a limit or to all of it, or queued core hours to nine tenths.
    Quota,
}

/// `POST /v1/webhooks`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewWebhook {
    /// Address that takes the messages, of `https` or `http`.
    #[schemars(length(min = 8, max = 1000))]
    pub url: String,
    #[schemars(length(min = 1, max = 5))]
    pub events: Vec<WebhookEvent>,
    /// The project whose jobs it is about; left out, all jobs of your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub project: Option<Uuid>,
}

/// An address that is told, without its secret.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct WebhookView {
    pub id: Uuid,
    pub url: String,
    pub events: Vec<WebhookEvent>,
    pub project: Option<Named>,
    pub created_at: Timestamp,
    /// When it last took a message.
    pub told_at: Option<Timestamp>,
    /// Messages it did not take since then.
    pub failures: u32,
    /// What was wrong with the last of them.
    pub last_error: Option<String>,
    /// Events that it is still to be told of.
    pub waiting: u64,
}

/// A webhook just made; the only time its secret is seen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct WebhookMade {
    pub id: Uuid,
    /// Key of the signature of each message.
    pub secret: String,
}
