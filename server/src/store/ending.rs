//! How a worker ends its attempt: complete, fail or release (a fault: see [`super::machines`]). A message sent twice, because the answer
//! to the first was lost, is answered twice.
use std::collections::HashMap;

use loadframe_api::worker::{
    CompleteRequest, FailCode, FailRequest, FaultCode, FaultRequest, ReleaseReason,
};
use loadframe_api::{Estimate, FileEntry, JobOutcome, sha256_hex};
use serde::Serialize;

use super::database::{FromRow, Query, Row, query, query_as};
use super::encoding::{json, parsed};
use super::error::{Result, StoreError};
use super::lease::{LeasedAttempt, attempt_of, job_of, leased};
use super::state::{Ending, LifecycleRow};
use super::writer::Change;
use super::{LeaseKey, Store};
use crate::queue::{Input, State, transition};

/// The file every result has.
const OUTCOME_FILE: &str = "outcome.json";

impl Store {
    /// Publishes the attempt's files and curve as the job's result. All files of the request must
    /// have been uploaded under this lease; others it has uploaded are dropped. When a cancel was
    /// accepted before, it holds: the job is then cancelled and nothing published.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`]; [`StoreError::Invalid`] when files are missing or the outcome is
    /// of another spec.
    pub async fn complete(&self, key: LeaseKey, request: &CompleteRequest) -> Result<()> {
        let (message, request) = (digest("complete", request)?, request.clone());
        self.write(move |change| {
            Box::pin(async move { change.complete(key, message, &request).await })
        })
        .await
    }

    /// Ends the job without a result; a fault of the worker is taken as [`Self::fault`].
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`].
    pub async fn fail(&self, key: LeaseKey, request: &FailRequest) -> Result<()> {
        let message = digest("fail", request)?;
        let why = request.reason.clone();
        let input = match request.code {
            FailCode::SimulationError => Input::Fail,
            FailCode::TimeLimit => Input::ExceedTime,
            FailCode::WorkerError => {
                let code = FaultCode::Other;
                let fault = FaultRequest { code, reason: why };
                return self.take_fault(key, message, fault).await;
            }
        };
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                change.end(key, message, input, Some(why)).await?;
                Ok(())
            })
        })
        .await
    }

    /// Pauses a job that has taken more than it may by its estimate; `detail` says what it has taken.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`].
    pub async fn exceed_estimate(&self, key: LeaseKey, detail: &str) -> Result<()> {
        let message = digest("exceed", &detail)?;
        let detail = detail.to_owned();
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let attempt = LeasedAttempt::find(&mut change.connection, key).await?;
                let (estimate, factor): (Option<String>, f64) =
                    query_as("SELECT estimate, overrun_factor FROM jobs WHERE id = ?")
                        .bind(attempt.job)
                        .fetch_one(&mut change.connection)
                        .await?;
                let estimate = match estimate {
                    Some(text) => {
                        let Estimate { wall_s, memory_mb, disk_mb, .. } = parsed(&text, "estimate")?;
                        format!(
                            "its estimate is {} s, {} MB of memory and {} MB of files, ",
                            brief(wall_s), brief(memory_mb), brief(disk_mb)
                        )
                    }
                    None => String::new(),
                };
                let why = format!(
                    "{detail} ({estimate}overrun_factor {factor}); paused with its checkpoint. To let it go on, raise overrun_factor (on its page, or PATCH /v1/jobs/{}) and resume it",
                    attempt.job
                );
                change.end(key, message, Input::ExceedEstimate, Some(why)).await?;
                Ok(())
            })
        })
        .await
    }

    /// Gives the job back. What becomes of it follows from what its user asked: it is cancelled,
    /// paused, or queued again at no charge.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`].
    pub async fn release(&self, key: LeaseKey, reason: ReleaseReason) -> Result<()> {
        let message = digest("release", &reason)?;
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                change.end(key, message, Input::Release, None).await?;
                Ok(())
            })
        })
        .await
    }
}

/// An estimate as people read it: three digits where it is small.
fn brief(value: f64) -> String {
    if value < 100.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.0}")
    }
}

/// SHA-256 of a message.
pub(super) fn digest(route: &str, message: &impl Serialize) -> Result<String> {
    Ok(sha256_hex(format!("{route} {}", json(message)?).as_bytes()))
}

/// The outcome must be one of the spec that was `submitted`.
fn check_outcome(submitted: &[Row], request: &CompleteRequest) -> Result<()> {
    let row = submitted.first().ok_or(sqlx::Error::RowNotFound)?;
    let (kind, spec_sha256): (String, String) = FromRow::from_row(row)?;
    let outcome = &request.outcome;
    if outcome.kind.name() != kind || outcome.provenance.spec_sha256 != spec_sha256 {
        let sentence = format!("the outcome is not of this job's spec {spec_sha256}");
        return Err(StoreError::Invalid(sentence));
    }
    Ok(())
}

impl Change {
    /// Ends the attempt of `key` by `input`, if this same message has not ended it before.
    pub(super) async fn end(
        &mut self,
        key: LeaseKey,
        message: String,
        input: Input,
        why: Option<String>,
    ) -> Result<()> {
        let (attempt, job) = LeasedAttempt::with_job(&mut self.connection, key).await?;
        self.end_of(&attempt, &job, message, input, why, Vec::new())
            .await
    }

    /// The same of an attempt and its job that were read, and in the same go `then`.
    async fn end_of(
        &mut self,
        attempt: &LeasedAttempt,
        job: &LifecycleRow,
        message: String,
        input: Input,
        why: Option<String>,
        mut then: Vec<Query>,
    ) -> Result<()> {
        if attempt.ended_at.is_some() {
            let is_repeated = attempt.ended_by.as_ref() == Some(&message);
            return is_repeated.then_some(()).ok_or(StoreError::LeaseLost);
        }
        // the worker's reason is that of its failure; who asked to cancel knows why
        let why = why.filter(|_| matches!(job.asked(), Ok(None)));
        let ending = Ending {
            attempt: attempt.seq,
            token: attempt.token,
            message: Some(message),
            expired: false,
        };
        if matches!(input, Input::Complete | Input::Fail) {
            then.push(self.has_worked(attempt));
        }
        self.step_and(job, input, why, Some(ending), then).await?;
        Ok(())
    }

    async fn complete(
        &mut self,
        key: LeaseKey,
        message: String,
        request: &CompleteRequest,
    ) -> Result<()> {
        let submitted = query(
            "SELECT j.kind, j.spec_sha256 FROM attempts a JOIN jobs j ON j.seq = a.job
             WHERE a.id = ? AND a.token = ?",
        );
        let uploaded = query(
            "SELECT f.name, f.bytes, f.sha256 FROM attempts a JOIN attempt_files f ON f.attempt = a.seq
             WHERE a.id = ? AND a.token = ?",
        );
        let rows = self.connection.run_all(vec![
            attempt_of(key),
            job_of(key),
            submitted.bind(key.id).bind(key.token),
            uploaded.bind(key.id).bind(key.token),
        ]);
        let rows = rows.await?;
        let (attempt, job) = leased(&rows, 1)?;
        let [_, _, submitted, uploaded] = rows.as_slice() else {
            return Err(sqlx::Error::RowNotFound.into());
        };
        let mut result = Vec::new();
        let is_success = transition(job.state()?, Input::Complete)
            .is_ok_and(|step| step.state == State::Finished(JobOutcome::Succeeded));
        if attempt.ended_at.is_none() && is_success {
            check_outcome(submitted, request)?;
            result.extend(self.publish(&attempt, uploaded, &request.files)?);
            let statement =
                query("INSERT INTO results (job, attempt, summary, outcome) VALUES (?, ?, ?, ?)");
            let statement = statement.bind(job.seq).bind(attempt.number);
            let statement = statement.bind(json(&request.outcome.summary)?);
            result.push(statement.bind(json(&request.outcome)?));
        }
        self.end_of(&attempt, &job, message, Input::Complete, None, result)
            .await
    }

    /// What makes the attempt's files exactly those of the result; `uploaded` is what it has.
    fn publish(
        &mut self,
        attempt: &LeasedAttempt,
        uploaded: &[Row],
        files: &[FileEntry],
    ) -> Result<Option<Query>> {
        if !files.iter().any(|file| file.name == OUTCOME_FILE) {
            let sentence = format!("{OUTCOME_FILE} is missing among the files");
            return Err(StoreError::Invalid(sentence));
        }
        // some file systems, and readers of archives on them, would keep one of them
        let mut folded = HashMap::with_capacity(files.len());
        for file in files {
            if let Some(other) = folded.insert(file.name.to_ascii_lowercase(), &file.name)
                && *other != file.name
            {
                let sentence = format!(
                    "the files {other} and {} would be one where case does not count",
                    file.name
                );
                return Err(StoreError::Invalid(sentence));
            }
        }
        let uploaded = uploaded.iter().map(|row| {
            let (name, bytes, sha256) = FromRow::from_row(row)?;
            Ok((name, (bytes, sha256)))
        });
        let mut uploaded: HashMap<String, (i64, String)> = uploaded.collect::<sqlx::Result<_>>()?;
        for file in files {
            let found = uploaded.remove(&file.name);
            let is_same = found.is_some_and(|(bytes, sha256)| {
                bytes.unsigned_abs() == file.bytes && sha256 == file.sha256
            });
            if !is_same {
                let sentence = format!("{} was not uploaded with this content", file.name);
                return Err(StoreError::Invalid(sentence));
            }
        }
        let (names, contents): (Vec<_>, Vec<_>) = uploaded
            .into_iter()
            .map(|(name, (_, sha256))| (name, sha256))
            .unzip();
        if names.is_empty() {
            return Ok(None);
        }
        self.garbage(contents);
        let dropped = query(
            "DELETE FROM attempt_files
             WHERE attempt = ? AND name IN (SELECT value FROM json_each(?))",
        );
        Ok(Some(dropped.bind(attempt.seq).bind(json(&names)?)))
    }
}
