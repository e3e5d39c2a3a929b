//! A job that runs far past its estimate is paused by the limit that its person saw, with its checkpoint:
//! in time, in memory and in files, as a real worker measures them.
//!
//! Estimates are honest, so the server's record of one is made to lie before a worker comes. What no
//! estimate makes smaller (10 min, 500 MB, 100 MB) is really taken; only time is set forward instead.
use loadframe_api::{Estimate, JobOutcome, JobStatus, JobView, ReasonCode};
use loadframe_tests::{
    JobFiles, LONG, Server, Worker, edit_rows, is_sound, run_alone, until, with_seed,
};
use serde_json::{Value, json};
use uuid::Uuid;

/// Far less than any job takes.
const LIE: &str = r#"{"wall_s": 0.02, "memory_mb": 1.0, "disk_mb": 0.1, "calibrated": false}"#;

/// Spheres that fly apart without touching, so that all time goes into what is recorded of them.
fn flying(side: u32, steps: u32, record: &Value) -> Value {
    let mut bodies = Vec::new();
    for number in 0..side.pow(3) {
        let place = [number % side, number / side % side, number / side.pow(2)];
        let place = place.map(|along| 0.01 * f64::from(along));
        // no two alike: files do not get small by packing
        let velocity = [1, 2, 3].map(|way| 1e-3 * f64::from(way * number).sin());
        bodies.push(json!({
            "sphere": {"radius_m": 0.001}, "material": "stone",
            "position_m": place, "velocity_m_per_s": velocity,
        }));
    }
    json!({"kind": "granular_scene", "spec": {
        "version": 1,
        "materials": {"stone": {
            "density_kg_per_m3": 2500, "youngs_modulus_pa": 5e7, "friction_angle_rad": 0,
        }},
        "bodies": bodies, "time_step_s": 1e-5, "stages": [{"run": {"steps": steps}}], "record": record,
    }})
}

/// Submits a job whose estimate lies.
fn underrated(server: &Server, body: &Value) -> JobView {
    let id = server.client.submit(body);
    let honest = server.client.job(id).limits.expect("an estimate");
    edit_rows(
        &server.data(),
        &format!("UPDATE jobs SET estimate = '{LIE}' WHERE id = ?"),
        id,
    );
    let job = server.client.job(id);
    let told: Estimate = serde_json::from_str(LIE).unwrap();
    let limits = job.limits.expect("an estimate");
    assert_eq!(
        limits,
        loadframe_api::JobLimits::beyond(&told, job.overrun_factor)
    );
    assert!(
        honest.memory_mb >= limits.memory_mb && honest.disk_mb >= limits.disk_mb,
        "an honest estimate allows no less: {honest:?}"
    );
    job
}

/// Waits until the job is paused, and reads how much of `what` it had taken by its own word.
fn paused_for(server: &Server, id: Uuid, what: &str) -> (JobView, f64) {
    let job = until("the job is paused", || {
        let job = server.client.job(id);
        assert_ne!(job.status, JobStatus::Finished, "never stopped: {job:#?}");
        (job.status == JobStatus::Paused).then_some(job)
    });
    assert_eq!(job.reason_code, ReasonCode::BeyondEstimate, "{job:#?}");
    let taken = job.reason.strip_prefix("it has taken ");
    let (taken, rest) = taken.and_then(|rest| rest.split_once(' ')).unwrap();
    assert!(rest.starts_with(what), "{}", job.reason);
    for part in [
        "estimate is 0.02 s",
        "overrun_factor 10",
        "raise overrun_factor",
        "resume",
    ] {
        assert!(rest.contains(part), "{part}: {}", job.reason);
    }
    let taken = taken.parse().unwrap();
    (job, taken)
}

/// Raises the factor and lets the job go on.
fn raise(server: &Server, id: Uuid) {
    let path = format!("/v1/jobs/{id}");
    let edit = json!({"overrun_factor": 1e6}).to_string();
    let json = [("content-type", "application/json")];
    let answer = server
        .client
        .send("PATCH", &path, &json, edit.as_bytes())
        .unwrap();
    assert_eq!(answer.status, 200, "{answer}");
    let answer = server.client.ask(id, "resume");
    assert!(matches!(answer.status, 200 | 202), "{answer}");
}

#[test]
fn a_job_beyond_its_time_is_paused_and_goes_on_to_the_same_bytes() {
    let server = Server::start();
    let body = with_seed(LONG, 1);
    let alone = run_alone(&body, 1, &server.folder().join("alone"));
    let id = underrated(&server, &body).id;
    let _worker = Worker::start(&server, "worker");
    until("it computes", || {
        (server.client.job(id).progress > 0.1).then_some(())
    });
    let answer = server.client.ask(id, "pause");
    assert!(matches!(answer.status, 200 | 202), "{answer}");
    until("it is paused", || {
        (server.client.job(id).status == JobStatus::Paused).then_some(())
    });
    // as if its checkpoint were the work of 11 min; 10 are free
    let set_forward =
        "UPDATE checkpoints SET wall_s = 660 WHERE job = (SELECT seq FROM jobs WHERE id = ?)";
    edit_rows(&server.data(), set_forward, id);
    server.client.ask(id, "resume");
    let (job, taken) = paused_for(&server, id, "s of wall time, where 600 is its limit");
    assert!((660.0..720.0).contains(&taken), "{}", job.reason);
    raise(&server, id);
    let job = until("the job is finished", || {
        let job = server.client.job(id);
        (job.status == JobStatus::Finished).then_some(job)
    });
    is_sound(&job);
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
    assert_eq!(JobFiles::on_server(&server.client, id), alone);
}

#[test]
fn a_job_beyond_its_files_is_paused_with_its_checkpoint() {
    let server = Server::start();
    let record = json!({"every_steps": 1000, "snapshot_every_steps": 1, "bodies": []});
    let job = underrated(&server, &flying(20, 4000, &record));
    let _worker = Worker::start(&server, "worker");
    let (job, taken) = paused_for(&server, job.id, "MB of files, where 100 is its limit");
    // it is told in three digits: 100.4 is 100
    assert!(taken >= 100.0, "{}", job.reason);
    goes_on_from_its_checkpoint(&server, &job);
}

#[test]
fn a_job_beyond_its_memory_is_paused_with_its_checkpoint() {
    let server = Server::start();
    // some 75 kB of rows are kept until the end; it takes seconds, so that heartbeats see them grow
    let record = json!({"every_steps": 20});
    let job = underrated(&server, &flying(9, 260_000, &record));
    let _worker = Worker::start(&server, "worker");
    let (job, taken) = paused_for(&server, job.id, "MB of memory, where 500 is its limit");
    // told in three digits as well
    assert!(taken >= 500.0, "{}", job.reason);
    goes_on_from_its_checkpoint(&server, &job);
}

/// Resumed with a higher factor it begins where it was, not anew.
fn goes_on_from_its_checkpoint(server: &Server, job: &JobView) {
    assert!(job.progress > 0.0, "{job:#?}");
    raise(server, job.id);
    let lines = until("it says where it goes on from", || {
        let log = server.client.get(&format!("/v1/jobs/{}/log", job.id));
        let log = String::from_utf8_lossy(&log.body).into_owned();
        log.contains("going on from the checkpoint").then_some(log)
    });
    assert!(!lines.contains("starting from the beginning"), "{lines}");
    let answer = server.client.ask(job.id, "cancel");
    assert!(matches!(answer.status, 200 | 202), "{answer}");
}
