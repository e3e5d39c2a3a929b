//! Addresses of e-mail that are told what happens.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::{Named, WebhookEvent};
use crate::Timestamp;

/// `POST /v1/mails`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewMail {
    /// Address that gets the e-mails, once whoever reads it has followed the link in the first.
    #[schemars(length(min = 3, max = 254))]
    pub address: String,
    #[schemars(length(min = 1, max = 5))]
    pub events: Vec<WebhookEvent>,
    /// The project whose jobs it is about; left out, all jobs of your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub project: Option<Uuid>,
}

/// An address that gets e-mail.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MailView {
    pub id: Uuid,
    pub address: String,
    /// What it is told of, once it is verified.
    pub events: Vec<WebhookEvent>,
    pub project: Option<Named>,
    pub created_at: Timestamp,
    /// Whether the link that was sent to it was followed; nothing else is sent before.
    pub is_verified: bool,
    /// When the last e-mail was handed over.
    pub told_at: Option<Timestamp>,
    /// E-mails that could not be handed over since then.
    pub failures: u32,
    /// What was wrong with the last of them.
    pub last_error: Option<String>,
    /// Events that it is still to be told of.
    pub waiting: u64,
}

/// `POST /v1/mails/verify`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MailVerification {
    /// What the link in the e-mail ends with.
    #[schemars(length(min = 1, max = 200))]
    pub secret: String,
}
