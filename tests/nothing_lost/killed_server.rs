//! The server killed with -9 under load: no accepted job is lost, none is doubled, and it is ready
//! again in time.
use loadframe_api::{JobOutcome, JobView};
use loadframe_tests::{Chance, Client, Server, TINY, Worker, is_sound, soak, until, with_seed};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};
use uuid::Uuid;

/// Kills, when `LOADFRAME_SOAK` sets no time.
const KILLS: u64 = 20;
/// Clients that submit without pause.
const CLIENTS: usize = 3;
/// The promise: ready again within this time.
const READY_WITHIN: Duration = Duration::from_secs(2);
/// The server lives for at most this long between two kills.
const LONGEST_LIFE: Duration = Duration::from_millis(600);

#[test]
fn no_accepted_job_is_lost_and_none_is_doubled() {
    let mut chance = Chance::new("killed server");
    // a lease beyond the time the server is away: its workers are alive all the while
    let mut server = Server::start_with(&["--lease-s", "10"]);
    let _workers = ["a", "b"].map(|name| Worker::start(&server, name));
    let stop = AtomicBool::new(false);
    let mut slowest = Duration::ZERO;
    let accepted: Vec<(String, Uuid)> = std::thread::scope(|scope| {
        let clients: Vec<_> = (0..CLIENTS)
            .map(|number| {
                let (client, stop) = (server.client.clone(), &stop);
                scope.spawn(move || submit_without_pause(&client, number, stop))
            })
            .collect();
        let end = soak().map(|duration| Instant::now() + duration);
        for kill in 0.. {
            if end.map_or(kill == KILLS, |end| Instant::now() > end) {
                break;
            }
            std::thread::sleep(chance.duration(LONGEST_LIFE));
            server.process.kill();
            let begin = Instant::now();
            server.restart();
            server.wait_until_ready();
            slowest = slowest.max(begin.elapsed());
        }
        stop.store(true, Relaxed);
        clients
            .into_iter()
            .flat_map(|client| client.join().unwrap())
            .collect()
    });
    eprintln!(
        "killed server: {} jobs accepted, ready again in {slowest:?} at worst",
        accepted.len()
    );
    assert!(slowest < READY_WITHIN, "{slowest:?}");

    // every accepted job is there under its id, and nothing else is
    let mut jobs: BTreeMap<Uuid, JobView> = BTreeMap::new();
    for job in server.client.jobs("") {
        assert!(jobs.insert(job.id, job).is_none(), "a page repeats a job");
    }
    for (key, id) in &accepted {
        let job = jobs
            .get(id)
            .unwrap_or_else(|| panic!("the accepted job {id} is gone"));
        assert_eq!(job.tags.as_slice(), std::slice::from_ref(key));
    }
    assert_eq!(jobs.len(), accepted.len(), "jobs were doubled");
    // far more were accepted than two workers can do in a test: the rest is called off
    for job in server.client.jobs("status=queued") {
        server.client.ask(job.id, "cancel");
    }
    until("no job is open", || {
        let open = |status| server.client.jobs(&format!("status={status}")).len();
        (open("queued") + open("running") == 0).then_some(())
    });
    let mut succeeded = 0;
    for job in server.client.jobs("") {
        is_sound(&job);
        match job.outcome {
            Some(JobOutcome::Succeeded) => succeeded += 1,
            outcome => assert_eq!(outcome, Some(JobOutcome::Cancelled), "{job:#?}"),
        }
        assert!(
            job.attempts.len() <= 1,
            "a living worker was called dead: {job:#?}"
        );
    }
    eprintln!("killed server: {succeeded} jobs were done meanwhile");
    assert!(succeeded > 0);
}

/// Submits job after job under keys of its own, each again and again until it is accepted.
fn submit_without_pause(client: &Client, number: usize, stop: &AtomicBool) -> Vec<(String, Uuid)> {
    let mut accepted = Vec::new();
    while !stop.load(Relaxed) {
        let key = format!("client-{number}-job-{}", accepted.len());
        let mut body = with_seed(TINY, 1);
        body["tags"] = json!([key]);
        let body = body.to_string();
        let headers = [
            ("content-type", "application/json"),
            ("idempotency-key", &*key),
        ];
        let id = until("the job is accepted", || {
            let answer = client
                .send("POST", "/v1/jobs", &headers, body.as_bytes())
                .ok()?;
            assert!(matches!(answer.status, 200 | 201), "{answer}");
            Some(answer.json::<JobView>().id)
        });
        accepted.push((key, id));
    }
    accepted
}
