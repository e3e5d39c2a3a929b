//! Bad input over the real server: every offending spec in `data/bad` is refused with the
//! violations written beside it, nothing is stored, and memory stays flat.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "tests stop at what is unexpected and speak to people"
)]
use loadframe_api::{JobKind, Problem, Violation};
use loadframe_tests::{Answer, Server, TINY, rows, with_seed};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::Path;

/// What stands in `NAME.expected.json`: only the fields that matter for this mistake.
#[derive(Deserialize)]
struct Expected {
    status: u16,
    violations: Vec<serde_json::Map<String, serde_json::Value>>,
}

struct BadSpec {
    name: String,
    body: Vec<u8>,
    expected: Expected,
}

fn bad_specs() -> Vec<BadSpec> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/data/bad"));
    // the names of all kinds as a violation lists them, within a JSON string
    let kinds = JobKind::ALL.iter().map(|kind| format!("\\\"{kind}\\\""));
    let kinds = kinds.collect::<Vec<_>>().join(" or ");
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.ends_with(".expected.json") {
            continue;
        }
        let expected = std::fs::read_to_string(path.with_extension("expected.json"))
            .unwrap_or_else(|error| panic!("what {name} should give: {error}"))
            .replace("{{kinds}}", &kinds);
        all.push(BadSpec {
            body: std::fs::read(&path).unwrap(),
            expected: serde_json::from_str(&expected)
                .unwrap_or_else(|error| panic!("{name}: {error}")),
            name,
        });
    }
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

fn submit(server: &Server, path: &str, media_type: &str, body: &[u8]) -> Answer {
    let headers = [("content-type", media_type)];
    server.client.send("POST", path, &headers, body).unwrap()
}

fn problem(answer: &Answer) -> Problem {
    assert_eq!(answer.content_type, "application/problem+json", "{answer}");
    let problem: Problem =
        serde_json::from_slice(&answer.body).unwrap_or_else(|error| panic!("{error}: {answer}"));
    assert_eq!(problem.status, answer.status, "{answer}");
    problem
}

/// Holds the violations of an answer against the expected ones: the same places and codes, and in
/// each the expected value, range and unit.
fn check(name: &str, found: &[Violation], expected: &Expected) {
    let found: Vec<serde_json::Value> = found
        .iter()
        .map(|v| serde_json::to_value(v).unwrap())
        .collect();
    let places = |all: &mut dyn Iterator<Item = (String, String)>| all.collect::<BTreeSet<_>>();
    let place = |pointer: &serde_json::Value, code: &serde_json::Value| {
        (
            pointer.as_str().unwrap().to_owned(),
            code.as_str().unwrap().to_owned(),
        )
    };
    assert_eq!(
        places(&mut found.iter().map(|v| place(&v["pointer"], &v["code"]))),
        places(
            &mut expected
                .violations
                .iter()
                .map(|v| place(&v["pointer"], &v["code"]))
        ),
        "{name}: {found:#?}"
    );
    for violation in &expected.violations {
        let fits = |found: &&serde_json::Value| violation.iter().all(|(k, v)| found[k] == *v);
        assert!(
            found.iter().any(|found| fits(&found)),
            "{name}: {violation:#?} is not among {found:#?}"
        );
    }
}

#[test]
fn every_bad_spec_is_refused_with_its_violations_and_leaves_no_trace() {
    let server = Server::start();
    let before = rows(&server.data());
    let bad_specs = bad_specs();
    assert!(
        bad_specs.len() >= 70,
        "the folder of bad specs is incomplete"
    );
    for bad in &bad_specs {
        for path in ["/v1/jobs", "/v1/jobs?dry_run=true"] {
            let answer = submit(&server, path, "application/json", &bad.body);
            assert_eq!(answer.status, bad.expected.status, "{}: {answer}", bad.name);
            check(&bad.name, &problem(&answer).violations, &bad.expected);
        }
    }
    assert!(server.client.jobs("").is_empty());
    assert_eq!(rows(&server.data()), before);
    let good = submit(
        &server,
        "/v1/jobs",
        "application/json",
        with_seed(TINY, 1).to_string().as_bytes(),
    );
    assert_eq!(good.status, 201, "the server still takes good jobs: {good}");
}

#[test]
fn bodies_that_are_no_submission_are_refused_as_problems() {
    let server = Server::start();
    let body = with_seed(TINY, 1).to_string();
    let wrong_media_type = submit(&server, "/v1/jobs", "text/plain", body.as_bytes());
    assert_eq!(problem(&wrong_media_type).status, 415);
    let brackets = submit(
        &server,
        "/v1/jobs",
        "application/json",
        megabyte_of_brackets().as_bytes(),
    );
    assert_eq!(problem(&brackets).status, 400);
    assert_eq!(problem(&server.client.get("/v1/jobs/no-id")).status, 400);
    assert_eq!(problem(&server.client.get("/v1/no-such-route")).status, 404);
    let wrong_method = server.client.send("DELETE", "/v1/kinds", &[], b"").unwrap();
    assert_eq!(problem(&wrong_method).status, 405);
    assert!(server.client.jobs("").is_empty());
}

fn megabyte_of_brackets() -> String {
    "[".repeat(1 << 20)
}

/// Rounds of all bad specs and one megabyte of brackets that memory is watched over.
const ROUNDS: u64 = 50;
/// Kept memory that would be a leak: a quarter of the megabyte that each round sends in brackets,
/// or three kilobytes for each of the small bodies. An allocator's own growth ends well below.
const LEAK_BYTES: u64 = ROUNDS * (1 << 20) / 4;

#[test]
fn memory_stays_flat_over_thousands_of_bad_specs() {
    let server = Server::start();
    let bad_specs = bad_specs();
    let brackets = megabyte_of_brackets();
    let round = || {
        for bad in &bad_specs {
            submit(&server, "/v1/jobs", "application/json", &bad.body);
        }
        submit(&server, "/v1/jobs", "application/json", brackets.as_bytes());
    };
    // the first rounds fill the server's caches and the allocator's pools
    (0..ROUNDS / 10).for_each(|_| round());
    let before = server.process.resident_bytes();
    (0..ROUNDS).for_each(|_| round());
    let after = server.process.resident_bytes();
    eprintln!(
        "{} requests: {before} → {after} bytes",
        ROUNDS * (bad_specs.len() as u64 + 1)
    );
    assert!(
        after < before + LEAK_BYTES,
        "{before} → {after} bytes resident"
    );
}
