//! Heartbeats that are not written down yet.
//!
//! A worker shows every second that it lives. To write each of these down would cost the disk a commit and
//! would say no more than the last of them; so they gather here, and the sweeper writes all of them in one
//! statement before it looks for leases that have run out. Of a server that is killed nothing is lost: the
//! next one gives every attempt a fresh lease.
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use loadframe_api::worker::Command;

use super::database::{query, query_as};
use super::encoding::json;
use super::error::{Result, StoreError};
use super::state::LifecycleRow;
use super::writer::Change;
use super::{LeaseKey, Store};
use crate::queue::UserRequest;

/// When each attempt was last heard of [ms since 1970], by its row.
#[derive(Debug, Default)]
pub(super) struct Pulses(Mutex<BTreeMap<i64, i64>>);

impl Pulses {
    fn note(&self, attempt: i64, at: i64) {
        self.lock().insert(attempt, at);
    }

    /// Whether the attempt was heard of since the last were written down.
    pub(super) fn has(&self, attempt: i64) -> bool {
        self.lock().contains_key(&attempt)
    }

    fn all(&self) -> Vec<(i64, i64)> {
        let pulses = self.lock();
        pulses.iter().map(|(attempt, at)| (*attempt, *at)).collect()
    }

    /// Forgets those that are written down, but for whoever was heard of again since.
    fn forget(&self, written: &[(i64, i64)]) {
        let mut pulses = self.lock();
        for (attempt, at) in written {
            if pulses.get(attempt) == Some(at) {
                pulses.remove(attempt);
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<i64, i64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Store {
    /// Extends the lease and tells what the user wants of the attempt. The first heartbeat of an attempt is
    /// written down at once: whatever the job does to its worker from then on counts.
    ///
    /// # Errors
    /// [`StoreError::LeaseLost`] when the lease is not held.
    pub async fn heartbeat(&self, key: LeaseKey) -> Result<Command> {
        let live: Option<(i64, bool, Option<String>)> = query_as(
            "SELECT a.seq, a.heard, j.asked FROM attempts a JOIN jobs j ON j.seq = a.job
             WHERE a.id = ? AND a.token = ? AND a.ended_at IS NULL",
        )
        .bind(key.id)
        .bind(key.token)
        .fetch_optional(self.lookups())
        .await?;
        let (attempt, heard, asked) = live.ok_or(StoreError::LeaseLost)?;
        if heard {
            let asked = LifecycleRow::asked_for(asked.as_deref())?;
            self.pulses().note(attempt, self.now().as_millis());
            return Ok(UserRequest::command(asked));
        }
        let lease = self.lease_millis();
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                let attempt = change.extend(key, lease).await?;
                let job = LifecycleRow::of(&mut change.connection, attempt.job).await?;
                Ok(UserRequest::command(job.asked()?))
            })
        })
        .await
    }

    /// Writes down the heartbeats that have come since the last time.
    ///
    /// # Errors
    /// The database's; the heartbeats are then kept for the next time.
    pub(super) async fn write_pulses(&self) -> Result<()> {
        let pulses = self.pulses().all();
        if pulses.is_empty() {
            return Ok(());
        }
        let (rows, lease) = (json(&pulses)?, self.lease_millis());
        self.write_from_reserve(move |change| {
            Box::pin(async move { change.extend_all(&rows, lease).await })
        })
        .await?;
        self.pulses().forget(&pulses);
        Ok(())
    }
}

impl Change {
    /// Extends the live leases of attempts, and notes that their workers are there: `pulses` is a list of
    /// rows of attempts with the moment of each.
    async fn extend_all(&mut self, pulses: &str, lease: i64) -> Result<()> {
        query(
            "UPDATE attempts SET lease_until = p.at + ?2
             FROM (SELECT CAST(json_extract(value, '$[0]') AS BIGINT) AS attempt,
                          CAST(json_extract(value, '$[1]') AS BIGINT) AS at FROM json_each(?1)) p
             WHERE seq = p.attempt AND ended_at IS NULL AND lease_until < p.at + ?2",
        )
        .bind(pulses)
        .bind(lease)
        .execute(&mut self.connection)
        .await?;
        query(
            "UPDATE workers SET last_seen_at = heard.at
             FROM (SELECT a.worker, MAX(CAST(json_extract(p.value, '$[1]') AS BIGINT)) AS at
                   FROM json_each(?1) p JOIN attempts a ON a.seq = CAST(json_extract(p.value, '$[0]') AS BIGINT)
                   GROUP BY a.worker) heard
             WHERE id = heard.worker AND last_seen_at < heard.at",
        )
        .bind(pulses)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_was_heard_of_while_others_were_written_is_kept() {
        let pulses = Pulses::default();
        pulses.note(1, 100);
        pulses.note(2, 100);
        pulses.note(1, 150);
        let written = pulses.all();
        assert_eq!(written, [(1, 150), (2, 100)]);
        pulses.note(2, 200);
        pulses.forget(&written);
        assert_eq!(pulses.all(), [(2, 200)]);
        assert!(pulses.has(2) && !pulses.has(1));
    }
}
