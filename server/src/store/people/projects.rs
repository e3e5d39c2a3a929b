//! Projects: jobs that belong together, of a person or of a group.
use loadframe_api::Timestamp;
use loadframe_api::people::{Named, NewProject, ProjectChanges, ProjectView, Visibility};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{Connection, query, query_as, query_scalar, row};
use super::super::encoding::{variant, wire_name};
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::checks::{clean_name, refused};

row! {
    struct ProjectRow {
        id: Uuid,
        name: String,
        visibility: String,
        person: Option<Uuid>,
        person_name: Option<String>,
        team: Option<Uuid>,
        team_name: Option<String>,
        created_at: i64,
        archived_at: Option<i64>,
    }
}

/// The statement that reads projects, ended by `$rest`.
macro_rules! select_projects {
    ($rest:literal) => {
        concat!(
            "SELECT p.id, p.name, p.visibility, p.person, o.name AS person_name, p.team,
                g.name AS team_name, p.created_at, p.archived_at
             FROM projects p LEFT JOIN people o ON o.id = p.person LEFT JOIN groups g ON g.id = p.team ",
            $rest
        )
    };
}

impl ProjectRow {
    async fn of(connection: &mut Connection, id: Uuid) -> Result<Self> {
        query_as(select_projects!("WHERE p.id = ? AND p.deleted_at IS NULL"))
            .bind(id)
            .fetch_optional(connection)
            .await?
            .ok_or_else(|| StoreError::NotFound(format!("project {id}")))
    }

    fn view(self) -> Result<ProjectView> {
        let named = |id: Option<Uuid>, name: Option<String>| {
            id.zip(name).map(|(id, name)| Named { id, name })
        };
        Ok(ProjectView {
            id: self.id,
            name: self.name,
            visibility: variant(&self.visibility)?,
            person: named(self.person, self.person_name),
            group: named(self.team, self.team_name),
            created_at: Timestamp(self.created_at),
            archived_at: self.archived_at.map(Timestamp),
        })
    }
}

impl Store {
    /// Every project, by name; who asks sees those that the rules show.
    ///
    /// # Errors
    /// The database's.
    pub async fn projects(&self) -> Result<Vec<ProjectView>> {
        let rows: Vec<ProjectRow> = query_as(select_projects!(
            "WHERE p.deleted_at IS NULL ORDER BY p.archived_at IS NOT NULL, p.name, p.id"
        ))
        .fetch_all(self.reads())
        .await?;
        rows.into_iter().map(ProjectRow::view).collect()
    }

    /// Makes a project of `person`, or of the group that is named.
    ///
    /// # Errors
    /// [`StoreError::Refused`] for a name, group or visibility that cannot be.
    pub async fn create_project(&self, person: Uuid, new: NewProject) -> Result<ProjectView> {
        let name = clean_name("/name", &new.name)?;
        self.write(move |change| {
            Box::pin(async move {
                if let Some(group) = new.group {
                    change.check_group("/group", group).await?;
                }
                let owner = new.group.is_none().then_some(person);
                check_visibility(new.group, new.visibility)?;
                let id = change
                    .add_project(&name, owner, new.group, new.visibility)
                    .await?;
                change.audit("project.made", Some(id), &name).await?;
                ProjectRow::of(&mut change.connection, id).await?.view()
            })
        })
        .await
    }

    /// Renames, shows, archives or hands over a project.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Refused`] for what cannot be.
    pub async fn change_project(&self, id: Uuid, changes: ProjectChanges) -> Result<ProjectView> {
        let name = changes.name.as_deref();
        let name = name.map(|name| clean_name("/name", name)).transpose()?;
        if changes.person.is_some() && changes.group.is_some() {
            let detail = "a project belongs to a person or to a group";
            return Err(refused(
                "/group",
                "two_owners",
                detail,
                "both",
                "one of the two",
            ));
        }
        self.write(move |change| {
            Box::pin(async move {
                let before = ProjectRow::of(&mut change.connection, id).await?;
                let was_archived = before.archived_at;
                let before = before.view()?;
                if let Some(person) = changes.person {
                    change.owner_to_be("/person", person).await?;
                }
                if let Some(group) = changes.group {
                    change.check_group("/group", group).await?;
                }
                let owner = before.person.map(|of| of.id);
                let (person, group) = match (changes.person, changes.group) {
                    (None, None) => (owner, before.group.map(|of| of.id)),
                    given => given,
                };
                let is_given = changes.person.is_some() && person != owner;
                let visibility = changes.visibility.unwrap_or(before.visibility);
                check_visibility(group, visibility)?;
                let archived_at = match changes.archived {
                    Some(true) => was_archived.or(Some(change.now.as_millis())),
                    Some(false) => None,
                    None => was_archived,
                };
                query(
                    "UPDATE projects SET name = ?, visibility = ?, person = ?, team = ?,
                        archived_at = ?, is_received = is_received OR ? WHERE id = ?",
                )
                .bind(name.unwrap_or(before.name))
                .bind(wire_name(&visibility)?)
                .bind(person)
                .bind(group)
                .bind(archived_at)
                .bind(is_given)
                .bind(id)
                .execute(&mut change.connection)
                .await?;
                let after = ProjectRow::of(&mut change.connection, id).await?.view()?;
                let owner = after.person.as_ref().or(after.group.as_ref());
                let detail = format!(
                    "{} of {}: {}{}",
                    after.name,
                    owner.map_or("", |owner| &owner.name),
                    wire_name(&after.visibility)?,
                    if after.archived_at.is_some() {
                        ", archived"
                    } else {
                        ""
                    }
                );
                change.audit("project.changed", Some(id), &detail).await?;
                Ok(after)
            })
        })
        .await
    }

    /// The project that jobs of a person go to unless told otherwise: the oldest of their own making that
    /// is not archived. One that was given to them may be seen by whom its giver chose.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] when there is none.
    pub async fn project_of(&self, person: Uuid) -> Result<Uuid> {
        let found = query_scalar(
            "SELECT id FROM projects WHERE person = ? AND archived_at IS NULL AND deleted_at IS NULL
                AND NOT is_received ORDER BY created_at, id LIMIT 1",
        )
        .bind(person)
        .fetch_optional(self.lookups())
        .await?;
        found.ok_or_else(takes_no_jobs)
    }
}

/// A person without a project of their own making, or whose are all archived.
pub(in crate::store) fn takes_no_jobs() -> StoreError {
    let sentence = "you have no project of your own making that takes jobs; make one, bring one back, or name one";
    StoreError::Conflict(sentence.to_owned())
}

impl Change {
    pub(super) async fn add_project(
        &mut self,
        name: &str,
        person: Option<Uuid>,
        group: Option<Uuid>,
        visibility: Visibility,
    ) -> Result<Uuid> {
        let id = Uuid::now_v7();
        query(
            "INSERT INTO projects (id, name, person, team, visibility, created_at)
             VALUES (?, ?, ?, ?, ?, ?)",
        )
        .bind(id)
        .bind(name)
        .bind(person)
        .bind(group)
        .bind(wire_name(&visibility)?)
        .bind(self.now.as_millis())
        .execute(&mut self.connection)
        .await?;
        Ok(id)
    }
}

fn check_visibility(group: Option<Uuid>, visibility: Visibility) -> Result<()> {
    if group.is_some() && visibility == Visibility::Private {
        let detail = "a group's project is seen by the group";
        let allowed = "one of: group, everyone";
        return Err(refused(
            "/visibility",
            "not_private",
            detail,
            "private",
            allowed,
        ));
    }
    Ok(())
}
