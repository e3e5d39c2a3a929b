//! Machines at fault, reports that are repeated, and jobs beyond their estimate.
use std::time::Duration;

use loadframe_api::worker::{
    ClaimRequest, FailCode, FailRequest, FaultCode, FaultRequest, Lease, ProgressReport,
};
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, ReasonCode};
use loadframe_server::store::{Store, StoreOptions, UserAction};

use crate::lab::{LONG, Lab, is_lost, key, options, worker};

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
        "its estimate is ",
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
