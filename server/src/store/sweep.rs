//! What time does: leases run out, jobs exceed their time, old traces are forgotten.
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use loadframe_api::Timestamp;
use uuid::Uuid;

use super::Store;
use super::clock::millis;
use super::database::{query, query_as, query_scalar, row};
use super::error::{Result, StoreError, chain};
use super::state::{Ending, LifecycleRow};
use super::writer::{Change, EventType};
use crate::queue::{Input, LOSSES_UNTIL_QUARANTINE, State, transition};
use crate::tasks;

/// The sweeper's step.
const EVERY: Duration = Duration::from_secs(1);
/// Old traces are forgotten every so many steps.
const STEPS_UNTIL_TIDY: u64 = 3600;
/// How long idempotency keys, news of deleted jobs and vanished workers are remembered [ms].
const REMEMBERED: i64 = 7 * 24 * 3600 * 1000;
/// Log lines that the reason of a quarantine quotes.
const LINES_QUOTED: u32 = 5;

row! {
    /// A live attempt that time has caught up with.
    #[derive(Debug)]
    struct Overdue {
        seq: i64,
        token: Uuid,
        job: Uuid,
        worker_name: String,
        host: String,
        heard: bool,
        expired: bool,
    }
}

impl Store {
    /// Writes down the heartbeats that have come, and ends the attempts whose lease has run out or whose
    /// time is over; tells how many. One that cannot be ended keeps no other from it.
    ///
    /// # Errors
    /// The database's, and [`StoreError::Unavailable`]; the first of those of single attempts.
    pub async fn sweep(&self) -> Result<usize> {
        self.write_pulses().await?;
        let limit = self.options().job_time_limit.map(millis);
        // its worker knows the limit too, and ends the attempt in order if it can
        let limit = limit.map(|limit| limit.saturating_add(self.lease_millis()));
        let overdue: Vec<Overdue> = query_as(
            "SELECT a.seq, a.token, j.id AS job, a.worker_name, a.host, a.heard,
                    a.lease_until <= ?1 AS expired
             FROM attempts a JOIN jobs j ON j.seq = a.job
             WHERE a.ended_at IS NULL AND (a.lease_until <= ?1
                OR ?1 - a.started_at + 1000 * a.resumed_wall_s > ?2)",
        )
        .bind(self.now().as_millis())
        .bind(limit)
        .fetch_all(self.lookups())
        .await?;
        let (mut ended, mut failed, lease) = (0, None, self.lease_millis());
        for attempt in overdue {
            let job = attempt.job;
            let pulses = Arc::clone(self.pulses());
            let swept = self
                .write_from_reserve(move |change| {
                    Box::pin(async move {
                        // heard of since the list was made
                        if attempt.expired && pulses.has(attempt.seq) {
                            return Err(StoreError::LeaseLost);
                        }
                        change.sweep(attempt, lease).await
                    })
                })
                .await;
            match swept {
                Ok(()) => ended += 1,
                // the worker was heard of, or ended the attempt, just before
                Err(StoreError::LeaseLost | StoreError::NotFound(_)) => {}
                Err(error) => {
                    tracing::error!(%job, error = %chain(&error), "an attempt could not be ended");
                    failed = failed.or(Some(error));
                }
            }
        }
        failed.map_or(Ok(ended), Err)
    }

    /// A step of the sweeper, whose last one ended then: sweeps. When this process was stopped for a while
    /// (or the clock was set), workers could not be heard: they all get a fresh lease instead.
    ///
    /// # Errors
    /// As [`Self::sweep`].
    pub async fn sweep_since(&self, last: Timestamp) -> Result<()> {
        let longest_pause = millis(EVERY) + self.lease_millis() / 3;
        let pause = self.now().as_millis() - last.as_millis();
        if (0..=longest_pause).contains(&pause) {
            return self.sweep().await.map(|_| ());
        }
        tracing::warn!(pause_ms = pause, "the clock leapt; all leases are renewed");
        self.renew_leases().await
    }

    /// Sweeps every second, until dropped.
    pub async fn keep_sweeping(self) {
        let mut last = self.now();
        for step in 1_u64.. {
            tokio::time::sleep(EVERY).await;
            let swept = self.sweep_since(last).await;
            // the pause counts from the end of a sweep: a slow one has listened meanwhile
            last = self.now();
            if let Err(error) = swept {
                tracing::error!(%error, "the leases could not be swept");
            }
            if let Err(error) = self.index_texts().await {
                tracing::error!(%error, "texts of new jobs could not be indexed");
            }
            if step % STEPS_UNTIL_TIDY == 0 {
                self.blobs().look_through();
                if let Err(error) = self.blobs().incoming.forget_parts().await {
                    tracing::error!(%error, "parts of uploads could not be removed");
                }
                // a slow bucket keeps no lease waiting
                tasks::spawn(self.clone().sweep_bucket());
                if let Err(error) = self.tidy().await {
                    tracing::error!(%error, "old traces could not be removed");
                }
            }
        }
    }

    /// Removes what abandoned uploads have left in a bucket.
    pub(super) async fn sweep_bucket(self) {
        let Some(bucket) = self.blobs().storage.bucket() else {
            return;
        };
        let swept = async {
            let unfinished = bucket.unfinished().await?;
            // asked after it was found, so that no upload that has just begun looks abandoned
            let live: Vec<Uuid> = query_scalar("SELECT id FROM attempts WHERE ended_at IS NULL")
                .fetch_all(self.reads())
                .await?;
            let live = live.iter().map(|lease| lease.simple().to_string());
            let live: BTreeSet<String> = live.collect();
            let mut swept = 0;
            for one in unfinished {
                if !one.is_abandoned(&live) {
                    continue;
                }
                // what stays is found again in an hour
                match bucket.abandon(one).await {
                    Ok(()) => swept += 1,
                    Err(error) => {
                        tracing::warn!(error = %chain(&error), "an abandoned upload stays for now");
                    }
                }
            }
            Ok::<usize, StoreError>(swept)
        };
        match swept.await {
            Ok(0) => {}
            Ok(swept) => tracing::info!(swept, "abandoned uploads were removed"),
            Err(error) => {
                tracing::warn!(error = %chain(&error), "abandoned uploads could not be looked for");
            }
        }
    }

    /// Gives every live attempt a lease from now: the server's absence is not the workers' fault.
    pub(super) async fn renew_leases(&self) -> Result<()> {
        let lease = self.lease_millis();
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                query("UPDATE attempts SET lease_until = ? WHERE ended_at IS NULL")
                    .bind(change.now.as_millis() + lease)
                    .execute(&mut change.connection)
                    .await?;
                Ok(())
            })
        })
        .await
    }

    /// Writes something that changes nothing, to the database and to the folder of files, to find out
    /// whether a write works.
    ///
    /// # Errors
    /// [`StoreError::Full`], [`StoreError::Unavailable`], the database's and the disk's.
    pub async fn try_write(&self) -> Result<()> {
        let tried = self.blobs().try_write().await;
        tried.map_err(|error| self.noted(error))?;
        self.write(|change| {
            Box::pin(async move {
                query("UPDATE store SET starts = starts")
                    .execute(&mut change.connection)
                    .await?;
                Ok(())
            })
        })
        .await
    }

    async fn tidy(&self) -> Result<()> {
        self.write_from_reserve(|change| Box::pin(change.tidy()))
            .await
    }
}

impl Change {
    async fn sweep(&mut self, attempt: Overdue, lease: i64) -> Result<()> {
        // while the database could not be written no worker could be heard of: each has a whole lease
        // from then on
        if attempt.expired && self.now.as_millis().saturating_sub(self.last_trouble) < lease {
            return Err(StoreError::LeaseLost);
        }
        let job = LifecycleRow::of(&mut self.connection, attempt.job).await?;
        let input = match (attempt.expired, attempt.heard) {
            (true, true) => Input::Lose,
            (true, false) => Input::NeverUse,
            (false, _) => Input::ExceedTime,
        };
        let why = self.why(&job, input, &attempt).await?;
        let ending = Ending {
            attempt: attempt.seq,
            token: attempt.token,
            message: None,
            expired: attempt.expired,
        };
        self.step(&job, input, why, Some(ending)).await?;
        Ok(())
    }

    /// The sentence for a loss names the worker, and for the last one quotes the log.
    async fn why(
        &mut self,
        job: &LifecycleRow,
        input: Input,
        attempt: &Overdue,
    ) -> Result<Option<String>> {
        let Ok(step) = transition(job.state()?, input) else {
            return Err(StoreError::LeaseLost);
        };
        let who = format!("{} ({})", attempt.worker_name, attempt.host);
        Ok(match (input, step.state) {
            (Input::NeverUse, State::Queued { .. }) => Some(format!(
                "worker {who} was never heard of after it took the job; waiting for another"
            )),
            (Input::Lose, State::Queued { losses }) => Some(format!(
                "worker {who} fell silent, loss {losses} of {LOSSES_UNTIL_QUARANTINE}; waiting for another"
            )),
            (Input::Lose, State::Finished(loadframe_api::JobOutcome::Quarantined)) => {
                let lines = self.last_lines(job.seq, LINES_QUOTED).await?;
                let log = if lines.is_empty() {
                    "it left no log".to_owned()
                } else {
                    format!("the log ends:\n{}", lines.join("\n"))
                };
                Some(format!(
                    "{LOSSES_UNTIL_QUARANTINE} workers fell silent over it, the last {who}; {log}"
                ))
            }
            _ => None,
        })
    }

    fn tidy(&mut self) -> super::writer::Work<'_, ()> {
        Box::pin(async move {
            let deleted = EventType::Deleted.name();
            for (statement, word) in [
                ("DELETE FROM idempotency_keys WHERE created_at < ?", None),
                ("DELETE FROM workers WHERE last_seen_at < ?", None),
                (
                    "DELETE FROM machines WHERE until < ?1 AND worked_at < ?1",
                    None,
                ),
                (
                    "DELETE FROM events WHERE at < ? AND type = ?",
                    Some(deleted),
                ),
            ] {
                let mut query = query(statement).bind(self.now.as_millis() - REMEMBERED);
                if let Some(word) = word {
                    query = query.bind(word);
                }
                query.execute(&mut self.connection).await?;
            }
            Ok(())
        })
    }
}
