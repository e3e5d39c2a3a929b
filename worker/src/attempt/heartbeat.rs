//! The heartbeat of a lease, sent beside the solver.
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use loadframe_api::JobLimits;
use loadframe_api::worker::Lease;
use loadframe_client::ServerError;
use loadframe_run::{StopCause, resident_memory_mb};
use tokio::time::{MissedTickBehavior, interval};

use super::lease_client::LeaseClient;
use super::stop::AttemptSwitch;

/// How often a worker shows that it lives, and how long it may take.
#[derive(Debug)]
pub(super) struct Schedule {
    every: Duration,
    /// A heartbeat without an answer by then is sent again.
    timeout: Duration,
    /// When the job has taken as long as it may.
    deadline: Option<Instant>,
    /// What the job may take by its estimate.
    limits: Option<JobLimits>,
    begin: Instant,
    /// Memory of this process when the attempt began [MB]: what jobs before it left is not this one's doing.
    begin_mb: f64,
    /// Wall time [s] and bytes of files of the work before this attempt.
    before: (f64, u64),
    /// Bytes of files of this attempt.
    files: Arc<AtomicU64>,
}

impl Schedule {
    pub(super) fn of(lease: &Lease, files: Arc<AtomicU64>) -> Self {
        let saved = lease.checkpoint.as_ref();
        let before = saved.map_or(0.0, |info| info.wall_s);
        let bytes = saved.map_or(0, |info| info.files.iter().map(|file| file.bytes).sum());
        let left = lease.time_limit_s.map(|limit| (limit - before).max(0.0));
        // a limit beyond what a clock can hold is none
        let deadline = left.and_then(|left| {
            let left = Duration::try_from_secs_f64(left).ok()?;
            Instant::now().checked_add(left)
        });
        Self {
            every: Duration::from_secs_f64(lease.heartbeat_s),
            timeout: Duration::from_secs_f64(lease.lease_s / 3.0),
            deadline,
            limits: lease.limits,
            begin: Instant::now(),
            begin_mb: resident_memory_mb(),
            before: (before, bytes),
            files,
        }
    }

    /// What the job has taken too much of, if it has.
    fn excess(&self) -> Option<String> {
        let bytes = self.before.1 + self.files.load(Ordering::Relaxed);
        let used = JobLimits {
            wall_s: self.before.0 + self.begin.elapsed().as_secs_f64(),
            memory_mb: resident_memory_mb() - self.begin_mb,
            disk_mb: bytes as f64 / 1e6,
        };
        self.limits.and_then(|limits| limits.exceeded_by(&used))
    }
}

/// Shows that this worker lives, until dropped or the lease is gone.
pub(super) async fn keep_alive(lease: LeaseClient, schedule: Schedule, switch: Arc<AttemptSwitch>) {
    let mut beat = interval(schedule.every);
    beat.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        beat.tick().await;
        if schedule
            .deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
        {
            switch.stop(StopCause::TimeLimit);
        }
        if let Some(excess) = schedule.excess() {
            switch.stop_for(excess);
        }
        match lease.heartbeat(schedule.timeout).await {
            Ok(()) => {}
            Err(ServerError::LeaseLost) => return,
            Err(error) if error.is_transient() && !lease.is_presumed_lost() => {
                tracing::debug!(%error, "no answer to a heartbeat");
            }
            Err(error) => {
                tracing::warn!(%error, "the lease is taken for lost");
                switch.stop(StopCause::LeaseLost);
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of an attempt that begins now and may take 64 MB of memory and 1 MB of files.
    fn begun() -> Schedule {
        Schedule {
            every: Duration::ZERO,
            timeout: Duration::ZERO,
            deadline: None,
            limits: Some(JobLimits {
                wall_s: 1e9,
                memory_mb: 64.0,
                disk_mb: 1.0,
            }),
            begin: Instant::now(),
            begin_mb: resident_memory_mb(),
            before: (0.0, 0),
            files: Arc::default(),
        }
    }

    #[test]
    fn an_attempt_answers_for_its_own_memory_and_files_and_for_no_others() {
        let first = begun();
        assert_eq!(first.excess(), None);
        let held = vec![1_u8; 100_000_000];
        let excess = first.excess().expect("100 MB are more than 64");
        assert!(
            excess.contains("MB of memory, where 64 is its limit"),
            "{excess}"
        );
        // what is held already is not the next one's doing
        let next = begun();
        assert_eq!(next.excess(), None);
        next.files.store(2_000_000, Ordering::Relaxed);
        let excess = next.excess().expect("2 MB are more than 1");
        assert!(
            excess.contains("taken 2 MB of files, where 1 is its limit"),
            "{excess}"
        );
        assert_eq!(held.last(), Some(&1));
    }
}
