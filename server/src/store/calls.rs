//! Who is called when a job comes: of the workers that wait at this server, as many as there are jobs.
//!
//! Whoever is called looks into the table, and gets what [`super::choice`] decides there. To call all of them for
//! every job would send all but one through the writer in vain: with a hundred that wait, each job would wait for
//! a hundred looks. So those are called whom a job suits, the smallest machines first and of equal ones who has
//! waited longest; who has looked in vain, or goes away, leaves the call to the next.
//!
//! A call is no truth: a worker that is never called looks by itself every other second
//! (`http::worker::claims`), so that one that is lost costs that time and nothing else.
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use loadframe_api::JobKind;
use loadframe_api::worker::ClaimRequest;
use tokio::sync::{Notify, watch};

use super::database::{Pool, query_as, row};
use super::encoding::variant;
use super::error::Result;
use crate::queue::needs::{Needs, Offer};

/// The workers that wait at this server.
#[derive(Debug, Default)]
pub(super) struct Calls {
    line: Mutex<Line>,
    /// Somebody has left a call to the next.
    left: Notify,
}

/// Jobs that wait alike, and how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Wanted {
    kind: JobKind,
    needs: Needs,
    jobs: usize,
}

#[derive(Debug, Default)]
struct Line {
    next: u64,
    /// By their places, the one that has waited longest first.
    waiting: BTreeMap<u64, Waiter>,
}

#[derive(Debug)]
struct Waiter {
    offer: Offer,
    /// How often jobs had come when its last look began: it has seen these.
    looked_at: u64,
    /// Called for such jobs, until it has looked.
    called: Option<(JobKind, Needs)>,
    bell: Arc<Notify>,
}

/// A worker's place among those that wait, until it is dropped.
#[derive(Debug)]
pub struct Waiting {
    calls: Arc<Calls>,
    queued: watch::Receiver<u64>,
    place: u64,
    bell: Arc<Notify>,
    /// Its look is the answer to a call.
    answers: bool,
}

impl Waiting {
    /// A place for the worker of `request`, where `queued` counts how often jobs came.
    pub(super) fn among(
        calls: Arc<Calls>,
        queued: watch::Receiver<u64>,
        request: &ClaimRequest,
    ) -> Self {
        let bell = Arc::<Notify>::default();
        let waiter = Waiter {
            offer: Offer::of(request),
            looked_at: *queued.borrow(),
            called: None,
            bell: Arc::clone(&bell),
        };
        let place = calls.lock().enter(waiter);
        Self {
            calls,
            queued,
            place,
            bell,
            answers: false,
        }
    }

    /// Notes that the worker looks for a job now. To be told before it does: what comes in between calls it.
    pub fn looks(&mut self) {
        let came = *self.queued.borrow();
        let mut line = self.calls.lock();
        if let Some(waiter) = line.waiting.get_mut(&self.place) {
            waiter.looked_at = came;
            self.answers = waiter.called.is_some();
        }
    }

    /// Waits for a call, after a look in vain.
    pub async fn called(&mut self) {
        if std::mem::take(&mut self.answers) {
            if let Some(waiter) = self.calls.lock().waiting.get_mut(&self.place) {
                waiter.called = None;
            }
            self.calls.left.notify_one();
        }
        loop {
            let rings = self.bell.notified();
            let is_called = |waiter: &Waiter| waiter.called.is_some();
            if self
                .calls
                .lock()
                .waiting
                .get(&self.place)
                .is_some_and(is_called)
            {
                return;
            }
            rings.await;
        }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        let waiter = self.calls.lock().waiting.remove(&self.place);
        // what it was called for may be there still, and so may what came for it meanwhile
        if waiter.is_some_and(|waiter| waiter.called.is_some()) {
            self.calls.left.notify_one();
        }
    }
}

impl Calls {
    fn lock(&self) -> MutexGuard<'_, Line> {
        self.line.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls workers when jobs come, until none can come any more.
    pub(super) async fn keep_calling(
        self: Arc<Self>,
        database: Pool,
        mut queued: watch::Receiver<u64>,
    ) {
        loop {
            tokio::select! {
                came = queued.changed() => {
                    if came.is_err() {
                        return;
                    }
                }
                () = self.left.notified() => {}
            }
            let came = *queued.borrow_and_update();
            if !self.lock().has_any(came) {
                continue;
            }
            match Wanted::read(&database).await {
                Ok(wanted) => self.lock().call(&wanted, came),
                Err(error) => {
                    tracing::warn!(%error, "it is not known what waits: all workers look");
                    self.lock().call_all(came);
                }
            }
        }
    }
}

row! {
    struct WantedRow {
        kind: String,
        jobs: i64,
        memory_mb: i64,
        disk_mb: i64,
        core_s: i64,
        threads: u32,
        release: u32,
    }
}

impl Wanted {
    /// What waits and may run, those that need most memory first: of each line no more than its owner may have
    /// running beside what runs.
    async fn read(database: &Pool) -> Result<Vec<Self>> {
        let rows: Vec<WantedRow> = query_as(
            "SELECT l.kind, n.memory_mb, n.disk_mb, n.core_s, n.threads, n.release,
                    CAST(SUM(CASE WHEN p.room < l.jobs THEN p.room ELSE l.jobs END) AS BIGINT) AS jobs
             FROM waiting_lines l JOIN needs n ON n.id = l.needs LEFT JOIN
                (SELECT p.id, p.most_running - (SELECT COUNT(*) FROM attempts a JOIN jobs j ON j.seq = a.job
                    WHERE a.ended_at IS NULL AND j.owner = p.id) AS room
                 FROM people p WHERE p.most_running IS NOT NULL) p ON p.id = l.owner
             WHERE p.room IS NULL OR p.room > 0
             GROUP BY l.kind, n.id, n.memory_mb, n.disk_mb, n.core_s, n.threads, n.release
             ORDER BY n.memory_mb DESC",
        )
        .fetch_all(database)
        .await?;
        let wanted = rows.into_iter().map(|row| {
            Ok(Self {
                kind: variant(&row.kind)?,
                needs: Needs {
                    memory_mb: row.memory_mb,
                    disk_mb: row.disk_mb,
                    core_s: row.core_s,
                    threads: row.threads,
                    release: row.release,
                },
                jobs: usize::try_from(row.jobs).unwrap_or_default(),
            })
        });
        wanted.collect()
    }
}

impl Waiter {
    /// Whether it has not seen all that came, and is not about to look.
    fn may_be_called(&self, came: u64) -> bool {
        self.called.is_none() && self.looked_at < came
    }

    fn call(&mut self, kind: JobKind, needs: Needs) {
        self.called = Some((kind, needs));
        self.bell.notify_one();
    }
}

impl Line {
    fn enter(&mut self, waiter: Waiter) -> u64 {
        let place = self.next;
        self.next += 1;
        self.waiting.insert(place, waiter);
        place
    }

    fn has_any(&self, came: u64) -> bool {
        let mut waiting = self.waiting.values();
        waiting.any(|waiter| waiter.may_be_called(came))
    }

    /// Calls one worker for each job, less those that are called for such jobs already.
    fn call(&mut self, wanted: &[Wanted], came: u64) {
        for &Wanted { kind, needs, jobs } in wanted {
            let on_their_way = self.waiting.values();
            let on_their_way = on_their_way.filter(|of| of.called == Some((kind, needs)));
            let open = jobs.saturating_sub(on_their_way.count());
            if open == 0 {
                continue;
            }
            let suits = |waiter: &Waiter| {
                waiter.may_be_called(came) && needs.lacks(kind, &waiter.offer).is_empty()
            };
            let mut suitable: Vec<&mut Waiter> =
                self.waiting.values_mut().filter(|of| suits(of)).collect();
            let memory = |waiter: &Waiter| waiter.offer.memory_mb.unwrap_or(f64::INFINITY);
            // stable: of equal ones who has waited longest
            suitable.sort_by(|a, b| memory(a).total_cmp(&memory(b)));
            for waiter in suitable.into_iter().take(open) {
                waiter.call(kind, needs);
            }
        }
    }

    fn call_all(&mut self, came: u64) {
        let nothing = Needs {
            memory_mb: 0,
            disk_mb: 0,
            core_s: 0,
            threads: 0,
            release: 0,
        };
        for waiter in self.waiting.values_mut() {
            if waiter.may_be_called(came) {
                waiter.call(JobKind::Calibrate, nothing);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: JobKind = JobKind::NonwovenTensile;

    fn needs(memory_mb: i64) -> Needs {
        Needs {
            memory_mb,
            disk_mb: 10,
            core_s: 1,
            threads: 1,
            release: 0,
        }
    }

    fn wanted(memory_mb: i64, jobs: usize) -> Wanted {
        Wanted {
            kind: KIND,
            needs: needs(memory_mb),
            jobs,
        }
    }

    /// Workers with so much memory, who have all looked before anything came.
    fn line(memories: &[Option<f64>]) -> Line {
        let mut line = Line::default();
        for &memory_mb in memories {
            let offer = Offer {
                kinds: vec![KIND],
                memory_mb,
                disk_mb: None,
                core_s: None,
                threads: 1,
                release: None,
            };
            line.enter(Waiter {
                offer,
                looked_at: 0,
                called: None,
                bell: Arc::default(),
            });
        }
        line
    }

    fn called(line: &Line) -> Vec<u64> {
        let called = line.waiting.iter().filter(|(_, of)| of.called.is_some());
        called.map(|(place, _)| *place).collect()
    }

    #[test]
    fn as_many_are_called_as_there_are_jobs_who_waited_longest_first() {
        let mut line = line(&[None; 5]);
        line.call(&[wanted(10, 2)], 1);
        assert_eq!(called(&line), [0, 1]);
        // those two are on their way to the two jobs; one job more calls one more
        line.call(&[wanted(10, 2)], 1);
        assert_eq!(called(&line), [0, 1]);
        line.call(&[wanted(10, 3)], 2);
        assert_eq!(called(&line), [0, 1, 2]);
        line.call(&[wanted(10, 99)], 3);
        assert_eq!(called(&line), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn the_smallest_that_suits_is_called_and_whom_nothing_suits_is_not() {
        let mut line = line(&[Some(64_000.0), Some(4_000.0), Some(16_000.0), None]);
        line.call(&[wanted(8_000, 1)], 1);
        assert_eq!(called(&line), [2]);
        line.call(&[wanted(8_000, 9)], 1);
        assert_eq!(called(&line), [0, 2, 3]);
        let other = Wanted {
            kind: JobKind::Calibrate,
            ..wanted(10, 9)
        };
        line.call(&[other], 1);
        assert_eq!(called(&line), [0, 2, 3], "none of them computes it");
    }

    #[test]
    fn who_has_seen_all_that_came_is_not_called_for_it_and_the_next_is() {
        let mut line = line(&[None; 3]);
        line.call(&[wanted(10, 1)], 1);
        // it looked in vain, say because its machine is set aside
        let first = line.waiting.get_mut(&0).unwrap();
        (first.called, first.looked_at) = (None, 1);
        assert!(line.has_any(1));
        line.call(&[wanted(10, 1)], 1);
        assert_eq!(called(&line), [1]);
        // what comes later is for it again
        line.call(&[wanted(10, 2)], 2);
        assert_eq!(called(&line), [0, 1]);
    }

    #[tokio::test]
    async fn a_call_of_who_goes_away_is_left_to_the_next() {
        let (queue, queued) = watch::channel(0);
        let calls = Arc::<Calls>::default();
        *calls.lock() = line(&[None; 2]);
        let bell = Arc::clone(&calls.lock().waiting[&0].bell);
        let mut first = Waiting {
            calls: Arc::clone(&calls),
            queued,
            place: 0,
            bell,
            answers: false,
        };
        queue.send_replace(1);
        calls.lock().call(&[wanted(10, 1)], 1);
        first.called().await;
        // it looks, and is called for what came meanwhile: neither call is lost with it
        first.looks();
        drop(first);
        calls.left.notified().await;
        calls.lock().call(&[wanted(10, 1)], 1);
        assert_eq!(called(&calls.lock()), [1]);
    }
}
