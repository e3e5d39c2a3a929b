//! Groups: people who work together.
use std::collections::BTreeMap;

use loadframe_api::Timestamp;
use loadframe_api::people::{GroupView, Named};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, query_scalar};
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::accounts::PersonRow;
use super::checks::{clean_name, folded, refused};

impl Store {
    /// Makes a group.
    ///
    /// # Errors
    /// [`StoreError::Refused`] when there is one of this name.
    pub async fn create_group(&self, name: &str) -> Result<GroupView> {
        let name = clean_name("/name", name)?;
        let id = Uuid::now_v7();
        self.write(move |change| {
            Box::pin(async move {
                let added = query(
                    "INSERT INTO groups (id, name, folded, created_at) VALUES (?, ?, ?, ?)
                     ON CONFLICT (folded) DO NOTHING",
                )
                .bind(id)
                .bind(&name)
                .bind(folded(&name))
                .bind(change.now.as_millis())
                .execute(&mut change.connection)
                .await?;
                if added.rows_affected() == 0 {
                    let detail = "there is a group of this name already";
                    let allowed = "a name that no group has";
                    return Err(refused("/name", "taken", detail, name, allowed));
                }
                change.audit("group.made", Some(id), &name).await
            })
        })
        .await?;
        let group = self
            .groups()
            .await?
            .into_iter()
            .find(|group| group.id == id);
        group.ok_or(StoreError::Unavailable)
    }

    /// All groups with their members, by name.
    ///
    /// # Errors
    /// The database's.
    pub async fn groups(&self) -> Result<Vec<GroupView>> {
        let mut snapshot = self.reads().begin().await?;
        let groups: Vec<(Uuid, String, i64)> =
            query_as("SELECT id, name, created_at FROM groups ORDER BY folded")
                .fetch_all(&mut snapshot)
                .await?;
        let members: Vec<(Uuid, Uuid, String)> = query_as(
            "SELECT m.team, p.id, p.name FROM members m JOIN people p ON p.id = m.person
             ORDER BY p.folded",
        )
        .fetch_all(&mut snapshot)
        .await?;
        let mut of_group: BTreeMap<Uuid, Vec<Named>> = BTreeMap::new();
        for (group, id, name) in members {
            of_group.entry(group).or_default().push(Named { id, name });
        }
        let view = |(id, name, created_at)| GroupView {
            members: of_group.remove(&id).unwrap_or_default(),
            id,
            name,
            created_at: Timestamp(created_at),
        };
        Ok(groups.into_iter().map(view).collect())
    }

    /// Puts a person into a group, or takes it out; asking for what is so already is fine.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn set_member(&self, group: Uuid, person: Uuid, is_member: bool) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let name = change.group_name(group).await?;
                let person_name = PersonRow::of(&mut change.connection, person)
                    .await?
                    .view()?
                    .name;
                let (action, joined) = match is_member {
                    true => {
                        change.add_member(group, person).await?;
                        ("group.joined", "in")
                    }
                    false => {
                        query("DELETE FROM members WHERE team = ? AND person = ?")
                            .bind(group)
                            .bind(person)
                            .execute(&mut change.connection)
                            .await?;
                        ("group.left", "not in")
                    }
                };
                let detail = format!("{person_name} {joined} {name}");
                change.audit(action, Some(group), &detail).await
            })
        })
        .await
    }
}

impl Change {
    pub(super) async fn add_member(&mut self, group: Uuid, person: Uuid) -> Result<()> {
        query("INSERT INTO members (team, person) VALUES (?, ?) ON CONFLICT DO NOTHING")
            .bind(group)
            .bind(person)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }

    pub(super) async fn group_name(&mut self, id: Uuid) -> Result<String> {
        query_scalar("SELECT name FROM groups WHERE id = ?")
            .bind(id)
            .fetch_optional(&mut self.connection)
            .await?
            .ok_or_else(|| StoreError::NotFound(format!("group {id}")))
    }

    /// That the group which a request names is there.
    pub(super) async fn check_group(&mut self, pointer: &str, id: Uuid) -> Result<String> {
        match self.group_name(id).await {
            Err(StoreError::NotFound(_)) => {
                let (detail, allowed) = ("there is no such group", "the id of a group of yours");
                Err(refused(pointer, "unknown", detail, id.to_string(), allowed))
            }
            found => found,
        }
    }
}
