//! How attempts end, once.
use loadframe_api::worker::{FailCode, FailRequest, ReleaseReason};
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, ReasonCode};
use loadframe_server::store::{LeaseKey, UserAction};
use uuid::Uuid;

use crate::lab::{LONG, Lab, is_invalid, is_lost, is_missing, key};

#[tokio::test]
async fn complete_publishes_files_outcome_and_summary() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.put(&lease, "scratch.bin", b"not part of the result")
        .await;
    let request = lab.result(&lease).await;
    assert!(
        lab.files(id).await.unwrap().is_empty(),
        "published too early"
    );
    assert!(is_missing(lab.file(id, "curve.csv").await));
    assert!(is_missing(lab.outcome(id).await));

    lab.complete(key(&lease), &request).await.unwrap();
    let job = lab.view(id).await;
    assert_eq!(job.status, JobStatus::Finished);
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded));
    assert_eq!(job.reason_code, ReasonCode::Completed);
    assert_eq!(job.progress.to_bits(), 1.0_f64.to_bits());
    assert_eq!(job.summary.as_ref(), Some(&request.outcome.summary));
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Completed));
    assert!(job.finished_at.is_some());

    let mut names: Vec<_> = request.files.iter().map(|file| &file.name).collect();
    names.sort();
    let published = lab.files(id).await.unwrap();
    assert_eq!(
        published.iter().map(|file| &file.name).collect::<Vec<_>>(),
        names
    );
    let entry = lab.file(id, "curve.csv").await.unwrap();
    let path = lab.content(id, &entry).await.unwrap();
    assert_eq!(std::fs::read(path).unwrap(), b"a,b\n1,2\n");
    assert_eq!(entry.bytes, 8);
    let outcome = serde_json::from_str(&lab.outcome(id).await.unwrap()).unwrap();
    assert_eq!(request.outcome, outcome);
}

#[tokio::test]
async fn each_last_word_may_be_repeated_and_no_other_follows_it() {
    let lab = Lab::open(LONG).await;
    let failure = FailRequest {
        code: FailCode::SimulationError,
        reason: "it diverged".to_owned(),
    };

    lab.submit().await;
    let completed = lab.lease().await;
    let request = lab.finish(&completed).await;
    lab.complete(key(&completed), &request).await.unwrap();
    let mut other = request.clone();
    other.outcome.stop_reason = "another".to_owned();
    assert!(is_lost(lab.complete(key(&completed), &other).await));
    assert!(is_lost(lab.fail(key(&completed), &failure).await));
    assert!(is_lost(
        lab.release(key(&completed), ReleaseReason::Shutdown).await
    ));

    let id = lab.submit().await;
    let failed = lab.lease().await;
    lab.fail(key(&failed), &failure).await.unwrap();
    lab.fail(key(&failed), &failure).await.unwrap();
    assert!(is_lost(
        lab.release(key(&failed), ReleaseReason::Shutdown).await
    ));
    let job = lab.view(id).await;
    assert_eq!(job.outcome, Some(JobOutcome::Failed));
    assert_eq!(job.reason, "it diverged");

    lab.submit().await;
    let released = lab.lease().await;
    lab.release(key(&released), ReleaseReason::Shutdown)
        .await
        .unwrap();
    lab.release(key(&released), ReleaseReason::Shutdown)
        .await
        .unwrap();
    assert!(is_lost(lab.fail(key(&released), &failure).await));
    // the job has gone on to another worker meanwhile; the repetition still changes nothing
    let next = lab.lease().await;
    lab.release(key(&released), ReleaseReason::Shutdown)
        .await
        .unwrap();
    assert_eq!(lab.view(next.job_id).await.status, JobStatus::Running);
}

#[tokio::test]
async fn a_planned_stop_costs_no_attempt() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    for number in 1..=10 {
        let lease = lab.lease().await;
        assert_eq!((lease.job_id, lease.attempt), (id, number));
        lab.release(key(&lease), ReleaseReason::Shutdown)
            .await
            .unwrap();
        let job = lab.view(id).await;
        assert_eq!(job.status, JobStatus::Queued);
        assert_eq!(job.reason_code, ReasonCode::WorkerReleased);
    }
}

#[tokio::test]
async fn time_limit_told_by_the_worker() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let over = FailRequest {
        code: FailCode::TimeLimit,
        reason: "longer than 60 s".to_owned(),
    };
    lab.fail(key(&lease), &over).await.unwrap();
    let job = lab.view(id).await;
    assert_eq!(job.outcome, Some(JobOutcome::TimedOut));
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::TimedOut));
}

#[tokio::test]
async fn results_that_do_not_fit_are_refused_and_the_lease_stays() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let good = lab.result(&lease).await;

    let mut never_uploaded = good.clone();
    never_uploaded.files[0].name = "never.csv".to_owned();
    let mut other_content = good.clone();
    other_content.files[0].sha256 = "0".repeat(64);
    let mut twice = good.clone();
    twice.files.push(good.files[0].clone());
    let mut no_outcome = good.clone();
    no_outcome.files.retain(|file| file.name != "outcome.json");
    let mut other_spec = good.clone();
    other_spec.outcome.provenance.spec_sha256 = "0".repeat(64);
    for bad in [never_uploaded, other_content, twice, no_outcome, other_spec] {
        assert!(is_invalid(lab.complete(key(&lease), &bad).await));
        assert_eq!(lab.view(id).await.status, JobStatus::Running);
    }
    lab.complete(key(&lease), &good).await.unwrap();
    assert_eq!(lab.files(id).await.unwrap().len(), 2);
}

#[tokio::test]
async fn cancel_or_complete_whichever_commits_first_wins() {
    let lab = Lab::open(LONG).await;
    // cancel first: the worker's result comes too late, and its word is taken all the same
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let request = lab.result(&lease).await;
    lab.request(id, UserAction::Cancel).await.unwrap();
    lab.complete(key(&lease), &request).await.unwrap();
    lab.complete(key(&lease), &request).await.unwrap();
    let job = lab.view(id).await;
    assert_eq!(job.outcome, Some(JobOutcome::Cancelled));
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Cancelled));
    assert!(lab.files(id).await.unwrap().is_empty());
    assert!(is_missing(lab.outcome(id).await));

    // complete first: there is nothing left to cancel
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.finish(&lease).await;
    assert!(lab.request(id, UserAction::Cancel).await.is_err());
    assert_eq!(lab.view(id).await.outcome, Some(JobOutcome::Succeeded));
}

#[tokio::test(flavor = "multi_thread")]
async fn racing_cancel_and_complete_end_in_one_of_both() {
    let lab = Lab::open(LONG).await;
    for _ in 0..50 {
        let id = lab.submit().await;
        let lease = lab.lease().await;
        let request = lab.result(&lease).await;
        let (store, other) = (lab.store.clone(), lab.store.clone());
        let complete = tokio::spawn(async move { store.complete(key(&lease), &request).await });
        let cancel = tokio::spawn(async move { other.request(id, UserAction::Cancel).await });
        complete.await.unwrap().unwrap();
        let cancel = cancel.await.unwrap();
        let job = lab.view(id).await;
        let files = lab.files(id).await.unwrap().len();
        match job.outcome {
            Some(JobOutcome::Cancelled) => assert!(cancel.is_ok() && files == 0),
            Some(JobOutcome::Succeeded) => assert!(cancel.is_err() && files == 2),
            other => panic!("{other:?}"),
        }
    }
}

#[tokio::test]
async fn a_wrong_token_is_as_good_as_no_lease() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    let forged = LeaseKey {
        token: Uuid::new_v4(),
        ..key(&lease)
    };
    assert!(is_lost(lab.heartbeat(forged).await));
    assert!(is_lost(lab.release(forged, ReleaseReason::Shutdown).await));
    lab.heartbeat(key(&lease)).await.unwrap();
}

#[tokio::test]
async fn a_failed_job_keeps_what_it_had_in_a_folder_that_says_so() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.put(&lease, "curve.csv", b"a,b\n1,2\n").await;
    lab.put(&lease, "snapshots/0.vtp", b"x").await;
    assert!(
        lab.files(id).await.unwrap().is_empty(),
        "published too early"
    );
    let failure = FailRequest {
        code: FailCode::SimulationError,
        reason: "it diverged".to_owned(),
    };
    // a stale worker publishes nothing
    let stale = LeaseKey {
        token: Uuid::new_v4(),
        ..key(&lease)
    };
    assert!(is_lost(lab.fail(stale, &failure).await));
    assert!(lab.files(id).await.unwrap().is_empty());
    lab.fail(key(&lease), &failure).await.unwrap();
    let names: Vec<String> = lab
        .files(id)
        .await
        .unwrap()
        .into_iter()
        .map(|file| file.name)
        .collect();
    assert_eq!(names, ["partial/curve.csv", "partial/snapshots/0.vtp"]);
    let file = lab.file(id, "partial/curve.csv").await.unwrap();
    let path = lab.content(id, &file).await.unwrap();
    assert_eq!(std::fs::read(path).unwrap(), b"a,b\n1,2\n");
    assert!(is_missing(lab.file(id, "curve.csv").await));
    assert!(is_missing(lab.outcome(id).await));
    // tried again it begins with nothing, and a result takes the place of what failed
    lab.request(id, UserAction::Retry).await.unwrap();
    assert!(lab.files(id).await.unwrap().is_empty());
    let lease = lab.lease().await;
    assert!(lab.files(id).await.unwrap().is_empty());
    let request = lab.finish(&lease).await;
    lab.complete(key(&lease), &request).await.unwrap();
    let files = lab.files(id).await.unwrap();
    assert!(
        files.iter().all(|file| !file.name.starts_with("partial/")),
        "{files:?}"
    );
}
