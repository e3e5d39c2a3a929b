//! Machines at fault, losses that are forgiven, and checkpoints that cannot be used.
use std::time::Duration;

use loadframe_api::worker::{
    ClaimRequest, FailCode, FailRequest, FaultCode, FaultRequest, Lease, ProgressReport,
};
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, ReasonCode};
use loadframe_server::store::{Store, StoreOptions, UserAction};

use crate::lab::{LONG, Lab, NONE, is_lost, is_missing, key, options, worker};

/// A lab in which a machine at fault pauses so long.
async fn lab_with_pause(pause: Duration) -> Lab {
    let folder = tempfile::tempdir().unwrap();
    let options = StoreOptions {
        fault_pause: pause,
        ..options(&folder, LONG)
    };
    let store = Store::open(options).await.unwrap();
    Lab { store, folder }
}

/// A worker process just started on a machine.
fn on(host: &str) -> ClaimRequest {
    ClaimRequest {
        host: host.to_owned(),
        ..worker("w")
    }
}

fn full_disk() -> FaultRequest {
    FaultRequest {
        code: FaultCode::Disk,
        reason: "the results could not be kept: no space left on device".to_owned(),
    }
}

async fn claimed(lab: &Lab, worker: &ClaimRequest) -> Lease {
    lab.claim(worker).await.unwrap().expect("a job")
}

#[tokio::test]
async fn a_fault_sends_the_job_to_another_machine_at_no_charge_and_sets_this_one_aside() {
    let lab = lab_with_pause(LONG).await;
    let id = lab.submit().await;
    let sick = on("sick");
    let lease = claimed(&lab, &sick).await;
    lab.fault(key(&lease), &full_disk()).await.unwrap();
    let job = lab.view(id).await;
    assert_eq!(
        (job.status, job.reason_code),
        (JobStatus::Queued, ReasonCode::WorkerFault)
    );
    assert!(
        job.reason.contains("w (sick)") && job.reason.contains("no space left"),
        "{}",
        job.reason
    );
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Faulted));
    let log = lab.log(id, 0).await.unwrap();
    assert!(log[0].message.contains("no space left"), "{log:?}");

    assert!(lab.claim(&sick).await.unwrap().is_none(), "it is set aside");
    let workers = lab.workers().await.unwrap();
    let aside = workers[0].set_aside.as_ref().expect("it says so");
    assert_eq!((aside.faults, aside.code), (1, FaultCode::Disk));
    assert_eq!(lab.counts().await.unwrap().workers_set_aside, 1);

    // the message may be repeated, and no other follows it
    lab.fault(key(&lease), &full_disk()).await.unwrap();
    assert_eq!(
        lab.workers().await.unwrap()[0]
            .set_aside
            .as_ref()
            .unwrap()
            .faults,
        1
    );
    assert!(is_lost(lab.heartbeat(key(&lease)).await));

    let healthy = on("healthy");
    let lease = claimed(&lab, &healthy).await;
    lab.finish(&lease).await;
    assert_eq!(lab.view(id).await.outcome, Some(JobOutcome::Succeeded));
}

#[tokio::test]
async fn forty_jobs_pass_a_faulty_machine_unharmed() {
    let lab = lab_with_pause(Duration::from_millis(10)).await;
    for _ in 0..40 {
        lab.submit().await;
    }
    let (sick, healthy) = (on("sick"), on("healthy"));
    let mut faults = 0;
    while lab.counts().await.unwrap().succeeded < 40 {
        if let Some(lease) = lab.claim(&sick).await.unwrap() {
            faults += 1;
            lab.fault(key(&lease), &full_disk()).await.unwrap();
        }
        if let Some(lease) = lab.claim(&healthy).await.unwrap() {
            lab.finish(&lease).await;
        }
    }
    let counts = lab.counts().await.unwrap();
    assert_eq!((counts.succeeded, counts.failed), (40, 0));
    assert!(faults >= 1);
}

#[tokio::test]
async fn a_job_that_three_machines_could_not_carry_out_has_failed_and_says_so() {
    let lab = lab_with_pause(LONG).await;
    let id = lab.submit().await;
    for host in ["a", "b", "c"] {
        let lease = claimed(&lab, &on(host)).await;
        let fault = FaultRequest {
            reason: format!("no room on {host}"),
            ..full_disk()
        };
        lab.fault(key(&lease), &fault).await.unwrap();
    }
    let job = lab.view(id).await;
    assert_eq!(job.outcome, Some(JobOutcome::Failed));
    assert_eq!(job.reason_code, ReasonCode::WorkerError);
    for part in ["3 machines", "a: no room on a", "c: no room on c"] {
        assert!(job.reason.contains(part), "{part}: {}", job.reason);
    }
    // tried again it counts anew
    lab.request(id, UserAction::Retry).await.unwrap();
    let lease = claimed(&lab, &on("d")).await;
    lab.fault(key(&lease), &full_disk()).await.unwrap();
    assert_eq!(lab.view(id).await.status, JobStatus::Queued);
}

#[tokio::test]
async fn one_machine_counts_once_until_it_has_carried_out_something_else() {
    let lab = lab_with_pause(Duration::ZERO).await;
    let id = lab.submit().await;
    let only = on("only");
    for _ in 0..10 {
        let lease = claimed(&lab, &only).await;
        assert_eq!(lease.job_id, id);
        lab.fault(key(&lease), &full_disk()).await.unwrap();
    }
    assert_eq!(lab.view(id).await.status, JobStatus::Queued);
    for _ in 0..2 {
        // others come first on a machine that could not carry it out
        let other = lab.submit().await;
        let lease = claimed(&lab, &only).await;
        assert_eq!(lease.job_id, other);
        lab.finish(&lease).await;
        // the moment of the work must lie before that of the next fault
        tokio::time::sleep(Duration::from_millis(2)).await;
        let lease = claimed(&lab, &only).await;
        assert_eq!(lease.job_id, id);
        lab.fault(key(&lease), &full_disk()).await.unwrap();
    }
    assert_eq!(lab.view(id).await.outcome, Some(JobOutcome::Failed));
}

#[tokio::test]
async fn pauses_grow_with_every_fault_and_end_with_work_or_a_fresh_start() {
    let lab = lab_with_pause(Duration::from_secs(10)).await;
    lab.submit().await;
    for (fault, pause_s) in [(1, 10), (2, 20), (3, 40)] {
        let sick = on("sick");
        // a process that was started again is tried at once
        let lease = claimed(&lab, &sick).await;
        lab.fault(key(&lease), &full_disk()).await.unwrap();
        assert!(lab.claim(&sick).await.unwrap().is_none());
        let workers = lab.workers().await.unwrap();
        let aside = workers.iter().find(|worker| worker.id == sick.worker_id);
        let aside = aside.unwrap().set_aside.clone().unwrap();
        let left = aside.until.as_millis() - loadframe_api::Timestamp::now().as_millis();
        assert_eq!(aside.faults, fault);
        assert!(
            (1000 * pause_s - 5000..=1000 * pause_s).contains(&left),
            "{left} ms left after fault {fault}"
        );
    }
    let sick = on("sick");
    let lease = claimed(&lab, &sick).await;
    lab.finish(&lease).await;
    lab.submit().await;
    let lease = claimed(&lab, &sick).await;
    lab.fault(key(&lease), &full_disk()).await.unwrap();
    let workers = lab.workers().await.unwrap();
    let aside = workers.iter().find(|worker| worker.id == sick.worker_id);
    assert_eq!(aside.unwrap().set_aside.clone().unwrap().faults, 1);
}

#[tokio::test]
async fn an_older_workers_own_error_is_taken_as_a_fault() {
    let lab = lab_with_pause(LONG).await;
    let id = lab.submit().await;
    let old = on("old");
    let lease = claimed(&lab, &old).await;
    let failure = FailRequest {
        code: FailCode::WorkerError,
        reason: "this worker has no scratch folder".to_owned(),
    };
    lab.fail(key(&lease), &failure).await.unwrap();
    lab.fail(key(&lease), &failure).await.unwrap();
    assert_eq!(lab.view(id).await.status, JobStatus::Queued);
    assert!(lab.claim(&old).await.unwrap().is_none());
}

#[tokio::test]
async fn a_user_who_asked_to_pause_or_cancel_gets_that_from_a_machine_at_fault() {
    let lab = lab_with_pause(LONG).await;
    for (action, status) in [
        (UserAction::Pause, JobStatus::Paused),
        (UserAction::Cancel, JobStatus::Finished),
    ] {
        let id = lab.submit().await;
        let lease = claimed(&lab, &on(&format!("{action:?}"))).await;
        lab.request(id, action).await.unwrap();
        lab.fault(key(&lease), &full_disk()).await.unwrap();
        assert_eq!(lab.view(id).await.status, status);
    }
}

#[tokio::test]
async fn leases_that_were_never_used_cost_nothing() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    for _ in 0..5 {
        lab.lease().await;
        assert_eq!(lab.sweep().await.unwrap(), 1);
        let job = lab.view(id).await;
        assert_eq!(job.status, JobStatus::Queued);
        assert!(job.reason.contains("never heard of"), "{}", job.reason);
    }
}

#[tokio::test]
async fn a_newer_checkpoint_forgives_the_losses_before_it() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    // every attempt comes further before its worker dies
    for attempt in 1..=8 {
        let lease = lab.lease().await;
        let wall_s = f64::from(attempt);
        lab.checkpoint_with(&lease, format!("{attempt}").as_bytes(), wall_s)
            .await;
        lab.sweep().await.unwrap();
        assert_eq!(lab.view(id).await.status, JobStatus::Queued, "{attempt}");
    }
    // from here on none does: the one after the last that did was the first loss
    for loss in 2..=3 {
        let lease = lab.lease().await;
        lab.checkpoint_with(&lease, b"no further", 8.0).await;
        lab.sweep().await.unwrap();
        assert_eq!(lab.view(id).await.status == JobStatus::Finished, loss == 3);
    }
    assert_eq!(lab.view(id).await.outcome, Some(JobOutcome::Quarantined));
    // what it had is there for whoever asks again
    lab.request(id, UserAction::Retry).await.unwrap();
    let kept = lab.lease().await.checkpoint.expect("a checkpoint");
    assert_eq!(kept.wall_s.to_bits(), 8.0_f64.to_bits());
}

/// Changes the bytes of the newest checkpoint.
async fn spoil_newest(lab: &Lab, lease: &Lease) {
    let (_, path) = lab.checkpoint(key(lease), None).await.unwrap();
    std::fs::write(path, b"something else").unwrap();
}

#[tokio::test]
async fn a_broken_checkpoint_leaves_the_one_before_it_and_then_the_start() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let first = lab.put(&lease, "first.vtp", b"first").await;
    lab.checkpoint_with(&lease, b"state 1", 1.0).await;
    lab.put(&lease, "second.vtp", b"second").await;
    lab.checkpoint_with(&lease, b"state 2", 2.0).await;
    spoil_newest(&lab, &lease).await;
    let release = loadframe_api::worker::ReleaseReason::Shutdown;
    lab.release(key(&lease), release).await.unwrap();

    let lease = lab.lease().await;
    let (info, path) = lab.checkpoint(key(&lease), None).await.unwrap();
    assert_eq!(std::fs::read(path).unwrap(), b"state 1");
    assert_eq!(info.files, [first]);
    let log = lab.log(id, 0).await.unwrap();
    assert!(
        log[0]
            .message
            .ends_with("the job goes on from the one before"),
        "{log:?}"
    );
    // the files that came with the broken one are not this attempt's any more
    let mut result = lab.result(&lease).await;
    result.files.push(loadframe_api::FileEntry {
        name: "second.vtp".to_owned(),
        bytes: 6,
        sha256: loadframe_api::sha256_hex(b"second"),
    });
    assert!(lab.complete(key(&lease), &result).await.is_err());

    spoil_newest(&lab, &lease).await;
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(log[1].message.ends_with("the job begins anew"), "{log:?}");
    lab.finish(&lease).await;
}

#[tokio::test]
async fn a_checkpoint_whose_files_are_gone_cannot_be_used() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let file = lab.put(&lease, "snapshot.vtp", b"a picture").await;
    lab.checkpoint_with(&lease, b"state", 1.0).await;
    let blob = crate::lab::stored(lab.folder.path())
        .into_iter()
        .find(|path| path.ends_with(&file.sha256));
    std::fs::remove_file(blob.unwrap()).unwrap();
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(
        log[0]
            .message
            .starts_with("snapshot.vtp of the checkpoint is missing"),
        "{log:?}"
    );
}

#[tokio::test]
async fn a_worker_that_cannot_use_a_checkpoint_gets_the_one_before_and_none_is_lost() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    lab.checkpoint_with(&lease, b"state 1", 1.0).await;
    lab.checkpoint_with(&lease, b"state 2", 2.0).await;
    lab.checkpoint_with(&lease, b"state 3", 3.0).await;
    let bytes = async |before: Option<&[u8]>| {
        let before = before.map(loadframe_api::sha256_hex);
        let found = lab.checkpoint(key(&lease), before.as_deref()).await;
        found.map(|(_, path)| std::fs::read(path).unwrap())
    };
    assert_eq!(bytes(None).await.unwrap(), b"state 3");
    assert_eq!(bytes(Some(b"state 3")).await.unwrap(), b"state 2");
    assert!(is_missing(bytes(Some(b"state 2")).await), "two are kept");
    assert_eq!(bytes(None).await.unwrap(), b"state 3");
}

#[tokio::test]
async fn a_worker_goes_on_only_from_what_its_own_build_has_made() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let of_build = |engine: &str| ClaimRequest {
        engine_version: engine.to_owned(),
        ..worker(engine)
    };
    let release = loadframe_api::worker::ReleaseReason::Shutdown;
    let lease = claimed(&lab, &of_build("0.1.0+aaaa")).await;
    lab.checkpoint_with(&lease, b"of a", 1.0).await;
    lab.release(key(&lease), release).await.unwrap();
    let lease = claimed(&lab, &of_build("0.1.0+bbbb")).await;
    assert!(lease.checkpoint.is_none());
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(
        log[0].message.contains("0.1.0+aaaa") && log[0].message.contains("0.1.0+bbbb"),
        "{log:?}"
    );
    lab.release(key(&lease), release).await.unwrap();
    let lease = claimed(&lab, &of_build("0.1.0+aaaa")).await;
    assert!(lease.checkpoint.is_some(), "its own is still there");
    let engines: Vec<String> = lab
        .view(id)
        .await
        .attempts
        .into_iter()
        .map(|attempt| attempt.engine)
        .collect();
    assert_eq!(engines, ["0.1.0+aaaa", "0.1.0+bbbb", "0.1.0+aaaa"]);
}

#[tokio::test]
async fn a_report_that_is_repeated_brings_its_log_lines_once() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let report = async |from: Option<u64>, lines: &[&str]| {
        let report = ProgressReport {
            log: lines.iter().map(|line| (*line).to_owned()).collect(),
            log_from: from,
            ..ProgressReport::default()
        };
        lab.report(key(&lease), &report).await.unwrap();
    };
    report(Some(0), &["a"]).await;
    report(Some(0), &["a"]).await;
    // what is said twice stands twice
    report(Some(1), &["a"]).await;
    // the answer was lost, and more has come since
    report(Some(1), &["a", "b"]).await;
    report(Some(0), &["a", "a", "b"]).await;
    // earlier versions do not count
    report(None, &["c"]).await;
    report(None, &["c"]).await;
    let lines: Vec<String> = lab
        .log(id, 0)
        .await
        .unwrap()
        .into_iter()
        .map(|line| line.message)
        .collect();
    assert_eq!(lines, ["a", "a", "b", "c", "c"]);
}

#[tokio::test]
async fn a_job_beyond_its_estimate_is_paused_with_its_checkpoint_and_told_how_to_go_on() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let limits = lab.view(id).await.limits.expect("an estimate");
    assert_eq!(
        lease.limits,
        Some(limits),
        "the worker is told what people see"
    );
    lab.checkpoint_with(&lease, b"state", 700.0).await;
    let used = loadframe_api::JobLimits {
        wall_s: 700.0,
        ..limits
    };
    let excess = limits.exceeded_by(&used).expect("600 s are free");
    lab.exceed_estimate(key(&lease), &excess).await.unwrap();
    lab.exceed_estimate(key(&lease), &excess).await.unwrap();
    let job = lab.view(id).await;
    assert_eq!(
        (job.status, job.reason_code),
        (JobStatus::Paused, ReasonCode::BeyondEstimate)
    );
    for part in [
        "700 s of wall time",
        "600 is its limit",
        "raise overrun_factor",
        "resume",
    ] {
        assert!(job.reason.contains(part), "{part}: {}", job.reason);
    }
    let edit = loadframe_server::store::JobEdit {
        overrun_factor: Some(1e6),
        ..Default::default()
    };
    lab.edit(id, edit).await.unwrap();
    lab.request(id, UserAction::Resume).await.unwrap();
    let lease = lab.lease().await;
    assert!(lease.checkpoint.is_some());
    let raised = lease.limits.expect("an estimate").wall_s;
    assert!(raised > 700.0, "{raised}");
}
