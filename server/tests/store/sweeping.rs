//! Workers that fall silent.
use std::time::Duration;

use loadframe_api::worker::{FailCode, FailRequest, ProgressReport, ReleaseReason};
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, ReasonCode, sha256_hex};
use loadframe_server::store::{Store, StoreOptions, UserAction};

use crate::lab::{LONG, Lab, NONE, is_lost, key, options, worker};

#[tokio::test]
async fn a_stale_lease_is_refused_everywhere_and_publishes_nothing() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    let stale = lab.lease().await;
    let request = lab.result(&stale).await;
    assert_eq!(lab.sweep().await.unwrap(), 1);
    assert_eq!(lab.sweep().await.unwrap(), 0);
    let job = lab.view(id).await;
    assert_eq!(
        (job.status, job.reason_code),
        (JobStatus::Queued, ReasonCode::WorkerLost)
    );
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Lost));
    assert!(job.reason.contains("bench"), "{}", job.reason);

    let failure = FailRequest {
        code: FailCode::WorkerError,
        reason: "late".to_owned(),
    };
    let content: &[u8] = b"late";
    let sha256 = sha256_hex(content);
    let query = loadframe_api::worker::CheckpointQuery {
        sha256: sha256.clone(),
        wall_s: 1.0,
        cpu_s: 1.0,
    };
    let refused_by = async |when: &str| {
        let stale = key(&stale);
        assert!(is_lost(lab.heartbeat(stale).await), "{when}");
        assert!(
            is_lost(lab.report(stale, &ProgressReport::default()).await),
            "{when}"
        );
        assert!(
            is_lost(lab.upload(stale, "a.txt", &sha256, content).await),
            "{when}"
        );
        assert!(
            is_lost(lab.save_checkpoint(stale, &query, content).await),
            "{when}"
        );
        assert!(is_lost(lab.checkpoint(stale, None).await), "{when}");
        assert!(is_lost(lab.complete(stale, &request).await), "{when}");
        assert!(is_lost(lab.fail(stale, &failure).await), "{when}");
        assert!(
            is_lost(lab.release(stale, ReleaseReason::Shutdown).await),
            "{when}"
        );
    };
    refused_by("while the job waits").await;
    let next = lab.lease().await;
    refused_by("while another works").await;
    lab.finish(&next).await;
    refused_by("after another has finished").await;
    assert_eq!(lab.view(id).await.attempts.len(), 2);
    assert_eq!(lab.counts().await.unwrap().attempts_lost, 1);
}

#[tokio::test]
async fn three_losses_quarantine_and_the_reason_quotes_the_log() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    for loss in 1..=3 {
        let lease = lab.lease().await;
        let report = ProgressReport {
            log: vec![format!("attempt {loss} ate all memory")],
            ..ProgressReport::default()
        };
        lab.report(key(&lease), &report).await.unwrap();
        lab.sweep().await.unwrap();
    }
    let job = lab.view(id).await;
    assert_eq!(job.outcome, Some(JobOutcome::Quarantined));
    assert_eq!(job.reason_code, ReasonCode::TooManyLosses);
    assert!(
        job.reason.contains("attempt 3 ate all memory"),
        "{}",
        job.reason
    );
    assert!(lab.claim(&worker("w")).await.unwrap().is_none());
    lab.request(id, UserAction::Retry).await.unwrap();
    let lease = lab.lease().await;
    assert_eq!(lease.attempt, 4);
    lab.sweep().await.unwrap();
    assert_eq!(
        lab.view(id).await.status,
        JobStatus::Queued,
        "losses count anew"
    );
}

#[tokio::test]
async fn what_was_asked_of_a_lost_worker_is_done() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    lab.lease().await;
    lab.request(id, UserAction::Cancel).await.unwrap();
    lab.sweep().await.unwrap();
    assert_eq!(lab.view(id).await.outcome, Some(JobOutcome::Cancelled));

    let id = lab.submit().await;
    lab.lease().await;
    lab.request(id, UserAction::Pause).await.unwrap();
    lab.sweep().await.unwrap();
    assert_eq!(lab.view(id).await.status, JobStatus::Paused);
}

#[tokio::test]
async fn a_live_lease_is_never_swept() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    assert_eq!(lab.sweep().await.unwrap(), 0);
    lab.heartbeat(key(&lease)).await.unwrap();
}

#[tokio::test]
async fn a_lost_job_goes_on_from_its_checkpoint() {
    let lab = Lab::open(NONE).await;
    lab.submit().await;
    let lease = lab.lease().await;
    lab.checkpoint_with(&lease, b"state", 5.0).await;
    lab.sweep().await.unwrap();
    assert!(lab.lease().await.checkpoint.is_some());
}

#[tokio::test]
async fn a_job_whose_worker_ignores_the_time_limit_is_timed_out() {
    let folder = tempfile::tempdir().unwrap();
    let limited = StoreOptions {
        job_time_limit: Some(Duration::from_secs(60)),
        ..options(&folder, Duration::from_secs(30))
    };
    let store = Store::open(limited).await.unwrap();
    let lab = Lab { store, folder };
    let id = lab.submit().await;
    let lease = lab.lease().await;
    assert_eq!(lease.time_limit_s, Some(60.0));
    // work before the checkpoint counts: here it fills the limit and the lease that is granted on top
    lab.checkpoint_with(&lease, b"state", 100.0).await;
    assert_eq!(
        lab.sweep().await.unwrap(),
        0,
        "this attempt itself is young"
    );
    lab.release(key(&lease), ReleaseReason::Shutdown)
        .await
        .unwrap();
    let lease = lab.lease().await;
    assert_eq!(lab.sweep().await.unwrap(), 1);
    let job = lab.view(id).await;
    assert_eq!(job.outcome, Some(JobOutcome::TimedOut));
    assert_eq!(job.reason_code, ReasonCode::TimeLimit);
    assert!(is_lost(lab.heartbeat(key(&lease)).await));
}

#[tokio::test]
async fn heartbeats_cost_no_write_each_and_yet_keep_the_lease() {
    use sqlx::{ConnectOptions as _, Row as _};
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    lab.heartbeat(key(&lease)).await.unwrap();
    let database = lab.folder.path().join("loadframe.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    let mut beside = options.connect().await.unwrap();
    // sqlite.org/pragma.html#pragma_data_version: changes with every commit of another connection
    let mut version = async || -> i64 {
        let row = sqlx::query("PRAGMA data_version").fetch_one(&mut beside);
        row.await.unwrap().get(0)
    };
    let before = version().await;
    for _ in 0..100 {
        lab.heartbeat(key(&lease)).await.unwrap();
    }
    assert_eq!(version().await, before);
    assert_eq!(lab.sweep().await.unwrap(), 0);
    assert_ne!(version().await, before);
}

#[tokio::test]
async fn a_lease_whose_heartbeats_are_not_written_yet_does_not_run_out() {
    const LEASE: Duration = Duration::from_millis(600);
    let lab = Lab::open(LEASE).await;
    lab.submit().await;
    let lease = lab.lease().await;
    lab.heartbeat(key(&lease)).await.unwrap();
    for _ in 0..4 {
        tokio::time::sleep(LEASE / 2).await;
        lab.heartbeat(key(&lease)).await.unwrap();
    }
    // two leases after the last one that was written at once
    assert_eq!(lab.sweep().await.unwrap(), 0);
    lab.heartbeat(key(&lease)).await.unwrap();
    // silent since
    tokio::time::sleep(2 * LEASE).await;
    assert_eq!(lab.sweep().await.unwrap(), 1);
    assert!(is_lost(lab.heartbeat(key(&lease)).await));
}

#[tokio::test]
async fn an_attempt_that_cannot_be_ended_keeps_no_other_from_it() {
    use sqlx::{ConnectOptions as _, Executor as _};
    let lab = Lab::open(NONE).await;
    let database = lab.folder.path().join("loadframe.db");
    if !database.exists() {
        // a word that no server writes is put into this database alone
        return;
    }
    let (bad, good) = (lab.submit().await, lab.submit().await);
    let (first, second) = (lab.lease().await, lab.lease().await);
    assert_eq!([first.job_id, second.job_id], [bad, good]);
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    let mut beside = options.connect().await.unwrap();
    let word = "UPDATE jobs SET asked = 'nothing' WHERE seq = (SELECT MIN(seq) FROM jobs)";
    beside.execute(word).await.unwrap();
    let swept = lab.sweep().await;
    assert!(swept.is_err(), "{swept:?}");
    assert_eq!(lab.view(good).await.reason_code, ReasonCode::WorkerLost);
    assert_eq!(lab.view(bad).await.status, JobStatus::Running);
}
