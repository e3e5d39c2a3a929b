//! Steps of a job's lifecycle in the database: read the state, ask the queue's transition function,
//! write down what it says.
//!
//! Every update carries its condition, so that a stale writer changes nothing: the job's row must
//! still have the version that was read, and an attempt that ends must be live under its token.
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, PARTIAL_FOLDER, ReasonCode};
use uuid::Uuid;

use super::checkpoints::checkpoint_contents;
use super::choice::to_charge;
use super::database::{Connection, FromRow, Query, Row, query, query_as, query_scalar, row};
use super::encoding::{variant, wire_name};
use super::error::{Result, StoreError};
use super::writer::{Change, EventType};
use crate::queue::{Input, Refusal, State, Step, UserRequest, keeps_checkpoint, transition};

row! {
    /// The columns of a job's row that its lifecycle is about.
    #[derive(Debug)]
    pub(super) struct LifecycleRow {
        pub(super) seq: i64,
        pub(super) id: Uuid,
        status: String,
        outcome: Option<String>,
        asked: Option<String>,
        losses: u32,
        /// Number of the last attempt.
        pub(super) attempt: u32,
        version: i64,
    }
}

/// What ends an attempt, and on which condition.
#[derive(Debug)]
pub(super) struct Ending {
    /// The attempt's row.
    pub(super) attempt: i64,
    pub(super) token: Uuid,
    /// SHA-256 of the message that ended it, if one did.
    pub(super) message: Option<String>,
    /// The lease must have run out.
    pub(super) expired: bool,
}

impl LifecycleRow {
    /// That of the job `id`.
    pub(super) async fn of(connection: &mut Connection, id: Uuid) -> Result<Self> {
        query_as(
            "SELECT seq, id, status, outcome, asked, losses, attempt, version FROM jobs WHERE id = ?",
        )
        .bind(id)
        .fetch_optional(connection)
        .await?
        .ok_or_else(|| StoreError::NotFound(format!("job {id}")))
    }

    pub(super) fn state(&self) -> Result<State> {
        let losses = self.losses;
        Ok(match variant::<JobStatus>(&self.status)? {
            JobStatus::Queued => State::Queued { losses },
            JobStatus::Paused => State::Paused { losses },
            JobStatus::Running => State::Running {
                losses,
                asked: self.asked()?,
            },
            JobStatus::Finished => {
                State::Finished(variant(self.outcome.as_deref().unwrap_or_default())?)
            }
        })
    }

    /// Refuses a job that is running: what a worker writes to is not taken away.
    pub(super) fn require_idle(&self) -> Result<()> {
        match self.state()? {
            State::Running { .. } => Err(StoreError::Conflict(Refusal::StillRunning.to_string())),
            _ => Ok(()),
        }
    }

    pub(super) fn asked(&self) -> Result<Option<UserRequest>> {
        Self::asked_for(self.asked.as_deref())
    }

    /// What the word in a job's row asks for.
    pub(super) fn asked_for(word: Option<&str>) -> Result<Option<UserRequest>> {
        match word {
            None => Ok(None),
            Some("cancel") => Ok(Some(UserRequest::Cancel)),
            Some("pause") => Ok(Some(UserRequest::Pause)),
            Some(word) => Err(StoreError::corrupt("request")(word.to_owned())),
        }
    }
}

impl Change {
    /// Takes the step that `input` means for `job`. `why` says to people what the reason's own
    /// sentence does not; `ending` names the attempt that the step ends.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] when the job's state does not allow it, [`StoreError::LeaseLost`]
    /// when the attempt is no longer live.
    pub(super) async fn step(
        &mut self,
        job: &LifecycleRow,
        input: Input,
        why: Option<String>,
        ending: Option<Ending>,
    ) -> Result<Step> {
        let (step, _) = self.step_and(job, input, why, ending, Vec::new()).await?;
        Ok(step)
    }

    /// [`Self::step`], and in the same go `then`, where it is one; the rows of each statement of it.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub(super) async fn step_and(
        &mut self,
        job: &LifecycleRow,
        input: Input,
        why: Option<String>,
        ending: Option<Ending>,
        then: Vec<Query>,
    ) -> Result<(Step, Vec<Vec<Row>>)> {
        let before = job.state()?;
        let step = transition(before, input).map_err(|refusal| refused(refusal, input))?;
        if step.state == before && step.reason.is_none() {
            return Ok((step, Vec::new()));
        }
        let charge = match (step.attempt_end, ending) {
            (Some(end), Some(ending)) => self.end_attempt(job, &ending, end).await?,
            _ => None,
        };
        let (status, outcome, asked, losses) = columns(step.state);
        let reason = why.or_else(|| step.reason.map(|code| sentence(code).to_owned()));
        let code = step.reason.map(|code| wire_name(&code)).transpose()?;
        let update = query(
            "UPDATE jobs SET
                status = ?1, outcome = ?2, asked = ?3, losses = ?4,
                reason_code = COALESCE(?5, reason_code), reason = COALESCE(?6, reason),
                finished_at = CASE ?1 WHEN 'finished' THEN ?7 END,
                progress = CASE ?2 WHEN 'succeeded' THEN 1.0 ELSE progress END,
                phase = CASE ?1 WHEN 'running' THEN phase ELSE '' END,
                eta_s = CASE ?1 WHEN 'running' THEN eta_s END,
                attempt = attempt + ?10,
                started_at = CASE ?10 WHEN 1 THEN COALESCE(started_at, ?7) ELSE started_at END
             WHERE seq = ?8 AND version = ?9 RETURNING seq",
        )
        .bind(wire_name(&status)?)
        .bind(outcome.map(|outcome| wire_name(&outcome)).transpose()?)
        .bind(asked)
        .bind(losses)
        .bind(code)
        .bind(reason)
        .bind(self.now.as_millis())
        .bind(job.seq)
        .bind(job.version)
        // a claim begins the next attempt
        .bind(i64::from(input == Input::Claim));
        let mut statements = vec![update];
        let has_ended_for_good =
            matches!(step.state, State::Finished(outcome) if !keeps_checkpoint(outcome));
        if has_ended_for_good {
            statements.push(checkpoint_contents(job.seq, None));
        }
        statements.extend(charge);
        let place = statements.len();
        statements.extend(then);
        let mut rows = self.event_after(statements, job.id, EventType::Job).await?;
        if rows.first().is_none_or(Vec::is_empty) {
            return Err(StoreError::Unavailable);
        }
        if let Some(contents) = rows.get(1).filter(|_| has_ended_for_good) {
            self.remove_found_checkpoints(job.seq, None, contents)
                .await?;
        }
        if matches!(step.state, State::Queued { .. }) {
            self.queued();
        }
        Ok((step, rows.split_off(place)))
    }

    /// Ends an attempt that is live under its token; of what it leaves, only a checkpoint, a
    /// completed result and what a failed one had until then stay. Gives the statement that charges it to
    /// somebody.
    async fn end_attempt(
        &mut self,
        job: &LifecycleRow,
        ending: &Ending,
        end: AttemptEnd,
    ) -> Result<Option<Query>> {
        let ended = query(
            "UPDATE attempts SET ended_at = ?1, end_reason = ?2, ended_by = ?3
             WHERE seq = ?4 AND token = ?5 AND ended_at IS NULL AND (NOT ?6 OR lease_until <= ?1)
             RETURNING seq",
        )
        .bind(self.now.as_millis())
        .bind(wire_name(&end)?)
        .bind(&ending.message)
        .bind(ending.attempt)
        .bind(ending.token)
        .bind(ending.expired);
        let statements = vec![ended, to_charge(ending.attempt)];
        let rows = self.connection.run_all(statements).await?;
        if rows.first().is_none_or(Vec::is_empty) {
            return Err(StoreError::LeaseLost);
        }
        let charge = match rows.get(1).and_then(|rows| rows.first()) {
            Some(charge) => Some(self.charge(FromRow::from_row(charge)?)),
            None => None,
        };
        let completed = end == AttemptEnd::Completed;
        if matches!(end, AttemptEnd::Failed | AttemptEnd::TimedOut) {
            self.mark_partial(ending.attempt).await?;
        } else if !completed {
            let files: Vec<String> =
                query_scalar("DELETE FROM attempt_files WHERE attempt = ? RETURNING sha256")
                    .bind(ending.attempt)
                    .fetch_all(&mut self.connection)
                    .await?;
            self.garbage(files);
        }
        if job.attempt > 1 {
            let result = completed.then_some(ending.attempt);
            self.keep_one_curve(job.seq, result).await?;
        }
        Ok(charge)
    }

    /// Puts the files of a failed attempt, which are no result, in a folder that says so.
    async fn mark_partial(&mut self, attempt: i64) -> Result<()> {
        query("UPDATE attempt_files SET name = ?1 || name WHERE attempt = ?2")
            .bind(PARTIAL_FOLDER)
            .bind(attempt)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }
}

/// A refusal, seen by who asked: a worker has lost its lease, a user hears why.
fn refused(refusal: Refusal, input: Input) -> StoreError {
    match input {
        Input::Cancel | Input::Pause | Input::Resume | Input::Retry => {
            StoreError::Conflict(refusal.to_string())
        }
        _ => StoreError::LeaseLost,
    }
}

fn columns(state: State) -> (JobStatus, Option<JobOutcome>, Option<&'static str>, u32) {
    match state {
        State::Queued { losses } => (JobStatus::Queued, None, None, losses),
        State::Paused { losses } => (JobStatus::Paused, None, None, losses),
        State::Running { losses, asked } => {
            let asked = asked.map(|asked| match asked {
                UserRequest::Cancel => "cancel",
                UserRequest::Pause => "pause",
            });
            (JobStatus::Running, None, asked, losses)
        }
        State::Finished(outcome) => (JobStatus::Finished, Some(outcome), None, 0),
    }
}

/// A reason for people.
pub(super) fn sentence(code: ReasonCode) -> &'static str {
    match code {
        ReasonCode::Submitted => "waiting for a worker",
        ReasonCode::PauseRequested => "asked to pause; the worker is leaving a checkpoint",
        ReasonCode::CancelRequested => "asked to cancel; the worker is being told",
        ReasonCode::PausedByUser => "paused; resume it to go on",
        ReasonCode::ResumedByUser => "resumed",
        ReasonCode::RetriedByUser => "to be tried again",
        ReasonCode::CancelledByUser => "cancelled",
        ReasonCode::WorkerReleased => "its worker stopped by plan; waiting for another",
        ReasonCode::WorkerLost => "its worker fell silent; waiting for another",
        ReasonCode::TooManyLosses => "its workers fell silent too often",
        ReasonCode::SimulationError => "the simulation has no result",
        ReasonCode::WorkerFault => "its worker could not carry it out; waiting for another machine",
        ReasonCode::WorkerError => "machine after machine could not carry it out",
        ReasonCode::TimeLimit => "it took longer than it may",
        ReasonCode::BeyondEstimate => "it has taken far more than estimated",
        ReasonCode::Completed => "completed",
    }
}
