//! What has been seen of every job, and what must hold of it.
use std::collections::BTreeMap;

use loadframe_api::{AttemptEnd, Event, JobOutcome, JobStatus, JobView};
use loadframe_server::store::{Store, UserAction};
use uuid::Uuid;

use crate::server::{Answer, Leased, Request};
use crate::worker::{RESULT, Truth};

/// Workers that must have fallen silent over a job before it is set aside.
const LOSSES: usize = 3;

#[derive(Default)]
struct Seen {
    name: String,
    /// Number of the newest attempt, its worker, and whether it was ever heard of.
    attempt: u32,
    worker: Uuid,
    is_heard: bool,
    /// When it was last heard of, or claimed [ms].
    heard_at: i64,
    /// Which message ended an attempt, for those that their workers ended.
    ended_by: BTreeMap<u32, String>,
    outcome: Option<JobOutcome>,
    version: u64,
    /// Status that the last event told.
    told: Option<JobStatus>,
}

/// Nobody falls silent in less [ms]: a lease is 30 s, and each of two leaps of the clock may take what does not
/// look like one, a third of a lease and a second.
const SILENCE: i64 = 30_000 - 2 * 11_000;

/// Everything that the server did.
#[derive(Default)]
pub(crate) struct History {
    /// This moment [ms].
    pub(crate) now: i64,
    jobs: BTreeMap<Uuid, Seen>,
    /// Number of the last event.
    last_event: u64,
}

impl History {
    /// A short name of the job, the same whenever the seed is.
    pub(crate) fn name(&self, id: Uuid) -> &str {
        self.jobs.get(&id).map_or("?", |seen| &seen.name)
    }

    pub(crate) fn jobs(&self) -> impl Iterator<Item = Uuid> {
        self.jobs.keys().copied()
    }

    /// Takes in what the server has just done.
    pub(crate) async fn saw(&mut self, store: &Store, request: &Request, answer: &Answer) {
        match (request, answer) {
            (Request::Claim(claim), Answer::Claimed(Some(lease))) => {
                let seen = self
                    .jobs
                    .get_mut(&lease.job_id)
                    .expect("a job that was submitted");
                if lease.attempt == seen.attempt {
                    // the answer to the first claim was lost
                    assert_eq!(
                        seen.worker, claim.worker_id,
                        "another worker has this lease"
                    );
                    assert!(
                        !seen.is_heard,
                        "a lease that was in use is handed out again"
                    );
                } else {
                    assert_eq!(lease.attempt, seen.attempt + 1, "attempts grow by one");
                    assert_eq!(seen.outcome, None, "a job that has ended is handed out");
                    (seen.attempt, seen.worker, seen.is_heard) =
                        (lease.attempt, claim.worker_id, false);
                }
                seen.heard_at = self.now;
                self.look(store, lease.job_id, false).await;
            }
            (Request::Leased(lease, message), answer) if !matches!(answer, Answer::LeaseLost) => {
                let seen = self
                    .jobs
                    .get_mut(&lease.job_id)
                    .expect("a job that was submitted");
                let end = end(message);
                let ended_by = seen.ended_by.get(&lease.attempt);
                let is_repeated = end.is_some() && ended_by == end.as_ref();
                if !is_repeated {
                    assert_eq!(
                        lease.attempt, seen.attempt,
                        "an attempt that was over is heard"
                    );
                    assert_eq!(ended_by, None, "an attempt goes on after its end");
                    // to read is no sign of life
                    if !matches!(message, Leased::Fetch) {
                        (seen.is_heard, seen.heard_at) = (true, self.now);
                    }
                    if let Some(end) = end {
                        seen.ended_by.insert(lease.attempt, end);
                    }
                }
                self.look(store, lease.job_id, false).await;
            }
            (Request::Submit { name, .. }, Answer::Job(job)) => {
                let known = self.jobs.values().filter(|seen| seen.name == *name).count();
                assert_eq!(
                    known,
                    usize::from(self.jobs.contains_key(&job.id)),
                    "submitted twice"
                );
                self.jobs.entry(job.id).or_default().name.clone_from(name);
                self.look(store, job.id, false).await;
            }
            (Request::Ask { action, .. }, Answer::Job(job)) => {
                self.look(store, job.id, *action == UserAction::Retry).await;
            }
            _ => {}
        }
    }

    /// Looks at every job whose version went on, after something that concerns any of them.
    pub(crate) async fn look_at_changed(&mut self, store: &Store) {
        for id in self.jobs().collect::<Vec<_>>() {
            if store.job_version(id).await.unwrap() != self.jobs[&id].version {
                self.look(store, id, false).await;
            }
        }
    }

    /// What must hold of a job at any moment.
    async fn look(&mut self, store: &Store, id: Uuid, is_retried: bool) {
        let (job, version) = (
            store.job(id).await.unwrap(),
            store.job_version(id).await.unwrap(),
        );
        let seen = self.jobs.get_mut(&id).expect("a job that was submitted");
        assert!(
            version >= seen.version,
            "{}: a version goes back",
            seen.name
        );
        seen.version = version;
        assert_eq!(
            job.attempt, seen.attempt,
            "{}: an attempt nobody claimed",
            seen.name
        );
        let live = job
            .attempts
            .iter()
            .filter(|attempt| attempt.end_reason.is_none());
        let running = usize::from(job.status == JobStatus::Running);
        assert_eq!(live.count(), running, "{}: {:?}", seen.name, job.attempts);
        let newest = job
            .attempts
            .iter()
            .find(|attempt| attempt.number == seen.attempt);
        if newest.is_some_and(|newest| newest.end_reason == Some(AttemptEnd::Lost)) {
            let silent = self.now - seen.heard_at;
            assert!(silent >= SILENCE, "{}: lost after {silent} ms", seen.name);
        }
        if seen.outcome.is_some() && !is_retried {
            assert_eq!(job.outcome, seen.outcome, "{}: the end changes", seen.name);
        }
        seen.outcome = job.outcome;
    }

    /// Reads on in the events.
    pub(crate) async fn follow(&mut self, store: &Store) {
        loop {
            let events = store
                .events_after(self.last_event, None, 100)
                .await
                .unwrap();
            let Some(last) = events.last() else { return };
            let last = last.number;
            for event in events {
                assert!(event.number > self.last_event, "events out of order");
                self.last_event = event.number;
                if let Event::Job(job) = event.event {
                    self.jobs.get_mut(&job.id).expect("a job").told = Some(job.status);
                }
            }
            self.last_event = last;
        }
    }

    /// What must hold of every job once all is quiet.
    pub(crate) async fn settled(&mut self, store: &Store) {
        self.follow(store).await;
        // all of them: what changed without its version shows at last here
        for id in self.jobs().collect::<Vec<_>>() {
            self.look(store, id, false).await;
        }
        for (id, seen) in &self.jobs {
            let job = store.job(*id).await.unwrap();
            assert_eq!(
                seen.told,
                Some(job.status),
                "{}: nobody was told",
                seen.name
            );
            let outcome = job
                .outcome
                .unwrap_or_else(|| panic!("{} has no end", seen.name));
            let truth = Truth::of(&job.spec_sha256);
            match outcome {
                JobOutcome::Succeeded => {
                    assert!(!truth.fails, "{} cannot succeed", seen.name);
                    whole(store, seen, &job, &truth).await;
                }
                JobOutcome::Failed | JobOutcome::Cancelled => no_result(store, *id).await,
                JobOutcome::Quarantined => {
                    let lost = |attempt: &&loadframe_api::AttemptView| {
                        attempt.end_reason == Some(AttemptEnd::Lost)
                    };
                    let losses = job.attempts.iter().filter(lost).count();
                    assert!(losses >= LOSSES, "{}: {losses} losses", seen.name);
                    no_result(store, *id).await;
                }
                JobOutcome::TimedOut => panic!("{}: no job has a time limit", seen.name),
            }
        }
        store.settled_files().await;
        let report = store.scrub(None).await.unwrap();
        assert_eq!(report.lost, []);
    }
}

/// A succeeded job has the whole curve, and the files of the attempt that ended it.
async fn whole(store: &Store, seen: &Seen, job: &JobView, truth: &Truth) {
    let curve = store.curve(job.id, 0, None).await.unwrap();
    let expected: Vec<Vec<f64>> = (0..truth.points).map(|index| truth.point(index)).collect();
    assert_eq!(curve.points, expected, "{}", seen.name);
    assert!(curve.complete);
    let winner = seen
        .ended_by
        .iter()
        .rfind(|(_, message)| *message == "complete");
    let (winner, _) = winner.expect("an attempt that completed");
    assert_eq!(
        *winner, job.attempt,
        "{}: attempts after its end",
        seen.name
    );
    let file = store.file(job.id, RESULT).await.unwrap();
    let path = store.content(job.id, &file).await.unwrap();
    let text = std::fs::read_to_string(path.path().expect("a file of this machine")).unwrap();
    assert_eq!(text, format!("job {} attempt {winner}", job.id));
    for file in store.files(job.id).await.unwrap() {
        store.content(job.id, &file).await.unwrap();
    }
}

/// What a job left that did not succeed is no result.
async fn no_result(store: &Store, id: Uuid) {
    assert!(store.outcome(id).await.is_err());
}

/// The message, if it ends an attempt.
fn end(message: &Leased) -> Option<String> {
    let word = match message {
        Leased::Complete(_) => "complete",
        Leased::Fail(_) => "fail",
        Leased::Fault(_) => "fault",
        Leased::Release(reason) => return Some(format!("release {reason:?}")),
        Leased::ExceedEstimate => "exceed",
        _ => return None,
    };
    Some(word.to_owned())
}
