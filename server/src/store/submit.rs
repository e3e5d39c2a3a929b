//! What users do to jobs: submit, edit, ask, delete.
use loadframe_api::{Estimate, JobView, ReasonCode, Submission};
use uuid::Uuid;

use super::database::{FromRow, Query, query, query_as, query_scalar};
use super::encoding::{json, wire_name};
use super::error::{Result, StoreError};
use super::jobs::JobRow;
use super::people::{admission, takes_no_jobs};
use super::state::{LifecycleRow, sentence};
use super::writer::{Change, EventType};
use super::{CheckedSubmission, Enqueued, IdempotencyKey, JobEdit, Store, UserAction};
use crate::access::ARCHIVED;
use crate::queue::Input;
use crate::queue::needs::Needs;

/// What was submitted under a key.
const KEY: &str = "SELECT body_sha256, job FROM idempotency_keys WHERE key = ?";

/// The row of a new job.
struct NewJob {
    id: Uuid,
    kind: &'static str,
    name: String,
    notes: String,
    tags: String,
    priority: i32,
    threads: Option<u32>,
    estimate: Estimate,
    needs: Needs,
    overrun_factor: f64,
    spec: String,
    spec_sha256: String,
    project: Option<Uuid>,
    key: Option<IdempotencyKey>,
}

/// What became of a submission.
enum Submitted {
    New(Box<JobRow>),
    /// Its key was used before, for this job.
    Before(Uuid),
}

impl Store {
    /// Puts a job into the queue. The same key with the same body gives the job it gave before.
    ///
    /// # Errors
    /// [`StoreError::KeyReused`] when the key was used with another body or project, [`StoreError::Conflict`]
    /// when the job of the key has been deleted.
    pub async fn enqueue(
        &self,
        submission: &Submission,
        key: Option<IdempotencyKey>,
    ) -> Result<Enqueued> {
        self.enqueue_checked(CheckedSubmission::new(submission.clone(), None), key)
            .await
    }

    /// The same for a submission whose spec has been written down already.
    ///
    /// # Errors
    /// As [`Self::enqueue`].
    pub async fn enqueue_checked(
        &self,
        checked: CheckedSubmission,
        key: Option<IdempotencyKey>,
    ) -> Result<Enqueued> {
        let submission = checked.submission;
        let job = NewJob {
            id: Uuid::now_v7(),
            kind: submission.spec.kind().name(),
            name: submission.name,
            notes: submission.notes,
            tags: json(&submission.tags)?,
            priority: submission.priority,
            threads: submission.threads,
            estimate: checked.estimate,
            needs: checked.needs,
            overrun_factor: submission.overrun_factor,
            spec_sha256: checked.spec_sha256,
            spec: checked.spec,
            project: checked.project,
            key,
        };
        let written = self.write(move |change| {
            Box::pin(async move {
                let row = change.enqueue(&job).await?;
                Ok((row, job.spec))
            })
        });
        match written.await? {
            // what was written down is not read again
            (Submitted::New(row), spec) => Ok(Enqueued {
                job: row.view_with_spec(&spec)?,
                replayed: false,
            }),
            (Submitted::Before(id), _) => Ok(Enqueued {
                job: self.job(id).await.map_err(gone)?,
                replayed: true,
            }),
        }
    }

    /// What a submission under this key was answered before, if it was: whatever has become of limits
    /// since then, it is not checked again.
    ///
    /// # Errors
    /// As [`Self::enqueue`].
    pub async fn enqueued(&self, key: &IdempotencyKey) -> Result<Option<Enqueued>> {
        let known: Option<(String, Uuid)> = query_as(KEY)
            .bind(&key.key)
            .fetch_optional(self.lookups())
            .await?;
        match known {
            None => Ok(None),
            Some((body, _)) if body != key.body_sha256 => Err(StoreError::KeyReused),
            Some((_, id)) => Ok(Some(Enqueued {
                job: self.job(id).await.map_err(gone)?,
                replayed: true,
            })),
        }
    }

    /// Changes name, notes, tags, priority, project or how far beyond its estimate the job may go.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Edited`] when they were changed after the version that
    /// the edit knows.
    pub async fn edit(&self, id: Uuid, edit: JobEdit) -> Result<JobView> {
        self.write(move |change| Box::pin(async move { change.edit(id, edit).await }))
            .await?;
        self.job(id).await
    }

    /// Removes the job with its curve, log and files, for good.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] while it runs.
    pub async fn delete(&self, id: Uuid) -> Result<()> {
        self.write_from_reserve(move |change| Box::pin(async move { change.delete(id).await }))
            .await?;
        self.blobs().collected().await;
        Ok(())
    }

    /// Waits until all files are removed, or found to wait, of which this was known before.
    pub async fn settled_files(&self) {
        self.blobs().collected().await;
    }

    /// Asks something of a job. Asking for what is so already is fine.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] when the job's state does not allow it.
    pub async fn request(&self, id: Uuid, action: UserAction) -> Result<JobView> {
        let (input, done) = match action {
            UserAction::Cancel => (Input::Cancel, "job.cancelled"),
            UserAction::Pause => (Input::Pause, "job.paused"),
            UserAction::Resume => (Input::Resume, "job.resumed"),
            UserAction::Retry => (Input::Retry, "job.retried"),
        };
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let job = LifecycleRow::of(&mut change.connection, id).await?;
                let before = job.state()?;
                let step = change.step(&job, input, None, None).await?;
                if input == Input::Retry && step.state != before {
                    change.start_over(&job).await?;
                }
                change.audit(done, Some(id), "").await
            })
        })
        .await?;
        self.job(id).await
    }
}

/// Makes a row of needs that no job had yet.
fn row_of(needs: &Needs) -> Query {
    let statement = query(
        "INSERT INTO needs (memory_mb, disk_mb, core_s, threads, release)
         SELECT ?1, ?2, ?3, ?4, ?5 WHERE NOT EXISTS (SELECT 1 FROM needs
            WHERE memory_mb = ?1 AND disk_mb = ?2 AND core_s = ?3 AND threads = ?4 AND release = ?5)",
    );
    let statement = statement.bind(needs.memory_mb).bind(needs.disk_mb);
    let statement = statement.bind(needs.core_s).bind(needs.threads);
    statement.bind(needs.release)
}

/// The job of a key, when it is not there any more.
fn gone(error: StoreError) -> StoreError {
    match error {
        StoreError::NotFound(_) => {
            StoreError::Conflict("the job of this Idempotency-Key has been deleted".to_owned())
        }
        error => error,
    }
}

impl Change {
    /// Inserts the job, or finds the one that has its key.
    async fn enqueue(&mut self, job: &NewJob) -> Result<Submitted> {
        if let Some(key) = &job.key {
            let known: Option<(String, Uuid)> = query_as(KEY)
                .bind(&key.key)
                .fetch_optional(&mut self.connection)
                .await?;
            match known {
                Some((body, id)) if body == key.body_sha256 => return Ok(Submitted::Before(id)),
                Some(_) => return Err(StoreError::KeyReused),
                None => self.remember(key, job.id).await?,
            }
        }
        if let Some(project) = job.project {
            self.require_open(project).await?;
        }
        let person = self.actor.as_ref().and_then(|actor| actor.person);
        let row = query(
            // a job of before there were people is the first administrator's, also at the last moment
            "INSERT INTO jobs (id, kind, name, notes, tags, priority, spec_sha256, reason_code,
                               reason, created_at, updated_at, estimate, overrun_factor, owner,
                               project, needs, threads)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?10, ?11, ?12,
                COALESCE(?13, (SELECT id FROM people WHERE role = 'administrator'
                               ORDER BY created_at LIMIT 1)),
                COALESCE(?14, (SELECT id FROM projects
                    WHERE person = ?13 AND archived_at IS NULL AND deleted_at IS NULL AND NOT is_received
                    ORDER BY created_at, id LIMIT 1)),
                (SELECT id FROM needs WHERE memory_mb = ?15 AND disk_mb = ?16 AND core_s = ?17
                    AND threads = ?18 AND release = ?19), ?20)",
        )
        .bind(job.id)
        .bind(job.kind)
        .bind(&job.name)
        .bind(&job.notes)
        .bind(&job.tags)
        .bind(job.priority)
        .bind(&job.spec_sha256)
        .bind(wire_name(&ReasonCode::Submitted)?)
        .bind(sentence(ReasonCode::Submitted))
        .bind(self.now.as_millis())
        .bind(json(&job.estimate)?)
        .bind(job.overrun_factor)
        .bind(person)
        .bind(job.project)
        .bind(job.needs.memory_mb)
        .bind(job.needs.disk_mb)
        .bind(job.needs.core_s)
        .bind(job.needs.threads)
        .bind(job.needs.release)
        .bind(job.threads);
        let spec = query("INSERT INTO specs (job, json) SELECT seq, ?2 FROM jobs WHERE id = ?1")
            .bind(job.id)
            .bind(&job.spec);
        let mut statements = vec![row_of(&job.needs), row, spec];
        // before the job counts
        statements.splice(0..0, person.map(admission));
        let view = Some(JobRow::query(job.id));
        let event = self.event_among(statements, job.id, EventType::Job, view);
        let rows = event.await?;
        let row = rows.last().and_then(|rows| rows.first());
        let row = JobRow::from_row(row.ok_or(sqlx::Error::RowNotFound)?)?;
        if let Some(person) = person {
            if let Some(known) = rows.first().and_then(|rows| rows.first()) {
                self.check_limits(person, known, job.priority, &job.estimate)
                    .await?;
            }
            if row.project.is_none() {
                return Err(takes_no_jobs());
            }
        }
        self.queued();
        self.audit("job.submitted", Some(job.id), &job.name).await?;
        Ok(Submitted::New(Box::new(row)))
    }

    /// Refuses a project that was deleted or archived since the request for it was allowed.
    async fn require_open(&mut self, project: Uuid) -> Result<()> {
        let is_archived: Option<bool> = query_scalar(
            "SELECT archived_at IS NOT NULL FROM projects WHERE id = ? AND deleted_at IS NULL",
        )
        .bind(project)
        .fetch_optional(&mut self.connection)
        .await?;
        match is_archived {
            None => Err(StoreError::NotFound(format!("project {project}"))),
            Some(true) => Err(StoreError::Conflict(ARCHIVED.to_owned())),
            Some(false) => Ok(()),
        }
    }

    async fn edit(&mut self, id: Uuid, edit: JobEdit) -> Result<()> {
        let (job, edited): (i64, i64) = query_as("SELECT seq, edited FROM jobs WHERE id = ?")
            .bind(id)
            .fetch_optional(&mut self.connection)
            .await?
            .ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        if edit
            .known_version
            .is_some_and(|known| known < edited.unsigned_abs())
        {
            return Err(StoreError::Edited);
        }
        self.check_hurry(edit.priority, job).await?;
        let (project, detail) = (edit.project, edit.detail());
        if let Some(project) = project {
            self.require_open(project).await?;
        }
        let action = project.map_or("job.changed", |_| "job.moved");
        query(
            "UPDATE jobs SET name = COALESCE(?, name), notes = COALESCE(?, notes),
                tags = COALESCE(?, tags), priority = COALESCE(?, priority),
                overrun_factor = COALESCE(?, overrun_factor) WHERE seq = ?",
        )
        .bind(edit.name)
        .bind(edit.notes)
        .bind(edit.tags.as_ref().map(json).transpose()?)
        .bind(edit.priority)
        .bind(edit.overrun_factor)
        .bind(job)
        .execute(&mut self.connection)
        .await?;
        if let Some(project) = project {
            query("UPDATE jobs SET project = ? WHERE seq = ?")
                .bind(project)
                .bind(job)
                .execute(&mut self.connection)
                .await?;
        }
        self.audit(action, Some(id), &detail).await?;
        self.event(id, EventType::Job).await?;
        query("UPDATE jobs SET edited = version WHERE seq = ?")
            .bind(job)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }

    async fn remember(&mut self, key: &IdempotencyKey, job: Uuid) -> Result<()> {
        query(
            "INSERT INTO idempotency_keys (key, body_sha256, job, created_at) VALUES (?, ?, ?, ?)",
        )
        .bind(&key.key)
        .bind(&key.body_sha256)
        .bind(job)
        .bind(self.now.as_millis())
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }

    async fn delete(&mut self, id: Uuid) -> Result<()> {
        let job = LifecycleRow::of(&mut self.connection, id).await?;
        job.require_idle()?;
        self.remove_checkpoints(job.seq, None).await?;
        let files: Vec<String> = query_scalar(
            "SELECT sha256 FROM attempt_files
             WHERE attempt IN (SELECT seq FROM attempts WHERE job = ?)",
        )
        .bind(job.seq)
        .fetch_all(&mut self.connection)
        .await?;
        self.garbage(files);
        let name: String = query_scalar("SELECT name FROM jobs WHERE seq = ?")
            .bind(job.seq)
            .fetch_one(&mut self.connection)
            .await?;
        self.leave_list(&job).await?;
        self.audit("job.erased", Some(id), &name).await
    }

    /// Removes a job's row, with all that hangs on it, and tells of it.
    pub(super) async fn leave_list(&mut self, job: &LifecycleRow) -> Result<()> {
        // whose it was: only who saw it is told that it is gone
        let (owner, project): (Option<Uuid>, Option<Uuid>) =
            query_as("DELETE FROM jobs WHERE seq = ? RETURNING owner, project")
                .bind(job.seq)
                .fetch_one(&mut self.connection)
                .await?;
        query("DELETE FROM events WHERE job = ?")
            .bind(job.id)
            .execute(&mut self.connection)
            .await?;
        self.event(job.id, EventType::Deleted).await?;
        query("UPDATE events SET owner = ?, project = ? WHERE job = ?")
            .bind(owner)
            .bind(project)
            .bind(job.id)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }

    /// Clears the traces of the attempts before a retry.
    async fn start_over(&mut self, job: &LifecycleRow) -> Result<()> {
        query("UPDATE jobs SET started_at = NULL, progress = 0 WHERE seq = ?")
            .bind(job.seq)
            .execute(&mut self.connection)
            .await?;
        query("DELETE FROM job_faults WHERE job = ?")
            .bind(job.seq)
            .execute(&mut self.connection)
            .await?;
        // what the failure left; a job that has a result is not tried again
        let files: Vec<String> = query_scalar(
            "DELETE FROM attempt_files
             WHERE attempt IN (SELECT seq FROM attempts WHERE job = ?) RETURNING sha256",
        )
        .bind(job.seq)
        .fetch_all(&mut self.connection)
        .await?;
        self.garbage(files);
        Ok(())
    }
}
