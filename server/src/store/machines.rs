//! Machines that cannot carry out jobs by a fault of their own: a full disk, no memory, no threads.
//!
//! A fault sends the job to another machine and sets this one (a worker's label on a host) aside, for
//! twice as long with every further one, until it has carried out a job. A job that three machines could
//! not carry out is at fault itself. So that a lab of one machine finds that out too, a machine counts
//! again when it has carried out another job in between.
use loadframe_api::worker::{ClaimRequest, FaultRequest};

use super::clock::millis;
use super::database::{Query, query, query_as, query_scalar};
use super::encoding::wire_name;
use super::ending::digest;
use super::error::Result;
use super::lease::LeasedAttempt;
use super::state::LifecycleRow;
use super::writer::Change;
use super::{LeaseKey, Store};
use crate::queue::{Input, MACHINES_UNTIL_FAILED};

/// Doublings of the pause: from 10 s to a little over 10 min.
const MOST_DOUBLINGS: i64 = 6;

impl Store {
    /// Sends the job to another machine, at no charge, and sets the worker's aside.
    ///
    /// # Errors
    /// [`super::StoreError::LeaseLost`].
    pub async fn fault(&self, key: LeaseKey, request: &FaultRequest) -> Result<()> {
        let message = digest("fault", request)?;
        self.take_fault(key, message, request.clone()).await
    }

    /// As [`Self::fault`], of a message of another kind that says as much.
    pub(super) async fn take_fault(
        &self,
        key: LeaseKey,
        message: String,
        request: FaultRequest,
    ) -> Result<()> {
        let pause = millis(self.options().fault_pause);
        self.write_from_reserve(move |change| {
            Box::pin(async move { change.fault(key, message, &request, pause).await })
        })
        .await
    }
}

impl Change {
    async fn fault(
        &mut self,
        key: LeaseKey,
        message: String,
        request: &FaultRequest,
        pause: i64,
    ) -> Result<()> {
        let (attempt, job) = LeasedAttempt::with_job(&mut self.connection, key).await?;
        if attempt.ended_at.is_some() {
            // a repetition, or a refusal
            let input = Input::Fault { machines: 0 };
            self.end(key, message, input, None).await?;
            return Ok(());
        }
        let (name, host) = (&attempt.worker_name, &attempt.host);
        tracing::warn!(worker = %name, %host, code = ?request.code, reason = %request.reason,
            "a machine could not carry out a job and is set aside");
        self.set_aside(&attempt, request, pause).await?;
        let machines = self.count_fault(&job, &attempt, &request.reason).await?;
        let line = format!("{name} ({host}) could not carry it out: {}", request.reason);
        self.append_log(&job, attempt.number, std::slice::from_ref(&line))
            .await?;
        let why = if machines >= MACHINES_UNTIL_FAILED {
            self.told_by_machines(job.seq).await?
        } else {
            format!("{line}; waiting for another machine")
        };
        self.end(key, message, Input::Fault { machines }, Some(why))
            .await?;
        Ok(())
    }

    /// Gives the machine no jobs for a while.
    async fn set_aside(
        &mut self,
        attempt: &LeasedAttempt,
        request: &FaultRequest,
        pause: i64,
    ) -> Result<()> {
        query(
            "INSERT INTO machines (host, worker_name, faults, until, code, reason)
             VALUES (?1, ?2, 1, ?3 + ?4, ?5, ?6)
             ON CONFLICT (host, worker_name) DO UPDATE SET
                faults = machines.faults + 1, until = ?3 + ?4 * (1 << CAST(CASE
                    WHEN machines.faults < ?7 THEN machines.faults ELSE ?7 END AS INTEGER)), code = ?5, reason = ?6",
        )
        .bind(&attempt.host)
        .bind(&attempt.worker_name)
        .bind(self.now.as_millis())
        .bind(pause)
        .bind(wire_name(&request.code)?)
        .bind(&request.reason)
        .bind(MOST_DOUBLINGS)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }

    /// Notes the fault with the job, and tells how many machines could not carry it out.
    async fn count_fault(
        &mut self,
        job: &LifecycleRow,
        attempt: &LeasedAttempt,
        reason: &str,
    ) -> Result<u32> {
        query(
            "INSERT INTO job_faults (job, attempt, host, at, reason) SELECT ?1, ?2, ?3, ?4, ?5
             WHERE NOT EXISTS (SELECT 1 FROM job_faults WHERE job = ?1 AND host = ?3
                AND at >= (SELECT MAX(worked_at) FROM machines WHERE host = ?3))",
        )
        .bind(job.seq)
        .bind(attempt.number)
        .bind(&attempt.host)
        .bind(self.now.as_millis())
        .bind(reason)
        .execute(&mut self.connection)
        .await?;
        let machines: i64 = query_scalar("SELECT COUNT(*) FROM job_faults WHERE job = ?")
            .bind(job.seq)
            .fetch_one(&mut self.connection)
            .await?;
        Ok(u32::try_from(machines).unwrap_or(u32::MAX))
    }

    /// What all machines said that could not carry out a job.
    async fn told_by_machines(&mut self, job: i64) -> Result<String> {
        let said: Vec<(String, String)> =
            query_as("SELECT host, reason FROM job_faults WHERE job = ? ORDER BY attempt")
                .bind(job)
                .fetch_all(&mut self.connection)
                .await?;
        let lines = said
            .iter()
            .map(|(host, reason)| format!("{host}: {reason}"));
        Ok(format!(
            "{} machines could not carry it out, so it is taken to be the job's own fault:\n{}",
            said.len(),
            lines.collect::<Vec<_>>().join("\n")
        ))
    }

    /// The statement that notes that the machine has carried out a job, if it ever could not.
    pub(super) fn has_worked(&self, attempt: &LeasedAttempt) -> Query {
        let noted = query(
            "UPDATE machines SET faults = 0, until = 0, worked_at = ?
             WHERE host = ? AND worker_name = ?",
        );
        let noted = noted.bind(self.now.as_millis());
        noted.bind(&attempt.host).bind(&attempt.worker_name)
    }

    /// Ends the pause of the worker's machine.
    pub(super) async fn end_pause(&mut self, worker: &ClaimRequest) -> Result<()> {
        query("UPDATE machines SET until = 0 WHERE host = ? AND worker_name = ?")
            .bind(&worker.host)
            .bind(&worker.name)
            .execute(&mut self.connection)
            .await?;
        Ok(())
    }
}

impl Store {
    /// How many live workers are set aside now.
    pub(super) async fn count_set_aside(&self, alive_since: i64) -> Result<u64> {
        let count: i64 = query_scalar(
            "SELECT COUNT(*) FROM workers w JOIN machines m
                ON m.host = w.host AND m.worker_name = w.name
             WHERE w.last_seen_at >= ? AND m.until > ?",
        )
        .bind(alive_since)
        .bind(self.now().as_millis())
        .fetch_one(self.reads())
        .await?;
        Ok(count.unsigned_abs())
    }
}
