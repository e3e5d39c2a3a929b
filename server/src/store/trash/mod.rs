//! What was deleted, until it is brought back or its time is over.
//!
//! A job that is deleted leaves its tables: its [`rows`] go to mirrors of them, so that no list, count,
//! stream, link or worker meets it. It comes back to its old place, with its number and all that it had; a
//! queued one waits again. A project is hidden, and its jobs go and come with it, some at a time. What can
//! be brought back, and by whom, stands in [`listing`].
mod listing;
mod rows;

use loadframe_api::Timestamp;
use loadframe_api::people::Deleted;
use tokio::sync::oneshot;
use uuid::Uuid;

use super::Store;
use super::clock::millis;
use super::database::{query, query_as, query_scalar};
use super::error::{Result, StoreError};
use super::people::Actor;
use super::state::LifecycleRow;
use super::writer::{Change, EventType};
use crate::tasks;
pub use listing::TrashSight;
use listing::missing;

/// Jobs that go or come in one change: others wait for it.
const AT_ONCE: u32 = 50;

impl Store {
    /// How long something stays in the trash, in the database's unit.
    pub(super) fn trash_millis(&self) -> i64 {
        millis(self.options().trash)
    }

    /// What was deleted until then is gone.
    fn gone_before(&self) -> i64 {
        self.now().as_millis() - self.trash_millis()
    }

    /// Moves the job with its curve, log and files to the trash.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] while it runs.
    pub async fn discard(&self, id: Uuid) -> Result<()> {
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let name = change.discard(id, false).await?;
                change.audit("job.deleted", Some(id), &name).await
            })
        })
        .await
    }

    /// Moves a project with all its jobs to the trash, or none of them. Broken off in between, it goes on
    /// where it was when it is asked again.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] while one of its jobs runs.
    pub async fn discard_project(&self, id: Uuid) -> Result<()> {
        let (answer, answered) = oneshot::channel();
        let store = self.clone();
        // whoever asks may go before it is done, or undone
        tasks::spawn(async move {
            let _ = answer.send(store.discard_whole(id).await);
        });
        answered.await.unwrap_or(Err(StoreError::Unavailable))
    }

    async fn discard_whole(&self, id: Uuid) -> Result<()> {
        loop {
            let discarded = self.write_from_reserve(move |change| {
                Box::pin(async move { change.discard_some(id).await })
            });
            match discarded.await {
                Ok(true) => return Ok(()),
                Ok(false) => {}
                Err(StoreError::Conflict(why)) => {
                    self.undo_discard(id).await?;
                    return Err(StoreError::Conflict(why));
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Brings the jobs back that went before one was found running: a worker may take one between two
    /// changes. In one change they could not go, for all others would wait for those of a large project.
    async fn undo_discard(&self, project: Uuid) -> Result<()> {
        loop {
            let brought = self.write_from_reserve(move |change| {
                Box::pin(async move { change.bring_back_some(project).await.map(|(_, done)| done) })
            });
            match brought.await {
                // somebody else deleted the project meanwhile
                Ok(true) | Err(StoreError::NotFound(_)) => return Ok(()),
                Ok(false) => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Brings back what `id` names in the trash.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] for a job whose project is deleted.
    pub async fn bring_back(&self, id: Uuid) -> Result<()> {
        let after = self.gone_before();
        match self.in_trash(id).await?.0 {
            Deleted::Job => {
                self.write(move |change| {
                    Box::pin(async move {
                        let name = change.bring_back(id, after).await?;
                        change.audit("job.restored", Some(id), &name).await
                    })
                })
                .await
            }
            Deleted::Project => {
                self.write(move |change| {
                    Box::pin(async move { change.bring_back_project(id, after).await })
                })
                .await?;
                while !self
                    .write(move |change| {
                        Box::pin(async move {
                            let (name, is_done) = change.bring_back_some(id).await?;
                            if is_done {
                                change.audit("project.restored", Some(id), &name).await?;
                            }
                            Ok(is_done)
                        })
                    })
                    .await?
                {}
                Ok(())
            }
            Deleted::Files => self.undo_retention(id).await.map(|_| ()),
        }
    }

    /// Removes for good what `id` names in the trash.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] for files that a rule removed, which go when
    /// their time is over.
    pub async fn erase(&self, id: Uuid) -> Result<()> {
        match self.in_trash(id).await?.0 {
            Deleted::Job => {
                self.write_from_reserve(move |change| {
                    Box::pin(async move {
                        let job = query_scalar("SELECT job FROM trash WHERE id = ?")
                            .bind(id)
                            .fetch_optional(&mut change.connection)
                            .await?;
                        change.erase(job.ok_or_else(|| missing(id))?).await
                    })
                })
                .await?;
            }
            Deleted::Project => {
                let after = self.gone_before();
                self.write_from_reserve(move |change| {
                    Box::pin(async move { change.erase_project(id, after).await })
                })
                .await?;
                while self
                    .write_from_reserve(move |change| {
                        Box::pin(async move { change.erase_some(id).await })
                    })
                    .await?
                {}
            }
            Deleted::Files => {
                let sentence = "what a project's rule removed goes when its time is over";
                return Err(StoreError::Conflict(sentence.to_owned()));
            }
        }
        self.blobs().collected().await;
        Ok(())
    }

    /// Removes the jobs whose time in the trash is over as of `now`; tells how many.
    ///
    /// # Errors
    /// The database's.
    pub async fn empty_trash(&self, now: Timestamp) -> Result<u64> {
        let before = now.as_millis() - self.trash_millis();
        let server = self.acting(Actor::named("server"));
        let mut erased = 0;
        loop {
            let jobs = server
                .write_from_reserve(move |change| {
                    Box::pin(async move {
                        let jobs: Vec<i64> = query_scalar(
                            "SELECT job FROM trash WHERE deleted_at < ? ORDER BY deleted_at, id LIMIT ?",
                        )
                        .bind(before)
                        .bind(AT_ONCE)
                        .fetch_all(&mut change.connection)
                        .await?;
                        for job in &jobs {
                            change.erase(*job).await?;
                        }
                        Ok(jobs.len())
                    })
                })
                .await?;
            erased += jobs as u64;
            if jobs < AT_ONCE as usize {
                return Ok(erased);
            }
        }
    }
}

impl Change {
    /// Moves a job to the trash; tells its name.
    async fn discard(&mut self, id: Uuid, with_project: bool) -> Result<String> {
        let job = LifecycleRow::of(&mut self.connection, id).await?;
        job.require_idle()?;
        rows::copy_to_trash(&mut self.connection, job.seq).await?;
        // what it takes is taken once: first it goes there, then it counts here
        self.leave_list(&job).await?;
        let by = self.actor.as_ref().map(|actor| actor.who.clone());
        let name = query_scalar(
            "INSERT INTO trash (job, id, kind, name, owner, project, files, bytes, deleted_at,
                                deleted_by, with_project)
             SELECT seq, id, kind, name, owner, project,
                (SELECT COUNT(*) FROM trashed_attempts a JOIN trashed_attempt_files f ON f.attempt = a.seq
                 WHERE a.job = trashed_jobs.seq), file_bytes, ?2, ?3, ?4
             FROM trashed_jobs WHERE seq = ?1 RETURNING name",
        )
        .bind(job.seq)
        .bind(self.now.as_millis())
        .bind(by.unwrap_or_else(|| "owner".to_owned()))
        .bind(with_project)
        .fetch_one(&mut self.connection)
        .await?;
        // what its files take is counted anew when they come back
        query("UPDATE trashed_jobs SET file_bytes = 0 WHERE seq = ?")
            .bind(job.seq)
            .execute(&mut self.connection)
            .await?;
        Ok(name)
    }

    /// Moves the next jobs of a project to the trash, and when none is left the project; tells whether it
    /// is done.
    async fn discard_some(&mut self, project: Uuid) -> Result<bool> {
        let name: Option<String> =
            query_scalar("SELECT name FROM projects WHERE id = ? AND deleted_at IS NULL")
                .bind(project)
                .fetch_optional(&mut self.connection)
                .await?;
        let name = name.ok_or_else(|| StoreError::NotFound(format!("project {project}")))?;
        let running: i64 = query_scalar(
            "SELECT COUNT(*) FROM attempts a JOIN jobs j ON j.seq = a.job
             WHERE a.ended_at IS NULL AND j.project = ?",
        )
        .bind(project)
        .fetch_one(&mut self.connection)
        .await?;
        if running > 0 {
            let sentence = match running {
                1 => "a job of it is running; cancel it first".to_owned(),
                jobs => format!("{jobs} jobs of it are running; cancel them first"),
            };
            return Err(StoreError::Conflict(sentence));
        }
        let jobs: Vec<Uuid> =
            query_scalar("SELECT id FROM jobs WHERE project = ? ORDER BY seq LIMIT ?")
                .bind(project)
                .bind(AT_ONCE)
                .fetch_all(&mut self.connection)
                .await?;
        for job in &jobs {
            let name = self.discard(*job, true).await?;
            self.audit("job.deleted", Some(*job), &name).await?;
        }
        if jobs.len() == AT_ONCE as usize {
            return Ok(false);
        }
        let by = self.actor.as_ref().map(|actor| actor.who.clone());
        query("UPDATE projects SET deleted_at = ?, deleted_by = ? WHERE id = ?")
            .bind(self.now.as_millis())
            .bind(by)
            .bind(project)
            .execute(&mut self.connection)
            .await?;
        self.audit("project.deleted", Some(project), &name).await?;
        Ok(true)
    }

    /// Brings a job back; tells its name.
    async fn bring_back(&mut self, id: Uuid, after: i64) -> Result<String> {
        let found: Option<(i64, String, Option<i64>)> = query_as(
            "DELETE FROM trash WHERE id = ? RETURNING job, name,
                (SELECT deleted_at FROM projects p WHERE p.id = trash.project)",
        )
        .bind(id)
        .fetch_optional(&mut self.connection)
        .await?;
        let (job, name, without_project_since) = found.ok_or_else(|| missing(id))?;
        if without_project_since.is_some_and(|since| since > after) {
            let sentence = "its project is deleted; bring the project back first";
            return Err(StoreError::Conflict(sentence.to_owned()));
        }
        rows::bring_back(&mut self.connection, job).await?;
        if without_project_since.is_some() {
            // the project is gone for good: the job goes where its owner's new ones do
            self.bring_home(id).await?;
        }
        query("DELETE FROM events WHERE job = ?")
            .bind(id)
            .execute(&mut self.connection)
            .await?;
        self.event(id, EventType::Job).await?;
        self.queued();
        Ok(name)
    }

    /// Puts a job whose project is gone where its owner's new jobs go.
    async fn bring_home(&mut self, id: Uuid) -> Result<()> {
        let moved = query(
            "UPDATE jobs SET project = home.id FROM (SELECT p.id FROM projects p JOIN jobs j ON j.owner = p.person
                WHERE j.id = ?1 AND p.archived_at IS NULL AND p.deleted_at IS NULL AND NOT p.is_received
                ORDER BY p.created_at, p.id LIMIT 1) AS home WHERE jobs.id = ?1",
        )
        .bind(id)
        .execute(&mut self.connection)
        .await?;
        if moved.rows_affected() == 0 {
            let sentence = "its project is gone, and its owner has no other that takes jobs: make one, or bring one back, and then the job";
            return Err(StoreError::Conflict(sentence.to_owned()));
        }
        Ok(())
    }

    /// Refuses unless the project was deleted after `after`, and nobody brought it back.
    async fn require_deleted(&mut self, project: Uuid, after: i64) -> Result<()> {
        let found: Option<Uuid> =
            query_scalar("SELECT id FROM projects WHERE id = ? AND deleted_at > ?")
                .bind(project)
                .bind(after)
                .fetch_optional(&mut self.connection)
                .await?;
        found.map(|_| ()).ok_or_else(|| missing(project))
    }

    /// Has a project be gone at once, with the jobs that were deleted with it: nobody brings it back while they
    /// are removed, and what a crash leaves of them goes with all whose time is over.
    async fn erase_project(&mut self, project: Uuid, after: i64) -> Result<()> {
        // somebody may have brought it back since it was looked for
        self.require_deleted(project, after).await?;
        // long ago: its time is over
        for sql in [
            "UPDATE projects SET deleted_at = 0 WHERE id = ?",
            "UPDATE trash SET deleted_at = 0 WHERE project = ? AND with_project",
        ] {
            query(sql)
                .bind(project)
                .execute(&mut self.connection)
                .await?;
        }
        self.audit("project.erased", Some(project), "").await
    }

    /// Removes the next jobs of a project that is gone; whether there may be more.
    async fn erase_some(&mut self, project: Uuid) -> Result<bool> {
        let jobs: Vec<i64> =
            query_scalar("SELECT job FROM trash WHERE project = ? AND with_project LIMIT ?")
                .bind(project)
                .bind(AT_ONCE)
                .fetch_all(&mut self.connection)
                .await?;
        for job in &jobs {
            self.erase(*job).await?;
        }
        Ok(jobs.len() == AT_ONCE as usize)
    }

    /// Brings a project back without its jobs.
    async fn bring_back_project(&mut self, project: Uuid, after: i64) -> Result<()> {
        // somebody may have removed it for good since it was looked for
        self.require_deleted(project, after).await?;
        query("UPDATE projects SET deleted_at = NULL, deleted_by = NULL WHERE id = ?")
            .bind(project)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }

    /// Brings the next jobs of a project back that is there; tells its name and whether it is done.
    async fn bring_back_some(&mut self, project: Uuid) -> Result<(String, bool)> {
        let name: Option<String> =
            query_scalar("SELECT name FROM projects WHERE id = ? AND deleted_at IS NULL")
                .bind(project)
                .fetch_optional(&mut self.connection)
                .await?;
        let name = name.ok_or_else(|| missing(project))?;
        let jobs: Vec<Uuid> = query_scalar(
            "SELECT id FROM trash WHERE project = ? AND with_project ORDER BY job LIMIT ?",
        )
        .bind(project)
        .bind(AT_ONCE)
        .fetch_all(&mut self.connection)
        .await?;
        for job in &jobs {
            let name = self.bring_back(*job, i64::MIN).await?;
            self.audit("job.restored", Some(*job), &name).await?;
        }
        Ok((name, jobs.len() < AT_ONCE as usize))
    }

    /// Removes a job from the trash for good.
    async fn erase(&mut self, job: i64) -> Result<()> {
        let (id, name): (Uuid, String) =
            query_as("DELETE FROM trash WHERE job = ? RETURNING id, name")
                .bind(job)
                .fetch_one(&mut self.connection)
                .await?;
        let files = rows::files(&mut self.connection, job).await?;
        self.garbage(files);
        rows::remove(&mut self.connection, job).await?;
        self.audit("job.erased", Some(id), &name).await
    }
}
