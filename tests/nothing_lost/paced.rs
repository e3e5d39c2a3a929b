//! More requests than one token may make (`--requests-per-s`): workers that share it wait and go on. Nothing is
//! lost by it, and no job pays for it.
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use loadframe_api::{FileEntry, JobOutcome, JobStatus, JobView, sha256_hex};
use loadframe_tests::{
    Cut, Relay, Server, TINY, Worker, is_sound, loadframe, run_alone, until, with_seed,
};
use serde_json::Value;

/// Requests a second; at once, twice as many.
const RATE: u64 = 4;
/// Each is some ten requests, and two workers ask for the next at once.
const JOBS: u64 = 6;

#[test]
fn who_asks_faster_than_it_may_waits_and_every_job_is_computed_once() {
    let server = Server::start_with(&["--require-token", "--requests-per-s", &RATE.to_string()]);
    let token = |scope: &str| -> String {
        let mut command = loadframe();
        command.args([
            "token", "create", "--name", scope, "--scope", scope, "--json",
        ]);
        let made = command.arg("--data").arg(server.data()).output().unwrap();
        assert!(made.status.success(), "{made:?}");
        let made: Value = serde_json::from_slice(&made.stdout).unwrap();
        made["secret"].as_str().unwrap().to_owned()
    };
    let file = server.folder().join("token");
    std::fs::write(&file, token("worker")).unwrap();
    // this test has a token of its own, and asks slowly
    let bearer = format!("Bearer {}", token("submit"));
    let headers = [
        ("authorization", &*bearer),
        ("content-type", "application/json"),
    ];
    let ask = |method: &str, path: &str, body: &str| {
        let answer = server.client.send(method, path, &headers, body.as_bytes());
        answer.unwrap()
    };

    let body = with_seed(TINY, 1);
    let alone = server.folder().join("alone");
    run_alone(&body, 1, &alone);
    let ids: Vec<_> = (0..JOBS)
        .map(|_| {
            ask("POST", "/v1/jobs", &body.to_string())
                .json::<JobView>()
                .id
        })
        .collect();
    let [refused_claims, refused_others] = [(); 2].map(|()| Arc::new(AtomicU64::new(0)));
    let relay = {
        let refused = [Arc::clone(&refused_claims), Arc::clone(&refused_others)];
        Relay::start(&server.url, move |seen| {
            if seen.status == Some(429) {
                let is_claim = seen.request.starts_with("POST /v1/worker/claims");
                refused[usize::from(!is_claim)].fetch_add(1, Relaxed);
            }
            Cut::Pass
        })
    };
    let options = ["--token-file", file.to_str().unwrap()];
    let workers =
        ["first", "second"].map(|name| Worker::start_with(&server, &relay.url, name, &options));
    for id in ids {
        let job = until("the job is finished", || {
            std::thread::sleep(Duration::from_millis(500));
            let job: JobView = ask("GET", &format!("/v1/jobs/{id}"), "").json();
            (job.status == JobStatus::Finished).then_some(job)
        });
        is_sound(&job);
        assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
        assert_eq!(job.attempts.len(), 1, "{job:#?}");
        let listed: Value = ask("GET", &format!("/v1/jobs/{id}/files"), "").json();
        let listed: Vec<FileEntry> = serde_json::from_value(listed["items"].clone()).unwrap();
        assert!(
            listed.iter().any(|file| file.name == "curve.csv"),
            "{listed:?}"
        );
        // these two tell of time and place
        let is_result = |file: &&FileEntry| !["log.jsonl", "outcome.json"].contains(&&*file.name);
        for file in listed.iter().filter(is_result) {
            let expected = sha256_hex(&std::fs::read(alone.join(&file.name)).unwrap());
            assert_eq!(file.sha256, expected, "{}", file.name);
        }
    }
    assert!(refused_claims.load(Relaxed) > 0, "no claim was refused");
    assert!(
        refused_others.load(Relaxed) > 0,
        "no request under a lease was refused"
    );
    for mut worker in workers {
        assert!(worker.process.ended().is_none(), "a worker has gone");
        worker.retire();
    }
}
