//! People: the first administrator, roles, leaving, handing over.
use loadframe_api::Timestamp;
use loadframe_api::people::{PersonChanges, PersonLimits, PersonView, Role, Visibility};
use uuid::Uuid;

use super::super::database::{Connection, query, query_as, query_scalar, row};
use super::super::encoding::{variant, wire_name};
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::super::{IdempotencyKey, Store};
use super::checks::{clean_name, folded, refused};
use crate::access::password;
use crate::tasks::blocking;

row! {
    pub(super) struct PersonRow {
        id: Uuid,
        name: String,
        role: String,
        created_at: i64,
        left_at: Option<i64>,
        most_running: Option<u32>,
        most_queued_core_h: Option<f64>,
        most_disk_gb: Option<f64>,
        may_hurry: bool,
    }
}

macro_rules! select_people {
    ($which:literal) => {
        concat!(
            "SELECT id, name, role, created_at, left_at, most_running, most_queued_core_h,
                most_disk_gb, may_hurry OR role = 'administrator' AS may_hurry FROM people ",
            $which
        )
    };
}

impl PersonRow {
    pub(super) async fn of(connection: &mut Connection, id: Uuid) -> Result<Self> {
        query_as(select_people!("WHERE id = ?"))
            .bind(id)
            .fetch_optional(connection)
            .await?
            .ok_or_else(|| StoreError::NotFound(format!("person {id}")))
    }

    pub(super) fn view(self) -> Result<PersonView> {
        Ok(PersonView {
            limits: PersonLimits {
                running: self.most_running,
                queued_core_h: self.most_queued_core_h,
                disk_gb: self.most_disk_gb,
                may_hurry: self.may_hurry,
            },
            id: self.id,
            name: self.name,
            role: variant(&self.role)?,
            created_at: Timestamp(self.created_at),
            left_at: self.left_at.map(Timestamp),
        })
    }
}

impl Store {
    /// Makes a server of one person a group's: the first administrator, who gets every job and token
    /// there is.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] where there are people already; [`StoreError::Refused`] for a name or
    /// a password that cannot be taken.
    pub async fn create_first_administrator(
        &self,
        name: &str,
        password: &str,
    ) -> Result<PersonView> {
        let name = clean_name("/name", name)?;
        let kept = hashed("/password", password.to_owned()).await?;
        let made = self
            .write_large(move |change| {
                Box::pin(async move {
                    let has_people: bool = query_scalar("SELECT EXISTS (SELECT 1 FROM people)")
                        .fetch_one(&mut change.connection)
                        .await?;
                    if has_people {
                        let sentence = "this server has people already; an administrator invites more";
                        return Err(StoreError::Conflict(sentence.to_owned()));
                    }
                    let id = change.add_person(&name, Role::Administrator, &kept).await?;
                    for statement in [
                        "UPDATE jobs SET owner = ?1, project = (SELECT id FROM projects WHERE person = ?1)",
                        "UPDATE comparisons SET owner = ?1",
                        "UPDATE tokens SET person = ?1 WHERE person IS NULL AND scope <> 'worker'",
                    ] {
                        query(statement).bind(id).execute(&mut change.connection).await?;
                    }
                    // and what is repeated of before is no second job
                    query("UPDATE idempotency_keys SET key = ? || key")
                        .bind(IdempotencyKey::of_person(id))
                        .execute(&mut change.connection)
                        .await?;
                    change.audit("person.first", Some(id), &name).await?;
                    PersonRow::of(&mut change.connection, id).await?.view()
                })
            })
            .await?;
        self.access_state().refresh(self.lookups()).await?;
        Ok(made)
    }

    /// Everybody, by name.
    ///
    /// # Errors
    /// The database's.
    pub async fn people(&self) -> Result<Vec<PersonView>> {
        let rows: Vec<PersonRow> = query_as(select_people!("ORDER BY folded"))
            .fetch_all(self.reads())
            .await?;
        rows.into_iter().map(PersonRow::view).collect()
    }

    /// Changes the role of a person, or ends or opens the account.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] where no administrator would be left.
    pub async fn change_person(&self, id: Uuid, changes: PersonChanges) -> Result<PersonView> {
        self.write(move |change| {
            Box::pin(async move {
                let before = PersonRow::of(&mut change.connection, id).await?;
                let role = changes.role.as_ref().map(wire_name).transpose()?;
                let role = role.unwrap_or(before.role);
                let left_at = match changes.left {
                    Some(true) => before.left_at.or(Some(change.now.as_millis())),
                    Some(false) => None,
                    None => before.left_at,
                };
                query("UPDATE people SET role = ?, left_at = ? WHERE id = ?")
                    .bind(&role)
                    .bind(left_at)
                    .bind(id)
                    .execute(&mut change.connection)
                    .await?;
                change.check_administrators().await?;
                if left_at.is_some() {
                    change.end_access_of(id).await?;
                }
                let state = if left_at.is_some() { ", has left" } else { "" };
                let detail = format!("{}: {role}{state}", before.name);
                change.audit("person.changed", Some(id), &detail).await?;
                PersonRow::of(&mut change.connection, id).await?.view()
            })
        })
        .await
    }

    /// Hands all jobs and projects of a person over to another.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Refused`] where the other cannot own jobs.
    pub async fn hand_over(&self, from: Uuid, to: Uuid) -> Result<()> {
        self.write_large(move |change| {
            Box::pin(async move {
                let giver = PersonRow::of(&mut change.connection, from).await?;
                let taker = change.owner_to_be("/to", to).await?;
                let jobs = query("UPDATE jobs SET owner = ? WHERE owner = ?")
                    .bind(to)
                    .bind(from)
                    .execute(&mut change.connection)
                    .await?
                    .rows_affected();
                query("UPDATE trash SET owner = ? WHERE owner = ?")
                    .bind(to)
                    .bind(from)
                    .execute(&mut change.connection)
                    .await?;
                query(
                    "UPDATE projects SET person = ?1, is_received = TRUE
                     WHERE person = ?2 AND person <> ?1",
                )
                .bind(to)
                .bind(from)
                .execute(&mut change.connection)
                .await?;
                query("UPDATE comparisons SET owner = ? WHERE owner = ?")
                    .bind(to)
                    .bind(from)
                    .execute(&mut change.connection)
                    .await?;
                let detail = format!("{} to {}: {jobs} jobs", giver.name, taker.name);
                change
                    .audit("person.handed_over", Some(from), &detail)
                    .await
            })
        })
        .await
    }

    /// Sets a password anew, whatever the one before was; ends the sessions of the person but `kept`.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Refused`] for a password that is too short.
    pub async fn set_password(&self, id: Uuid, password: &str, kept: Option<Uuid>) -> Result<()> {
        let hash = hashed("/new", password.to_owned()).await?;
        self.write(move |change| {
            Box::pin(async move {
                let person = PersonRow::of(&mut change.connection, id).await?;
                query("UPDATE people SET password = ? WHERE id = ?")
                    .bind(hash)
                    .bind(id)
                    .execute(&mut change.connection)
                    .await?;
                query("DELETE FROM sessions WHERE person = ? AND id IS DISTINCT FROM ?")
                    .bind(id)
                    .bind(kept)
                    .execute(&mut change.connection)
                    .await?;
                change
                    .audit("password.changed", Some(id), &person.name)
                    .await
            })
        })
        .await
    }

    /// Id and kept password of the person who signs in under `name`; nothing for who has left, and no
    /// password for who only comes by single sign-on.
    ///
    /// # Errors
    /// The database's.
    pub async fn password_of(&self, name: &str) -> Result<Option<(Uuid, Option<String>)>> {
        let found = query_as(
            "SELECT id, NULLIF(password, '') FROM people WHERE folded = ? AND left_at IS NULL",
        )
        .bind(folded(name.trim()))
        .fetch_optional(self.lookups())
        .await?;
        Ok(found)
    }
}

impl Change {
    /// Adds a person with a project of their own.
    pub(super) async fn add_person(&mut self, name: &str, role: Role, kept: &str) -> Result<Uuid> {
        let id = Uuid::now_v7();
        let added = query(
            "INSERT INTO people (id, name, folded, role, password, created_at)
             VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (folded) DO NOTHING",
        )
        .bind(id)
        .bind(name)
        .bind(folded(name))
        .bind(wire_name(&role)?)
        .bind(kept)
        .bind(self.now.as_millis())
        .execute(&mut self.connection)
        .await?;
        if added.rows_affected() == 0 {
            let detail = "somebody here has this name already";
            return Err(refused(
                "/name",
                "taken",
                detail,
                name,
                "a name that nobody here has",
            ));
        }
        let project = format!("Jobs of {name}");
        self.add_project(&project, Some(id), None, Visibility::Private)
            .await?;
        Ok(id)
    }

    /// Somebody who can own jobs and projects.
    pub(super) async fn owner_to_be(&mut self, pointer: &str, id: Uuid) -> Result<PersonView> {
        let person = PersonRow::of(&mut self.connection, id).await?.view()?;
        if person.left_at.is_none() && person.role != Role::Guest {
            return Ok(person);
        }
        let detail = "guests and people who have left own no jobs";
        let allowed = "a member or an administrator";
        Err(refused(
            pointer,
            "not_an_owner",
            detail,
            person.name,
            allowed,
        ))
    }

    async fn check_administrators(&mut self) -> Result<()> {
        let is_led: bool = query_scalar(
            "SELECT EXISTS (SELECT 1 FROM people WHERE role = 'administrator' AND left_at IS NULL)",
        )
        .fetch_one(&mut self.connection)
        .await?;
        if is_led {
            return Ok(());
        }
        let sentence = "this is the last administrator; make somebody else one first";
        Err(StoreError::Conflict(sentence.to_owned()))
    }

    /// Ends the sessions, tokens, links and webhooks of who leaves.
    async fn end_access_of(&mut self, person: Uuid) -> Result<()> {
        for statement in [
            "DELETE FROM sessions WHERE person = ?1 AND ?2 = ?2",
            "UPDATE tokens SET revoked_at = ?2 WHERE person = ?1 AND revoked_at IS NULL",
            "UPDATE shares SET revoked_at = ?2 WHERE person = ?1 AND revoked_at IS NULL",
            "UPDATE webhooks SET removed_at = ?2 WHERE person = ?1 AND removed_at IS NULL",
        ] {
            query(statement)
                .bind(person)
                .bind(self.now.as_millis())
                .execute(&mut self.connection)
                .await?;
        }
        Ok(())
    }
}

/// What is kept of a password, made off the threads that answer.
pub(super) async fn hashed(pointer: &'static str, given: String) -> Result<String> {
    if given.chars().count() < password::SHORTEST {
        let violation =
            loadframe_api::Violation::new(pointer, "too_short", "the password is too short")
                .allowed(format!("at least {} characters", password::SHORTEST));
        return Err(StoreError::Refused(vec![violation]));
    }
    let made = blocking(move || password::hash(&given)).await;
    made?.map_err(StoreError::corrupt("password"))
}
