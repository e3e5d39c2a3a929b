//! The worker's side of the protocol driven by hand: whoever no longer holds the lease is refused
//! on every route, and nothing of it shows.
use loadframe_api::worker::{ClaimRequest, LEASE_TOKEN_HEADER, Lease};
use loadframe_api::{JobOutcome, JobStatus, sha256_hex};
use loadframe_tests::{Answer, Server, TINY, losses, until, with_seed};
use serde_json::{Value, json};
use uuid::Uuid;

const FILE: &[u8] = b"nominal_strain,force_n\n0,0\n";

fn claim(server: &Server) -> Option<Lease> {
    let request = ClaimRequest::new(Uuid::new_v4(), "by hand", "here", "0");
    let answer = server.client.post("/v1/worker/claims", &request);
    match answer.status {
        204 => None,
        _ => Some(answer.json()),
    }
}

/// A request under a lease.
fn write(server: &Server, lease: (Uuid, Uuid), method: &str, path: &str, body: &[u8]) -> Answer {
    let token = lease.1.to_string();
    let media_type = match method {
        "POST" => "application/json",
        _ => "application/octet-stream",
    };
    let headers = [(LEASE_TOKEN_HEADER, &*token), ("content-type", media_type)];
    let path = format!("/v1/worker/leases/{}/{path}", lease.0);
    server.client.send(method, &path, &headers, body).unwrap()
}

/// An outcome of the job that `lease` is about.
fn outcome(lease: &Lease) -> Value {
    json!({
        "kind": "nonwoven_tensile", "status": "succeeded", "stop_reason": "max_strain",
        "summary": {}, "quality": {}, "warnings": [], "files": [],
        "cost": {"wall_s": 1.0, "cpu_s": 1.0, "threads": 1, "peak_memory_mb": 1.0, "work": {}},
        "provenance": {
            "spec_sha256": lease.spec_sha256, "engine_version": "0", "engine_commit": "0", "seed": 1,
            "threads": 1, "started_at": "2026-01-01T00:00:00Z", "host": "here",
        },
    })
}

/// Every route that takes a lease: method, path, body. Each is a request that would be accepted
/// under a lease that holds.
fn every_route(lease: &Lease) -> Vec<(&'static str, String, Vec<u8>)> {
    let json = |value: Value| value.to_string().into_bytes();
    let sum = sha256_hex(FILE);
    let files = json!([{"name": "outcome.json", "bytes": FILE.len(), "sha256": sum}]);
    let points =
        json!({"columns": ["nominal_strain", "force_n"], "first": 0, "rows": [[0.0, 0.0]]});
    vec![
        ("POST", "heartbeat".to_owned(), json(json!({}))),
        (
            "POST",
            "progress".to_owned(),
            json(
                json!({"progress": 0.9, "phase": "stale", "eta_s": null, "points": points, "log": ["stale"]}),
            ),
        ),
        (
            "PUT",
            format!("files/curve.csv?sha256={sum}"),
            FILE.to_vec(),
        ),
        (
            "PUT",
            format!("checkpoint?sha256={sum}&wall_s=1&cpu_s=1"),
            FILE.to_vec(),
        ),
        ("GET", "checkpoint".to_owned(), Vec::new()),
        (
            "POST",
            "complete".to_owned(),
            json(json!({"outcome": outcome(lease), "files": files})),
        ),
        (
            "POST",
            "fail".to_owned(),
            json(json!({"code": "worker_error", "reason": "stale"})),
        ),
        (
            "POST",
            "release".to_owned(),
            json(json!({"reason": "cancelled"})),
        ),
    ]
}

#[track_caller]
fn is_refused_everywhere(server: &Server, of: &Lease, key: (Uuid, Uuid)) {
    for (method, path, body) in every_route(of) {
        let answer = write(server, key, method, &path, &body);
        assert_eq!(answer.status, 409, "{method} {path}: {answer}");
        assert_eq!(answer.content_type, "application/problem+json", "{answer}");
    }
}

#[test]
fn a_stale_lease_is_refused_everywhere_and_leaves_no_trace() {
    let server = Server::start();
    let id = server.client.submit(&with_seed(TINY, 1));
    let first = claim(&server).unwrap();
    let stale = (first.id, first.token);
    assert_eq!(first.job_id, id);
    // a checkpoint that only its holder may read
    let (_, path, body) = &every_route(&first)[3];
    let answer = write(&server, stale, "PUT", path, body);
    assert!(answer.status < 300, "{answer}");
    until("the lease has run out", || {
        (losses(&server.client.job(id)) == 1).then_some(())
    });
    is_refused_everywhere(&server, &first, stale);

    // while another holds the job
    let second = claim(&server).unwrap();
    let held = (second.id, second.token);
    assert_eq!((second.job_id, second.attempt), (id, 2));
    assert!(
        second.checkpoint.is_some(),
        "the checkpoint of the lost attempt is handed on"
    );
    let before = server.client.job(id);
    is_refused_everywhere(&server, &first, stale);
    is_refused_everywhere(&server, &first, (second.id, first.token));
    is_refused_everywhere(&server, &first, (first.id, second.token));
    is_refused_everywhere(&server, &first, (Uuid::nil(), second.token));
    let after = server.client.job(id);
    assert_eq!(
        (after.status, &after.phase),
        (JobStatus::Running, &before.phase)
    );
    assert_eq!(after.attempts, before.attempts);
    let files: Value = server.client.get(&format!("/v1/jobs/{id}/files")).json();
    assert_eq!(files["items"], json!([]));
    let curve: Value = server.client.get(&format!("/v1/jobs/{id}/curve")).json();
    assert_eq!(curve["points"], json!([]));

    // the holder publishes, once
    let text = outcome(&second).to_string();
    let sum = sha256_hex(text.as_bytes());
    let upload = format!("files/outcome.json?sha256={sum}");
    let answer = write(&server, held, "PUT", &upload, text.as_bytes());
    assert!(answer.status < 300, "{answer}");
    let entry = json!({"name": "outcome.json", "bytes": text.len(), "sha256": sum});
    let end = json!({"outcome": outcome(&second), "files": [entry]}).to_string();
    let answer = write(&server, held, "POST", "complete", end.as_bytes());
    assert!(answer.status < 300, "{answer}");
    let job = server.client.job(id);
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded));
    is_refused_everywhere(&server, &first, held);
    is_refused_everywhere(&server, &first, stale);
    assert_eq!(server.client.job(id), job);
    let answer = server
        .client
        .get(&format!("/v1/jobs/{id}/files/outcome.json"));
    assert_eq!(answer.body, text.as_bytes());
}

#[test]
fn an_upload_that_is_not_what_it_says_is_refused() {
    let server = Server::start();
    let id = server.client.submit(&with_seed(TINY, 1));
    let claimed = claim(&server).unwrap();
    let lease = (claimed.id, claimed.token);
    let wrong_sum = format!("files/curve.csv?sha256={}", sha256_hex(b"something else"));
    let answer = write(&server, lease, "PUT", &wrong_sum, FILE);
    assert!((400..500).contains(&answer.status), "{answer}");
    for name in [
        "..%2Fescape.csv",
        "%2Fetc%2Fescape.csv",
        "a%20b.csv",
        ".hidden",
    ] {
        let path = format!("files/{name}?sha256={}", sha256_hex(FILE));
        let answer = write(&server, lease, "PUT", &path, FILE);
        assert!((400..500).contains(&answer.status), "{name}: {answer}");
    }
    // the end names a file that was never uploaded
    let (_, _, end) = &every_route(&claimed)[5];
    let answer = write(&server, lease, "POST", "complete", end);
    assert!((400..500).contains(&answer.status), "{answer}");
    assert_eq!(server.client.job(id).status, JobStatus::Running);
}
