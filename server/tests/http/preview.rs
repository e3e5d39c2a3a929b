//! Specimens drawn before their jobs are submitted.
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use loadframe_api::{JobKind, JobSpec, Preview};
use loadframe_run::Uninterrupted;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use crate::people::group::Group;
use crate::support::{Lab, example};

fn draw(spec: &JobSpec, _given_up: &CancellationToken) -> Result<Option<Preview>, String> {
    match loadframe_run::preview(spec, &Uninterrupted) {
        Ok(preview) => Ok(Some(preview)),
        Err(halt) => Err(format!("{halt:?}")),
    }
}

/// A generator that does not come to its end, and how many are at work.
fn draw_for_ever(_spec: &JobSpec, given_up: &CancellationToken) -> Result<Option<Preview>, String> {
    AT_WORK.fetch_add(1, Ordering::SeqCst);
    while !given_up.is_cancelled() {
        std::thread::sleep(Duration::from_millis(5));
    }
    AT_WORK.fetch_sub(1, Ordering::SeqCst);
    Ok(None)
}

static AT_WORK: AtomicU32 = AtomicU32::new(0);

async fn until_at_work(count: u32) {
    while AT_WORK.load(Ordering::SeqCst) != count {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

#[tokio::test]
async fn a_specimen_that_takes_too_long_is_answered_with_a_sentence_and_its_thread_ends() {
    let lab = Lab::with(|config| {
        config.preview = Some(draw_for_ever);
        config.preview_time = Duration::from_millis(200);
    })
    .await;
    let problem = lab
        .post(PATH, example())
        .await
        .problem(422, "invalid-request");
    assert_eq!(
        problem["violations"][0]["code"], "too_long_to_draw",
        "{problem}"
    );
    let detail = problem["detail"].as_str().expect("a sentence");
    assert!(detail.contains("within 0.2 s"), "{detail}");
    until_at_work(0).await;
    // and that of a client who has left before
    let lab = Lab::with(|config| config.preview = Some(draw_for_ever)).await;
    let asked = tokio::time::timeout(Duration::from_millis(300), lab.post(PATH, example()));
    assert!(asked.await.is_err());
    until_at_work(0).await;
}

async fn lab() -> Lab {
    Lab::with(|config| config.preview = Some(draw)).await
}

const PATH: &str = "/v1/jobs/preview";

#[tokio::test]
async fn the_first_example_of_every_kind_is_drawn_and_nothing_is_stored() {
    let lab = lab().await;
    for kind in JobKind::ALL {
        let answer = lab.post(PATH, kind.examples()[0].body).await;
        assert_eq!(answer.status, 200, "{kind} {answer:?}");
        let preview = answer.json();
        let shows = preview["shows"].as_str().expect("a sentence");
        assert!(shows.ends_with('.'), "{kind}: {shows}");
        let poured = kind.name().starts_with("ballast_");
        assert_eq!(shows.contains("Pouring"), poured, "{kind}: {shows}");
        let files = preview["files"].as_array().expect("files");
        assert!(!files.is_empty(), "{kind}");
        for file in files {
            let content = file["content"].as_str().expect("base64");
            let content = BASE64_STANDARD.decode(content).expect("base64");
            assert!(content.starts_with(b"<?xml"), "{kind} {}", file["name"]);
        }
    }
    let jobs = lab.get("/v1/jobs").await.json();
    assert_eq!(jobs["items"], json!([]));
}

#[tokio::test]
async fn what_is_no_job_or_too_large_is_refused_with_the_number() {
    let lab = lab().await;
    let mut job: Value = serde_json::from_str(example()).expect("JSON");
    job["spec"]["fabric"]["lattice"]["rows"] = json!(-1);
    let problem = lab.post(PATH, &job.to_string()).await;
    let problem = problem.problem(422, "invalid-job");
    assert_eq!(
        problem["violations"][0]["pointer"],
        "/spec/fabric/lattice/rows"
    );
    job["spec"]["fabric"]["lattice"]["rows"] = json!(1001);
    job["spec"]["fabric"]["lattice"]["points_per_row"] = json!(1000);
    let problem = lab.post(PATH, &job.to_string()).await;
    let problem = problem.problem(422, "invalid-request");
    let violation = &problem["violations"][0];
    assert_eq!(violation["code"], "too_large_to_draw", "{problem}");
    assert!(violation["value"].as_f64() > Some(2.9e6), "{problem}");
    let allowed = violation["allowed"].as_str().expect("words");
    assert!(allowed.contains("200000"), "{allowed}");
    lab.post(PATH, "{").await.problem(400, "not-json");
}

#[tokio::test]
async fn who_may_not_submit_is_shown_nothing_and_a_server_without_an_engine_says_so() {
    let group = Group::of(lab().await).await;
    let body = example();
    let answer = group.send(&group.gina, "POST", PATH, body).await;
    answer.problem(403, "not-allowed");
    let drawn = group.send(&group.anna, "POST", PATH, body).await;
    assert_eq!(drawn.status, 200, "{drawn:?}");
    let without = Lab::open().await.post(PATH, body).await;
    without.problem(409, "conflict");
}
