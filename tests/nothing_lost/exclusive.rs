//! Two workers never hold one job, and no worker holds two.
use loadframe_api::{JobOutcome, JobStatus, Timestamp};
use loadframe_tests::{Server, TINY, Worker, is_sound, until, with_seed};
use std::collections::BTreeMap;

const WORKERS: usize = 6;
const JOBS: u64 = 120;

#[test]
fn many_workers_share_many_jobs_without_meeting() {
    let server = Server::start();
    // workers first, so that all of them wait for the same job
    let _workers: Vec<Worker> = (0..WORKERS)
        .map(|number| Worker::start(&server, &format!("worker-{number}")))
        .collect();
    for seed in 0..JOBS {
        server.client.submit(&with_seed(TINY, seed));
    }
    until("all jobs are done", || {
        (server.client.jobs("status=finished").len() as u64 == JOBS).then_some(())
    });
    let mut held: BTreeMap<String, Vec<(Timestamp, Timestamp)>> = BTreeMap::new();
    for job in server.client.jobs("") {
        assert_eq!(job.status, JobStatus::Finished);
        assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
        is_sound(&job);
        assert_eq!(job.attempts.len(), 1, "{job:#?}");
        let attempt = &job.attempts[0];
        let span = (attempt.started_at, attempt.ended_at.unwrap());
        held.entry(attempt.worker.clone()).or_default().push(span);
    }
    assert!(held.len() > 1, "the jobs were not shared: {held:?}");
    for (worker, spans) in &mut held {
        spans.sort_unstable();
        for pair in spans.windows(2) {
            assert!(pair[0].1 <= pair[1].0, "{worker} held two jobs: {pair:?}");
        }
    }
}
