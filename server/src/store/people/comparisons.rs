//! Comparisons: jobs that are looked at side by side, under a name.
//!
//! The jobs of a comparison never change: another choice is another comparison. So whoever has a link to
//! one sees what its maker saw, and no more.
use loadframe_api::Timestamp;
use loadframe_api::comparison::{ComparisonChanges, ComparisonView, NewComparison};
use loadframe_api::people::Named;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{Connection, query, query_as, query_scalar, row};
use super::super::error::{Result, StoreError};
use super::super::jobs::hex_names;
use super::checks::clean_name;
use crate::access::{ComparisonFacts, ProjectFacts, Sight};

/// Comparisons in a list.
const LONGEST_LIST: u32 = 1_000;

row! {
    struct ComparisonRow {
        id: Uuid,
        name: String,
        view: String,
        jobs: i64,
        owner: Option<Uuid>,
        owner_name: Option<String>,
        project: Option<Uuid>,
        project_name: Option<String>,
        created_at: i64,
    }
}

/// The statement that reads comparisons, ended by `$rest`.
macro_rules! select_comparisons {
    ($rest:literal) => {
        concat!(
            "SELECT c.id, c.name, c.view, c.owner, o.name AS owner_name, c.project,
                p.name AS project_name, c.created_at,
                (SELECT COUNT(*) FROM comparison_jobs n WHERE n.comparison = c.id) AS jobs
             FROM comparisons c LEFT JOIN people o ON o.id = c.owner
             LEFT JOIN projects p ON p.id = c.project ",
            $rest
        )
    };
}

impl ComparisonRow {
    async fn of(connection: &mut Connection, id: Uuid) -> Result<Self> {
        query_as(select_comparisons!("WHERE c.id = ?"))
            .bind(id)
            .fetch_optional(connection)
            .await?
            .ok_or_else(|| missing(id))
    }

    fn view(self) -> ComparisonView {
        let named = |id: Option<Uuid>, name: Option<String>| {
            id.zip(name).map(|(id, name)| Named { id, name })
        };
        ComparisonView {
            id: self.id,
            name: self.name,
            view: self.view,
            count: self.jobs.unsigned_abs(),
            jobs: None,
            created_at: Timestamp(self.created_at),
            owner: named(self.owner, self.owner_name),
            project: named(self.project, self.project_name),
        }
    }
}

fn missing(id: Uuid) -> StoreError {
    StoreError::NotFound(format!("comparison {id}"))
}

impl Store {
    /// Keeps a comparison of jobs that its maker sees.
    ///
    /// # Errors
    /// [`StoreError::Refused`] for a name that nobody can read.
    pub async fn create_comparison(
        &self,
        owner: Option<Uuid>,
        new: NewComparison,
    ) -> Result<ComparisonView> {
        let name = clean_name("/name", &new.name)?;
        let id = Uuid::now_v7();
        let jobs = hex_names(&new.jobs)?;
        self.write(move |change| {
            Box::pin(async move {
                query(
                    "INSERT INTO comparisons (id, name, view, owner, project, created_at)
                     VALUES (?1, ?2, ?3,
                        COALESCE(?4, (SELECT id FROM people WHERE role = 'administrator'
                                      ORDER BY created_at LIMIT 1)), ?5, ?6)",
                )
                .bind(id)
                .bind(&name)
                .bind(new.view)
                .bind(owner)
                .bind(new.project)
                .bind(change.now.as_millis())
                .execute(&mut change.connection)
                .await?;
                query(
                    "INSERT INTO comparison_jobs (comparison, place, job)
                     SELECT ?, key, unhex(value) FROM json_each(?)",
                )
                .bind(id)
                .bind(jobs)
                .execute(&mut change.connection)
                .await?;
                change.audit("comparison.made", Some(id), &name).await?;
                Ok(ComparisonRow::of(&mut change.connection, id).await?.view())
            })
        })
        .await
    }

    /// The comparison, without its jobs.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn comparison(&self, id: Uuid) -> Result<ComparisonView> {
        let mut connection = self.reads().acquire().await?;
        Ok(ComparisonRow::of(&mut connection, id).await?.view())
    }

    /// The jobs of a comparison, in order, whether or not they are still there.
    ///
    /// # Errors
    /// The database's.
    pub async fn comparison_jobs(&self, id: Uuid) -> Result<Vec<Uuid>> {
        let jobs =
            query_scalar("SELECT job FROM comparison_jobs WHERE comparison = ? ORDER BY place")
                .bind(id)
                .fetch_all(self.reads())
                .await?;
        Ok(jobs)
    }

    /// Comparisons that `sight` shows, the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn comparisons(&self, sight: &Sight) -> Result<Vec<ComparisonView>> {
        let rows: Vec<ComparisonRow> = query_as(select_comparisons!(
            "WHERE ?1 OR c.owner = ?2 OR c.id = ?3
                OR c.project IN (SELECT unhex(value) FROM json_each(?4))
             ORDER BY c.created_at DESC, c.id DESC LIMIT ?5"
        ))
        .bind(sight.everything)
        .bind(sight.owner)
        .bind(sight.comparison)
        .bind(hex_names(&sight.projects)?)
        .bind(LONGEST_LIST)
        .fetch_all(self.reads())
        .await?;
        Ok(rows.into_iter().map(ComparisonRow::view).collect())
    }

    /// Renames a comparison, or shows it otherwise.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Refused`] for a name that nobody can read.
    pub async fn change_comparison(
        &self,
        id: Uuid,
        changes: ComparisonChanges,
    ) -> Result<ComparisonView> {
        let name = changes.name.as_deref();
        let name = name.map(|name| clean_name("/name", name)).transpose()?;
        self.write(move |change| {
            Box::pin(async move {
                query(
                    "UPDATE comparisons SET name = COALESCE(?, name), view = COALESCE(?, view)
                     WHERE id = ?",
                )
                .bind(name)
                .bind(changes.view)
                .bind(id)
                .execute(&mut change.connection)
                .await?;
                let row = ComparisonRow::of(&mut change.connection, id).await?;
                change
                    .audit("comparison.changed", Some(id), &row.name)
                    .await?;
                Ok(row.view())
            })
        })
        .await
    }

    /// Removes a comparison, and with it what its links show; its jobs stay.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn delete_comparison(&self, id: Uuid) -> Result<()> {
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let name: Option<String> =
                    query_scalar("DELETE FROM comparisons WHERE id = ? RETURNING name")
                        .bind(id)
                        .fetch_optional(&mut change.connection)
                        .await?;
                let name = name.ok_or_else(|| missing(id))?;
                change.audit("comparison.deleted", Some(id), &name).await
            })
        })
        .await
    }

    /// Whose the comparison is, of these projects.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn comparison_facts(
        &self,
        id: Uuid,
        projects: &[ProjectFacts],
    ) -> Result<ComparisonFacts> {
        let row: Option<(Option<Uuid>, Option<Uuid>)> =
            query_as("SELECT owner, project FROM comparisons WHERE id = ?")
                .bind(id)
                .fetch_optional(self.lookups())
                .await?;
        let (owner, project) = row.ok_or_else(|| missing(id))?;
        let is_its = |of: &ProjectFacts| Some(of.id) == project;
        Ok(ComparisonFacts {
            id,
            owner,
            project: projects.iter().find(|of| is_its(of)).cloned(),
        })
    }
}
