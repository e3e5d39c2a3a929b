//! Addresses that get e-mail, once the link that was sent there was followed.
//!
//! They are rows of the table `webhooks`, so that one outbox, one rule of who may still be told and one of
//! trying again serve both. Until an address is verified, what it is to be told of stands in `wanted`.
use hmac::{Hmac, KeyInit, Mac};
use loadframe_api::Timestamp;
use loadframe_api::people::{MailVerification, MailView, Named, NewMail};
use sha2::Sha256;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, row};
use super::super::encoding::{json, parsed};
use super::super::error::{Result, StoreError};
use super::checks::refused;
use super::invitations::DAY;
use super::webhook_key::Key;
use super::webhooks::{Channel, once_each};

/// The event of the first e-mail, which asks for its address.
pub(super) const VERIFY: &str = "verify";
/// Events that come in this time after the first go in one e-mail [ms].
pub(super) const QUIET_MAIL: i64 = 60_000;
/// Addresses of a person.
const MOST: i64 = 10;
/// Addresses that a person asks to write to in a day: each gets an e-mail that nobody there asked for.
const MOST_A_DAY: i64 = 20;
/// A link verifies its address for so long [ms].
const LINK: i64 = 2 * DAY;

row! {
    struct MailRow {
        id: Uuid,
        address: String,
        events: String,
        wanted: Option<String>,
        project: Option<Uuid>,
        project_name: Option<String>,
        created_at: i64,
        told_at: Option<i64>,
        failures: i64,
        last_error: Option<String>,
        waiting: i64,
    }
}

impl MailRow {
    fn view(self) -> Result<MailView> {
        let project = self.project.zip(self.project_name);
        Ok(MailView {
            id: self.id,
            address: self.address,
            events: parsed(self.wanted.as_ref().unwrap_or(&self.events), "events")?,
            project: project.map(|(id, name)| Named { id, name }),
            created_at: Timestamp(self.created_at),
            is_verified: self.wanted.is_none(),
            told_at: self.told_at.map(Timestamp),
            failures: u32::try_from(self.failures).unwrap_or(u32::MAX),
            last_error: self.last_error,
            waiting: self.waiting.unsigned_abs(),
        })
    }
}

impl Store {
    /// Writes down that `person` wants e-mail at an address, and that the address is to be asked.
    ///
    /// # Errors
    /// [`StoreError::Refused`] beyond the most that a person may have or ask in a day.
    pub async fn create_mail(&self, person: Uuid, new: NewMail) -> Result<MailView> {
        let id = Uuid::now_v7();
        let events = once_each(new.events);
        self.write(move |change| {
            Box::pin(async move {
                let now = change.now.as_millis();
                let (count, today): (i64, i64) = query_as(
                    "SELECT COUNT(*) FILTER (WHERE removed_at IS NULL),
                            COUNT(*) FILTER (WHERE created_at > ?2)
                     FROM webhooks WHERE person = ?1 AND channel = 'mail'",
                )
                .bind(person)
                .bind(now - DAY)
                .fetch_one(&mut change.connection)
                .await?;
                if count >= MOST {
                    let detail = format!("you have {count} addresses already");
                    let allowed = "at most 10 of a person";
                    return Err(refused("/address", "too_many", detail, count, allowed));
                }
                if today >= MOST_A_DAY {
                    let detail = format!("you have given {today} addresses in a day");
                    let allowed = "at most 20 in a day, for each is written to";
                    return Err(refused("/address", "too_many", detail, today, allowed));
                }
                query(
                    "INSERT INTO webhooks (id, person, project, channel, url, events, wanted, created_at)
                     VALUES (?, ?, ?, 'mail', ?, '[]', ?, ?)",
                )
                .bind(id)
                .bind(person)
                .bind(new.project)
                .bind(&new.address)
                .bind(json(&events)?)
                .bind(now)
                .execute(&mut change.connection)
                .await?;
                query(
                    "INSERT INTO outbox (webhook, event, at, body) VALUES (?, ?, ?, '{}')",
                )
                .bind(id)
                .bind(VERIFY)
                // at once: it waits for nothing that goes with it
                .bind(now - QUIET_MAIL)
                .execute(&mut change.connection)
                .await?;
                let domain = new.address.rsplit('@').next().unwrap_or("").to_owned();
                change.audit("mail.made", Some(id), &domain).await
            })
        })
        .await?;
        let all = self.mails(person).await?;
        let made = all.into_iter().find(|mail| mail.id == id);
        made.ok_or_else(|| missing(id))
    }

    /// Addresses of a person, the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn mails(&self, person: Uuid) -> Result<Vec<MailView>> {
        let rows: Vec<MailRow> = query_as(
            "SELECT w.id, w.url AS address, w.events, w.wanted, w.project, p.name AS project_name,
                    w.created_at, w.told_at, w.failures, w.last_error,
                    (SELECT COUNT(*) FROM outbox o WHERE o.webhook = w.id) AS waiting
             FROM webhooks w LEFT JOIN projects p ON p.id = w.project
             WHERE w.person = ? AND w.channel = 'mail' AND w.removed_at IS NULL
             ORDER BY w.created_at DESC, w.id",
        )
        .bind(person)
        .fetch_all(self.reads())
        .await?;
        rows.into_iter().map(MailRow::view).collect()
    }

    /// Ends e-mail to an address of this person; what it was not told yet is told no more.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn remove_mail(&self, person: Uuid, id: Uuid) -> Result<()> {
        self.end_telling(person, id, Channel::Mail).await
    }

    /// Takes an address for its person's, who has followed the link that was sent there.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] for a link that is none, is over, or was sent for somebody else.
    pub async fn verify_mail(&self, person: Uuid, link: &MailVerification) -> Result<()> {
        let not_found = || StoreError::NotFound("address that this link was sent to".to_owned());
        let (id, _) = link.secret.split_once('.').ok_or_else(not_found)?;
        let id = Uuid::try_parse(id).map_err(|_| not_found())?;
        if !is_link(&self.webhook_key().await?, id, &link.secret) {
            return Err(not_found());
        }
        self.write(move |change| {
            Box::pin(async move {
                let now = change.now.as_millis();
                let verified = query(
                    "UPDATE webhooks SET events = COALESCE(wanted, events), wanted = NULL
                     WHERE id = ? AND person = ? AND channel = 'mail' AND removed_at IS NULL
                       AND (wanted IS NULL OR created_at > ?)",
                )
                .bind(id)
                .bind(person)
                .bind(now - LINK)
                .execute(&mut change.connection)
                .await?;
                if verified.rows_affected() == 0 {
                    return Err(not_found());
                }
                change.audit("mail.verified", Some(id), "").await
            })
        })
        .await
    }
}

fn missing(id: Uuid) -> StoreError {
    StoreError::NotFound(format!("address {id}"))
}

fn mac(key: &Key, id: Uuid) -> Option<Hmac<Sha256>> {
    let mut mac = Hmac::<Sha256>::new_from_slice(key).ok()?;
    mac.update(b"verify ");
    mac.update(id.as_bytes());
    Some(mac)
}

/// What the link to an address ends with: it follows from a key that is not in the database.
pub(super) fn link_secret(key: &Key, id: Uuid) -> String {
    use base64::Engine;
    use base64::engine::general_purpose::URL_SAFE_NO_PAD;
    let code = mac(key, id).map(|mac| URL_SAFE_NO_PAD.encode(mac.finalize().into_bytes()));
    // a key of this length is always taken
    format!("{}.{}", id.simple(), code.unwrap_or_default())
}

/// Whether the secret is that of this address; takes the same time for every wrong one.
fn is_link(key: &Key, id: Uuid, secret: &str) -> bool {
    use base64::Engine;
    use base64::engine::general_purpose::URL_SAFE_NO_PAD;
    let code = secret.split_once('.').map_or("", |(_, code)| code);
    let code = URL_SAFE_NO_PAD.decode(code).unwrap_or_default();
    mac(key, id).is_some_and(|mac| mac.verify_slice(&code).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_that_of_its_address_alone() {
        let (key, id) = ([7; 32], Uuid::from_u128(1));
        let secret = link_secret(&key, id);
        assert!(is_link(&key, id, &secret));
        assert!(!is_link(&key, Uuid::from_u128(2), &secret));
        assert!(!is_link(&[8; 32], id, &secret));
        assert!(!is_link(&key, id, &format!("{}.", id.simple())));
    }
}
