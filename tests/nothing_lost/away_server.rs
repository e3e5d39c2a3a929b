//! A server that is away for long: its workers go on computing, and bring everything when it is back.
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, JobView};
use loadframe_tests::{JobFiles, LONG, Server, Worker, is_sound, run_alone, until, with_seed};
use std::time::{Duration, Instant};
use uuid::Uuid;

/// A lease of 2 s ends many times while the server is away.
const LEASE_S: &str = "2";
/// Until the job has come further after a stop than it was before, and longer than eight leases.
const AWAY: Duration = Duration::from_secs(16);

/// A server without its process, and the job that a worker was computing then.
fn away(server: &mut Server, worker: &Worker) -> Uuid {
    let id = server.client.submit(&with_seed(LONG, 1));
    until("the job computes", || {
        let job = server.client.job(id);
        (worker.holds(&job) && job.progress > 0.0).then_some(())
    });
    server.process.kill();
    id
}

fn back(server: &mut Server, id: Uuid) -> JobView {
    server.restart();
    server.wait_until_ready();
    until("the job has ended", || {
        let job = server.client.job(id);
        (job.status == JobStatus::Finished).then_some(job)
    })
}

#[test]
fn a_worker_computes_on_while_the_server_is_away_and_brings_all_of_it() {
    let mut server = Server::start_with(&["--lease-s", LEASE_S]);
    let begin = Instant::now();
    let alone = run_alone(&with_seed(LONG, 1), 1, &server.folder().join("alone"));
    let takes = begin.elapsed();
    let worker = Worker::start(&server, "patient");
    let id = away(&mut server, &worker);
    std::thread::sleep(AWAY.max(2 * takes));
    let returned = Instant::now();
    let job = back(&mut server, id);
    // had the worker stood still, most of the job would be to do yet
    assert!(
        returned.elapsed() < takes.max(Duration::from_secs(3)),
        "it took {:?} of {takes:?} to end after the server was back",
        returned.elapsed()
    );
    is_sound(&job);
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
    assert_eq!(job.attempts.len(), 1, "{job:#?}");
    assert_eq!(JobFiles::on_server(&server.client, id), alone);
}

#[test]
fn a_worker_that_may_not_wait_so_long_drops_the_job_and_takes_it_again() {
    let mut server = Server::start_with(&["--lease-s", LEASE_S]);
    let url = server.url.clone();
    let worker = Worker::start_with(&server, &url, "hasty", &["--server-away", "3"]);
    let id = away(&mut server, &worker);
    // not a time: on a busy machine the worker may give the server up later, and never if it is back by then
    let log = server.folder().join("hasty.log");
    until("the worker has dropped the job", || {
        let log = std::fs::read_to_string(&log).ok()?;
        log.contains("everything of this attempt is dropped")
            .then_some(())
    });
    let job = back(&mut server, id);
    is_sound(&job);
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
    // on a busy machine the second lease of 2 s may be lost as well, which is not what is tested
    assert!(job.attempts.len() >= 2, "{job:#?}");
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Lost));
}
