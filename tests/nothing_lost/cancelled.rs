//! Cancel works in every state, and frees a worker within the time that is promised.
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, JobView, ReasonCode};
use loadframe_tests::{SLOW, Server, TINY, Worker, is_sound, until, with_seed};
use nix::sys::signal::Signal;
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use uuid::Uuid;

/// The promise: a cancelled job frees its worker within this time.
const FREE_WITHIN: Duration = Duration::from_secs(2);

fn cancel(server: &Server, id: Uuid) {
    let answer = server.client.ask(id, "cancel");
    assert!(matches!(answer.status, 200 | 202), "{answer}");
}

fn ends_cancelled(server: &Server, id: Uuid) -> JobView {
    let job = until("the job is cancelled", || {
        let job = server.client.job(id);
        (job.status == JobStatus::Finished).then_some(job)
    });
    assert_eq!(job.outcome, Some(JobOutcome::Cancelled), "{job:#?}");
    assert_eq!(job.reason_code, ReasonCode::CancelledByUser, "{job:#?}");
    is_sound(&job);
    job
}

fn is_running(server: &Server, id: Uuid) {
    until("the job computes", || {
        let job = server.client.job(id);
        (job.status == JobStatus::Running && job.progress > 0.0).then_some(())
    });
}

#[test]
fn while_queued_or_paused_it_ends_at_once() {
    let server = Server::start();
    let id = server.client.submit(&with_seed(SLOW, 1));
    cancel(&server, id);
    assert!(ends_cancelled(&server, id).attempts.is_empty());

    let id = server.client.submit(&with_seed(SLOW, 1));
    assert_eq!(server.client.ask(id, "pause").status, 200);
    assert_eq!(server.client.job(id).status, JobStatus::Paused);
    cancel(&server, id);
    ends_cancelled(&server, id);

    // paused with a checkpoint
    let _worker = Worker::start(&server, "worker");
    let id = server.client.submit(&with_seed(SLOW, 1));
    is_running(&server, id);
    server.client.ask(id, "pause");
    until("the job is paused", || {
        (server.client.job(id).status == JobStatus::Paused).then_some(())
    });
    cancel(&server, id);
    ends_cancelled(&server, id);
}

#[test]
fn while_running_it_frees_the_worker_in_time() {
    // so long a job is only taken where the limits allow it
    let server = Server::start_with(&["--lease-s", "2", "--limit-wall-s", "1e11"]);
    let worker = Worker::start(&server, "worker");
    let slow_steps = with_seed(SLOW, 1);
    // one equilibrium alone takes longer than the promise
    let mut long_equilibrium = with_seed(SLOW, 1);
    let spec = &mut long_equilibrium["spec"];
    spec["fabric"]["lattice"]["points_per_row"] = json!(99);
    spec["fabric"]["lattice"]["rows"] = json!(201);
    spec["test"]["strain_step"] = json!(0.2);
    spec["accuracy"] =
        json!({"solver": "sequential", "force_accuracy": 1e9, "iteration_limit": 1_000_000});
    for body in [&slow_steps, &long_equilibrium] {
        let id = server.client.submit(body);
        until("the worker has the job", || worker.job(&server.client));
        let next = server.client.submit(&with_seed(TINY, 1));
        let begin = Instant::now();
        cancel(&server, id);
        until("the worker is on the next job", || {
            let job = server.client.job(next);
            (job.attempt > 0).then_some(())
        });
        let freed_after = begin.elapsed();
        assert!(
            freed_after < FREE_WITHIN,
            "the worker was busy for {freed_after:?}"
        );
        let job = ends_cancelled(&server, id);
        assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Cancelled));
        until("the next job is done", || {
            (server.client.job(next).status == JobStatus::Finished).then_some(())
        });
    }
}

/// What factorises a large system of equations hears nothing meanwhile.
#[test]
fn while_the_engine_is_deaf_it_ends_in_time_and_the_worker_goes_on() {
    let server = Server::start_with(&["--lease-s", "2", "--limit-wall-s", "1e11"]);
    let _worker = Worker::start(&server, "worker");
    let text = include_str!("../../api/examples/composite_bending.json");
    let mut body: Value = serde_json::from_str(text).expect("JSON");
    body["spec"]["grid"]["cells"] = json!([800, 800]);
    // while it is built, and while it is factorised
    for wait_s in [0.3, 2.0] {
        let id = server.client.submit(&body);
        until("the worker has the job", || {
            (server.client.job(id).status == JobStatus::Running).then_some(())
        });
        std::thread::sleep(Duration::from_secs_f64(wait_s));
        let begin = Instant::now();
        cancel(&server, id);
        let job = ends_cancelled(&server, id);
        let ended_after = begin.elapsed();
        assert!(ended_after < FREE_WITHIN, "{ended_after:?}: {job:#?}");
        assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Cancelled));
    }
    let next = server.client.submit(&with_seed(TINY, 1));
    until("the next job is done", || {
        (server.client.job(next).outcome == Some(JobOutcome::Succeeded)).then_some(())
    });
}

#[test]
fn while_a_pause_is_on_its_way_cancel_wins() {
    let server = Server::start();
    let worker = Worker::start(&server, "worker");
    let id = server.client.submit(&with_seed(SLOW, 1));
    is_running(&server, id);
    worker.process.signal(Signal::SIGSTOP);
    server.client.ask(id, "pause");
    assert_eq!(
        server.client.job(id).reason_code,
        ReasonCode::PauseRequested
    );
    cancel(&server, id);
    worker.process.signal(Signal::SIGCONT);
    ends_cancelled(&server, id);
}

#[test]
fn while_the_worker_is_silent_it_ends_with_the_lease() {
    let server = Server::start();
    let mut worker = Worker::start(&server, "worker");
    let id = server.client.submit(&with_seed(SLOW, 1));
    is_running(&server, id);
    worker.process.kill();
    cancel(&server, id);
    assert_eq!(
        server.client.job(id).reason_code,
        ReasonCode::CancelRequested
    );
    let job = ends_cancelled(&server, id);
    assert_eq!(
        job.attempts[0].end_reason,
        Some(AttemptEnd::Lost),
        "{job:#?}"
    );
}

#[test]
fn after_the_end_it_changes_nothing() {
    let server = Server::start();
    let _worker = Worker::start(&server, "worker");
    let id = server.client.submit(&with_seed(TINY, 1));
    let job = until("the job is done", || {
        let job = server.client.job(id);
        (job.status == JobStatus::Finished).then_some(job)
    });
    let answer = server.client.ask(id, "cancel");
    assert_eq!(answer.status, 409, "{answer}");
    assert_eq!(answer.content_type, "application/problem+json");
    assert_eq!(server.client.job(id), job);
}
