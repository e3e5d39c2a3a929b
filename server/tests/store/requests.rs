//! What users ask, in every state.
use loadframe_api::worker::{Command, FailCode, FailRequest, ProgressReport, ReleaseReason};
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, ReasonCode};
use loadframe_server::store::{JobEdit, UserAction};
use uuid::Uuid;

use crate::lab::{LONG, Lab, is_conflict, is_lost, is_missing, key, worker};

#[tokio::test]
async fn cancel_works_in_every_state() {
    let lab = Lab::open(LONG).await;
    let cancelled = |job: loadframe_api::JobView| {
        assert_eq!(job.status, JobStatus::Finished);
        assert_eq!(job.outcome, Some(JobOutcome::Cancelled));
        assert_eq!(job.reason_code, ReasonCode::CancelledByUser);
    };

    let queued = lab.submit().await;
    cancelled(lab.request(queued, UserAction::Cancel).await.unwrap());
    cancelled(lab.request(queued, UserAction::Cancel).await.unwrap());
    assert!(lab.claim(&worker("w")).await.unwrap().is_none());

    let paused = lab.submit().await;
    lab.request(paused, UserAction::Pause).await.unwrap();
    cancelled(lab.request(paused, UserAction::Cancel).await.unwrap());

    let running = lab.submit().await;
    let lease = lab.lease().await;
    let asked = lab.request(running, UserAction::Cancel).await.unwrap();
    assert_eq!(asked.status, JobStatus::Running);
    assert_eq!(asked.reason_code, ReasonCode::CancelRequested);
    assert_eq!(lab.heartbeat(key(&lease)).await.unwrap(), Command::Cancel);
    let report = ProgressReport::default();
    assert_eq!(
        lab.report(key(&lease), &report).await.unwrap(),
        Command::Cancel
    );
    lab.release(key(&lease), ReleaseReason::Cancelled)
        .await
        .unwrap();
    let job = lab.view(running).await;
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Cancelled));
    cancelled(job);
    assert!(is_lost(lab.heartbeat(key(&lease)).await));
}

#[tokio::test]
async fn pause_keeps_the_checkpoint_and_resume_goes_on_from_it() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let kept = lab.put(&lease, "snapshots/0.vtp", b"zero").await;
    lab.request(id, UserAction::Pause).await.unwrap();
    assert_eq!(lab.heartbeat(key(&lease)).await.unwrap(), Command::Pause);
    lab.checkpoint_with(&lease, b"state at step 3", 12.5).await;
    lab.put(&lease, "snapshots/1.vtp", b"after the checkpoint")
        .await;
    lab.release(key(&lease), ReleaseReason::Paused)
        .await
        .unwrap();
    let job = lab.view(id).await;
    assert_eq!(
        (job.status, job.reason_code),
        (JobStatus::Paused, ReasonCode::PausedByUser)
    );
    assert!(lab.claim(&worker("w")).await.unwrap().is_none());

    lab.request(id, UserAction::Resume).await.unwrap();
    let lease = lab.lease().await;
    assert_eq!(lease.attempt, 2);
    let checkpoint = lease.checkpoint.clone().unwrap();
    assert_eq!(checkpoint.files, std::slice::from_ref(&kept));
    assert_eq!(checkpoint.wall_s.to_bits(), 12.5_f64.to_bits());
    let (info, path) = lab.checkpoint(key(&lease), None).await.unwrap();
    assert_eq!(info, checkpoint);
    assert_eq!(std::fs::read(path).unwrap(), b"state at step 3");

    // the carried-over file counts as uploaded by the new attempt
    let mut result = lab.result(&lease).await;
    result.files.push(kept);
    lab.complete(key(&lease), &result).await.unwrap();
    assert_eq!(lab.files(id).await.unwrap().len(), 3);
}

#[tokio::test]
async fn a_pause_may_be_withdrawn_before_the_worker_acts() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.request(id, UserAction::Pause).await.unwrap();
    lab.request(id, UserAction::Resume).await.unwrap();
    assert_eq!(lab.heartbeat(key(&lease)).await.unwrap(), Command::Continue);
    // the worker had heard of the pause already: the job waits for the next one
    lab.release(key(&lease), ReleaseReason::Paused)
        .await
        .unwrap();
    assert_eq!(lab.view(id).await.status, JobStatus::Queued);
}

#[tokio::test]
async fn retry_starts_what_has_not_succeeded_again() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.checkpoint_with(&lease, b"as far as it came", 1.0).await;
    let failure = FailRequest {
        code: FailCode::SimulationError,
        reason: "it diverged".to_owned(),
    };
    lab.fail(key(&lease), &failure).await.unwrap();
    let job = lab.request(id, UserAction::Retry).await.unwrap();
    assert_eq!((job.status, job.outcome), (JobStatus::Queued, None));
    assert_eq!(job.reason_code, ReasonCode::RetriedByUser);
    assert!(job.finished_at.is_none() && job.started_at.is_none());
    // asked twice is asked once
    lab.request(id, UserAction::Retry).await.unwrap();
    let lease = lab.lease().await;
    assert_eq!(lease.attempt, 2);
    assert!(lease.checkpoint.is_some(), "what it had stays with it");
    lab.finish(&lease).await;
    assert!(is_conflict(lab.request(id, UserAction::Retry).await));

    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.checkpoint_with(&lease, b"good", 1.0).await;
    lab.request(id, UserAction::Cancel).await.unwrap();
    lab.release(key(&lease), ReleaseReason::Cancelled)
        .await
        .unwrap();
    lab.request(id, UserAction::Retry).await.unwrap();
    assert!(
        lab.lease().await.checkpoint.is_some(),
        "a cancelled job goes on"
    );
}

#[tokio::test]
async fn what_a_state_does_not_allow_is_a_conflict_and_what_is_not_there_is_missing() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    lab.lease().await;
    assert!(is_conflict(lab.request(id, UserAction::Retry).await));
    assert!(is_conflict(lab.delete(id).await));
    lab.request(id, UserAction::Cancel).await.unwrap();
    assert!(is_conflict(lab.request(id, UserAction::Pause).await));
    assert!(is_conflict(lab.request(id, UserAction::Resume).await));
    let nobody = Uuid::new_v4();
    assert!(is_missing(lab.request(nobody, UserAction::Cancel).await));
    assert!(is_missing(lab.job(nobody).await));
    assert!(is_missing(lab.delete(nobody).await));
    assert!(is_missing(lab.edit(nobody, JobEdit::default()).await));
}

#[tokio::test]
async fn edits_change_what_they_name() {
    let lab = Lab::open(LONG).await;
    let first = lab.submit_with("first", 0).await;
    let second = lab.submit_with("second", 0).await;
    let edit = JobEdit {
        priority: Some(3),
        tags: Some(vec!["thesis".to_owned()]),
        ..JobEdit::default()
    };
    let job = lab.edit(second, edit).await.unwrap();
    assert_eq!((job.name.as_str(), job.priority), ("second", 3));
    assert_eq!(job.tags, ["thesis"]);
    assert_eq!(job.position, Some(1));
    assert_eq!(lab.view(first).await.position, Some(2));
}
