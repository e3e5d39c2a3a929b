//! The outbox: what [`webhooks`](super::webhooks) and addresses of e-mail ([`mails`](super::mails)) are to be
//! told. It is written by triggers of the database, in the transaction of the change that it tells of.
use loadframe_api::Timestamp;
use serde_json::Value;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as};
use super::super::encoding::{parsed, variant};
use super::super::error::Result;
use super::mails::{QUIET_MAIL, VERIFY, link_secret};
use super::webhooks::{Channel, secret_of};

/// Events that come in this time after the first go in one message [ms].
const QUIET: i64 = 10_000;
/// Between two e-mails to one address, which is read by people, lies at least [ms].
const BETWEEN_MAILS: i64 = 300_000;
/// Events of a message.
const LONGEST: u32 = 500;
/// Messages prepared at once.
const AT_ONCE: u32 = 100;
/// The wait after the first failure, twice as long after each further one [ms],
const FIRST_WAIT: i64 = 10_000;
/// up to this [ms].
const LONGEST_WAIT: i64 = 3_600_000;
/// What could not be told for so long is given up [ms].
const GIVEN_UP: i64 = 24 * 3_600_000;

/// A message that is due.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Due {
    pub id: Uuid,
    pub channel: Channel,
    /// A URL, or an address of e-mail.
    pub address: String,
    /// Of a webhook the key of its signatures, of e-mail what the link that verifies it ends with.
    pub secret: String,
    /// In the order in which they happened.
    pub events: Vec<DueEvent>,
    failures: i64,
}

/// Something to be told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DueEvent {
    /// Higher for what happened later; the same when it is told again.
    pub number: i64,
    pub event: String,
    pub at: Timestamp,
    pub about: Value,
}

impl Due {
    /// Whether it is the e-mail that asks for its address.
    pub(crate) fn is_question(&self) -> bool {
        self.events.iter().any(|event| event.event == VERIFY)
    }

    /// An e-mail to be written, for tests of what it says.
    #[cfg(test)]
    pub(crate) fn of_mail(address: &str, secret: &str, events: Vec<DueEvent>) -> Self {
        Self {
            id: Uuid::nil(),
            channel: Channel::Mail,
            address: address.to_owned(),
            secret: secret.to_owned(),
            events,
            failures: 0,
        }
    }
}

impl Store {
    /// Messages that are due: to webhooks and addresses that are not waiting after a failure and whose person still holds
    /// what they are about, once all that happens at the same time is there.
    ///
    /// # Errors
    /// The database's, the file system's.
    pub async fn due_messages(&self, now: Timestamp) -> Result<Vec<Due>> {
        let told: Vec<(Uuid, String, String, i64)> = query_as(
            "SELECT w.id, w.channel, w.url, w.failures FROM webhooks w JOIN people p ON p.id = w.person
             WHERE w.removed_at IS NULL AND p.left_at IS NULL AND w.next_at <= ?1
               AND (w.project IS NULL OR p.role = 'administrator' OR EXISTS (
                    SELECT 1 FROM projects r WHERE r.id = w.project AND (r.person = w.person
                        OR (p.role = 'member' AND EXISTS (SELECT 1 FROM members m
                            WHERE m.team = r.team AND m.person = w.person)))))
               AND (SELECT MIN(o.number) FROM outbox o WHERE o.webhook = w.id 
                    AND o.at <= CASE w.channel WHEN 'mail' THEN ?4 ELSE ?2 END) IS NOT NULL
             ORDER BY w.next_at, w.id LIMIT ?3",
        )
        .bind(now.as_millis())
        .bind(now.as_millis() - QUIET)
        .bind(AT_ONCE)
        .bind(now.as_millis() - QUIET_MAIL)
        .fetch_all(self.reads())
        .await?;
        if told.is_empty() {
            return Ok(Vec::new());
        }
        let key = self.webhook_key().await?;
        let mut due = Vec::with_capacity(told.len());
        for (id, channel, address, failures) in told {
            let channel: Channel = variant(&channel)?;
            let rows: Vec<(i64, String, i64, String)> = query_as(
                "SELECT number, event, at, body FROM outbox WHERE webhook = ? ORDER BY number LIMIT ?",
            )
            .bind(id)
            .bind(LONGEST)
            .fetch_all(self.reads())
            .await?;
            let event = |(number, event, at, body): (i64, String, i64, String)| {
                let about = with_ids(parsed(&body, "event")?);
                Ok(DueEvent {
                    number,
                    event,
                    at: Timestamp(at),
                    about,
                })
            };
            due.push(Due {
                secret: match channel {
                    Channel::Webhook => secret_of(&key, id),
                    Channel::Mail => link_secret(&key, id),
                },
                events: rows.into_iter().map(event).collect::<Result<_>>()?,
                id,
                channel,
                address,
                failures,
            });
        }
        Ok(due)
    }

    /// Writes down that a message was taken, or what was wrong: then it is tried again later, for a day.
    ///
    /// # Errors
    /// The database's.
    pub async fn note_telling(
        &self,
        due: &Due,
        error: Option<String>,
        now: Timestamp,
    ) -> Result<()> {
        let (id, failures) = (due.id, due.failures);
        let next_at = match due.channel {
            Channel::Mail if !due.is_question() => now.as_millis() + BETWEEN_MAILS,
            _ => 0,
        };
        let last = due.events.last().map_or(0, |event| event.number);
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let (statement, until) = match &error {
                    None => ("DELETE FROM outbox WHERE webhook = ? AND number <= ?", last),
                    Some(_) => (
                        "DELETE FROM outbox WHERE webhook = ? AND at < ?",
                        now.as_millis() - GIVEN_UP,
                    ),
                };
                let removed = query(statement)
                    .bind(id)
                    .bind(until)
                    .execute(&mut change.connection)
                    .await?
                    .rows_affected();
                let Some(error) = error else {
                    query(
                        "UPDATE webhooks SET failures = 0, next_at = ?, told_at = ?, last_error = NULL
                         WHERE id = ?",
                    )
                    .bind(next_at)
                    .bind(now.as_millis())
                    .bind(id)
                    .execute(&mut change.connection)
                    .await?;
                    return Ok(());
                };
                let given_up = match removed {
                    0 => String::new(),
                    events => format!("; {events} events of more than a day ago are given up"),
                };
                let doublings = u32::try_from(failures.clamp(0, 20)).unwrap_or(20);
                let wait = (FIRST_WAIT << doublings).min(LONGEST_WAIT);
                query(
                    "UPDATE webhooks SET failures = failures + 1, next_at = ?, last_error = ? WHERE id = ?",
                )
                .bind(now.as_millis() + wait)
                .bind(error + &given_up)
                .bind(id)
                .execute(&mut change.connection)
                .await?;
                Ok(())
            })
        })
        .await
    }
}

/// Ids as everywhere else: the database writes their bytes as digits alone, and nothing for none.
fn with_ids(mut about: Value) -> Value {
    let Some(fields) = about.as_object_mut() else {
        return about;
    };
    for name in ["job", "project", "comparison", "link"] {
        let id = fields
            .get(name)
            .and_then(Value::as_str)
            .map(Uuid::try_parse);
        match id {
            Some(Ok(id)) => {
                fields.insert(name.to_owned(), Value::String(id.to_string()));
            }
            Some(Err(_)) => {
                fields.shift_remove(name);
            }
            None => {}
        }
    }
    about
}
