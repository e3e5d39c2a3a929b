//! People as a provider of identities or a proxy knows them.
use loadframe_api::people::Role;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, query_scalar};
use super::super::encoding::{parsed, variant, wire_name};
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::checks::{clean_name, folded};
use crate::access::{Caller, Credential};

/// Names tried before somebody is told that theirs is taken.
const NAMES_TRIED: u32 = 100;

/// Somebody as their issuer tells of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    pub issuer: String,
    pub subject: String,
    /// Names for a new account, the best first.
    pub names: Vec<String>,
    /// An address that the issuer has verified.
    pub email: Option<String>,
}

/// As what somebody without an account comes in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Admission {
    pub role: Role,
    /// Names of groups the person will be in, where they are there.
    pub groups: Vec<String>,
}

/// What became of somebody at the door.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The person who came in, and the name of the account.
    Known(Uuid, String),
    /// No account, no invitation, no rule; or the account has ended.
    NotAdmitted,
    /// The identity is another account's already.
    Taken,
}

impl Store {
    /// Lets somebody in: to the account of the identity; else to that of `linked`, which has it from now
    /// on; else to a new one, by an invitation to the address or as `admission` says.
    ///
    /// # Errors
    /// The database's.
    pub async fn arrive(
        &self,
        identity: Identity,
        linked: Option<Uuid>,
        admission: Option<Admission>,
    ) -> Result<Arrival> {
        self.write(move |change| {
            Box::pin(async move {
                if let Some((person, name, has_left)) = change.person_of(&identity).await? {
                    return Ok(match (has_left, linked) {
                        (true, _) => Arrival::NotAdmitted,
                        (_, Some(other)) if other != person => Arrival::Taken,
                        _ => Arrival::Known(person, name),
                    });
                }
                if let Some(person) = linked {
                    return change.link(&identity, person).await;
                }
                let offered = change.invitation_to(identity.email.as_deref()).await?;
                let (role, groups, detail) = match (offered, admission) {
                    (Some((role, groups)), _) => (role, groups, "by an invitation"),
                    (None, Some(rule)) => (
                        rule.role,
                        change.groups_named(&rule.groups).await?,
                        "by a rule",
                    ),
                    (None, None) => return Ok(Arrival::NotAdmitted),
                };
                let (id, name) = change.add_person_of(&identity, role).await?;
                for group in groups {
                    change.add_member(group, id).await?;
                }
                change.act_as(&name, id);
                let detail = format!("{name}: {}, {detail}", wire_name(&role)?);
                change.audit("person.admitted", Some(id), &detail).await?;
                Ok(Arrival::Known(id, name))
            })
        })
        .await
    }

    /// Who a proxy says that somebody is, where they have an account in force.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_by_identity(&self, issuer: &str, subject: &str) -> Result<Option<Caller>> {
        let person: Option<Uuid> = query_scalar(
            "SELECT i.person FROM identities i JOIN people p ON p.id = i.person
             WHERE i.issuer = ? AND i.subject = ? AND p.left_at IS NULL",
        )
        .bind(issuer)
        .bind(subject)
        .fetch_optional(self.lookups())
        .await?;
        match person {
            Some(person) => self.person_caller(person, Credential::Proxy(person)).await,
            None => Ok(None),
        }
    }
}

impl Change {
    async fn person_of(&mut self, identity: &Identity) -> Result<Option<(Uuid, String, bool)>> {
        let found = query_as(
            "SELECT p.id, p.name, p.left_at IS NOT NULL FROM identities i
             JOIN people p ON p.id = i.person WHERE i.issuer = ? AND i.subject = ?",
        )
        .bind(&identity.issuer)
        .bind(&identity.subject)
        .fetch_optional(&mut self.connection)
        .await?;
        Ok(found)
    }

    /// Gives the identity to an account that is there.
    async fn link(&mut self, identity: &Identity, person: Uuid) -> Result<Arrival> {
        let name: Option<String> =
            query_scalar("SELECT name FROM people WHERE id = ? AND left_at IS NULL")
                .bind(person)
                .fetch_optional(&mut self.connection)
                .await?;
        let Some(name) = name else {
            return Ok(Arrival::NotAdmitted);
        };
        self.add_identity(identity, person).await?;
        self.act_as(&name, person);
        self.audit("person.linked", Some(person), &identity.issuer)
            .await?;
        Ok(Arrival::Known(person, name))
    }

    async fn add_identity(&mut self, identity: &Identity, person: Uuid) -> Result<()> {
        query("INSERT INTO identities (issuer, subject, person, created_at) VALUES (?, ?, ?, ?)")
            .bind(&identity.issuer)
            .bind(&identity.subject)
            .bind(person)
            .bind(self.now.as_millis())
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }

    /// Accepts the oldest invitation in force to this address.
    async fn invitation_to(&mut self, email: Option<&str>) -> Result<Option<(Role, Vec<Uuid>)>> {
        let Some(email) = email else { return Ok(None) };
        let offered: Option<(String, String)> = query_as(
            "UPDATE invitations SET accepted_at = ?1 WHERE id = (
                SELECT id FROM invitations WHERE email = ?2 AND accepted_at IS NULL
                    AND revoked_at IS NULL AND expires_at > ?1 ORDER BY created_at, id LIMIT 1)
             RETURNING role, groups",
        )
        .bind(self.now.as_millis())
        .bind(folded(email))
        .fetch_optional(&mut self.connection)
        .await?;
        let Some((role, groups)) = offered else {
            return Ok(None);
        };
        Ok(Some((variant(&role)?, parsed(&groups, "groups")?)))
    }

    async fn groups_named(&mut self, names: &[String]) -> Result<Vec<Uuid>> {
        let mut groups = Vec::new();
        for name in names {
            let found = query_scalar("SELECT id FROM groups WHERE folded = ?")
                .bind(folded(name))
                .fetch_optional(&mut self.connection)
                .await?;
            match found {
                Some(id) => groups.push(id),
                None => tracing::warn!(
                    group = name,
                    "single sign-on puts people into a group that is not there"
                ),
            }
        }
        Ok(groups)
    }

    /// A new account under the first name that can be had.
    async fn add_person_of(&mut self, identity: &Identity, role: Role) -> Result<(Uuid, String)> {
        let fit = identity
            .names
            .iter()
            .filter_map(|name| clean_name("/name", name).ok());
        let names: Vec<String> = fit.collect();
        let first = names.first().map_or("Somebody", String::as_str).to_owned();
        let numbered =
            (2..NAMES_TRIED).filter_map(|n| clean_name("/name", &format!("{first} {n}")).ok());
        for name in names.iter().cloned().chain(numbered) {
            match self.add_person(&name, role, "").await {
                Ok(id) => {
                    self.add_identity(identity, id).await?;
                    return Ok((id, name));
                }
                Err(StoreError::Refused(_)) => {}
                Err(error) => return Err(error),
            }
        }
        let sentence = format!("every name like {first:?} is taken here");
        Err(StoreError::Conflict(sentence))
    }

    /// From here on the change is that of this person, who was nobody before.
    pub(super) fn act_as(&mut self, name: &str, person: Uuid) {
        if let Some(actor) = &mut self.actor {
            let mut known = (**actor).clone();
            (known.who, known.person) = (name.to_owned(), Some(person));
            *actor = std::sync::Arc::new(known);
        }
    }
}

/// An e-mail address in the form in which addresses are compared.
pub(super) fn clean_email(given: &str) -> Option<String> {
    const LONGEST: usize = 254;
    let email = folded(given.trim());
    let is_plain = |c: char| !c.is_whitespace() && !c.is_control();
    let (name, host) = email.split_once('@')?;
    let is_whole = !name.is_empty() && !host.contains('@') && host.contains('.');
    (is_whole && email.len() <= LONGEST && email.chars().all(is_plain)).then_some(email)
}
