//! Which worker gets which job: what fits, whose turn it is, and what a person may use.
#![allow(clippy::float_cmp, reason = "these numbers are exact")]
use std::time::Duration;

use loadframe_api::people::PersonLimits;
use loadframe_api::worker::ClaimRequest;
use loadframe_api::{JobStatus, WaitCode};
use loadframe_server::queue::needs::Needs;
use loadframe_server::store::{CheckedSubmission, JobEdit, Store, StoreError};
use uuid::Uuid;

use crate::lab::{LONG, Lab, NONE, group, key, submission, worker};

/// A worker process with so much memory.
fn with_memory(name: &str, memory_mb: f64) -> ClaimRequest {
    ClaimRequest {
        memory_mb: Some(memory_mb),
        ..worker(name)
    }
}

/// A job that needs what `change` makes of the smallest example's needs.
async fn submit(store: &Store, priority: i32, change: impl FnOnce(&mut Needs)) -> Uuid {
    let mut checked = CheckedSubmission::new(submission("", priority), None);
    change(&mut checked.needs);
    let enqueued = store.enqueue_checked(checked, None).await.unwrap();
    enqueued.job.id
}

async fn claimed(lab: &Lab, worker: &ClaimRequest) -> Option<Uuid> {
    lab.claim(worker).await.unwrap().map(|lease| lease.job_id)
}

#[tokio::test]
async fn a_job_waits_for_a_worker_that_has_what_it_needs_and_tells_why() {
    let lab = Lab::open(LONG).await;
    let large = submit(&lab, 5, |needs| needs.memory_mb = 14_000).await;
    let waiting = lab.waiting(large).await.unwrap();
    assert_eq!(waiting.code, WaitCode::NoWorker);
    assert_eq!(claimed(&lab, &with_memory("small", 8_000.0)).await, None);
    let waiting = lab.waiting(large).await.unwrap();
    assert_eq!((waiting.workers, waiting.suitable), (1, 0));
    assert_eq!(waiting.code, WaitCode::Memory);
    assert_eq!(
        waiting.reason,
        "it needs 14 GB of memory; the largest worker has 8 GB free"
    );
    // what comes after it is not held up
    let small = submit(&lab, 0, |_| {}).await;
    assert_eq!(
        claimed(&lab, &with_memory("small", 8_000.0)).await,
        Some(small)
    );
    assert_eq!(
        claimed(&lab, &with_memory("large", 14_000.0)).await,
        Some(large)
    );
    let running = lab.waiting(large).await;
    assert!(matches!(running, Err(StoreError::Conflict(_))));
}

#[tokio::test]
async fn threads_time_room_and_version_have_to_fit_too() {
    let lab = Lab::open(LONG).await;
    let ours = worker("");
    for (change, poor, good, code) in [
        (
            (|needs: &mut Needs| needs.threads = 4) as fn(&mut Needs),
            ClaimRequest {
                threads: 3,
                ..ours.clone()
            },
            ClaimRequest {
                threads: 4,
                ..ours.clone()
            },
            WaitCode::Threads,
        ),
        (
            |needs| needs.core_s = 600,
            // twice the reference speed: 299 s are 598 s of it
            ClaimRequest {
                time_left_s: Some(299.0),
                ..ours.clone()
            },
            ClaimRequest {
                time_left_s: Some(301.0),
                ..ours.clone()
            },
            WaitCode::Time,
        ),
        (
            |needs| needs.disk_mb = 500,
            ClaimRequest {
                disk_mb: Some(499.0),
                ..ours.clone()
            },
            ClaimRequest {
                disk_mb: Some(500.0),
                ..ours.clone()
            },
            WaitCode::Disk,
        ),
        (
            |needs| needs.release = 2_001,
            ClaimRequest {
                engine_version: "0.2.0+old".to_owned(),
                ..ours.clone()
            },
            ClaimRequest {
                engine_version: "0.2.1+new".to_owned(),
                ..ours.clone()
            },
            WaitCode::Version,
        ),
    ] {
        // no worker of the round before is there
        let lab = Lab::open(LONG).await;
        let id = submit(&lab, 0, change).await;
        let fresh = |of: ClaimRequest| ClaimRequest {
            worker_id: Uuid::new_v4(),
            ..of
        };
        assert_eq!(claimed(&lab, &fresh(poor)).await, None, "{code:?}");
        assert_eq!(lab.waiting(id).await.unwrap().code, code);
        assert_eq!(claimed(&lab, &fresh(good)).await, Some(id), "{code:?}");
    }
    // a worker that says nothing of itself is given anything, as before
    let id = submit(&lab, 0, |needs| needs.memory_mb = 1_000_000).await;
    assert_eq!(claimed(&lab, &worker("says nothing")).await, Some(id));
}

#[tokio::test]
async fn a_large_machine_leaves_a_job_to_a_small_one_that_waits_for_a_moment() {
    let lab = Lab::open(LONG).await;
    let small = with_memory("small", 8_000.0);
    assert_eq!(claimed(&lab, &small).await, None, "it waits");
    let first = submit(&lab, 0, |_| {}).await;
    let large = with_memory("large", 64_000.0);
    assert_eq!(claimed(&lab, &large).await, None, "left to the small one");
    assert_eq!(claimed(&lab, &small).await, Some(first));
    // now that the small one is busy, the large one takes the next at once
    let second = submit(&lab, 0, |_| {}).await;
    assert_eq!(claimed(&lab, &large).await, Some(second));
    // and nothing waits longer than the moment for a small one that does not come
    let other = with_memory("other", 8_000.0);
    assert_eq!(claimed(&lab, &other).await, None);
    let third = submit(&lab, 0, |_| {}).await;
    let largest = with_memory("largest", 64_000.0);
    assert_eq!(claimed(&lab, &largest).await, None);
    tokio::time::sleep(Duration::from_millis(1_100)).await;
    assert_eq!(claimed(&lab, &largest).await, Some(third));
}

#[tokio::test]
async fn one_persons_thousand_jobs_do_not_hold_up_anothers_one() {
    let lab = Lab::open(LONG).await;
    let [(_, ada), (_, bert)] = group(&lab, ["Ada", "Bert"]).await;
    let mut of_ada = Vec::new();
    for _ in 0..50 {
        of_ada.push(submit(&ada, 0, |_| {}).await);
    }
    let of_bert = [
        submit(&bert, 0, |_| {}).await,
        submit(&bert, 0, |_| {}).await,
    ];
    // as turns are taken: Ada came first, then Bert, then Ada again
    let place = async |id: Uuid| lab.view(id).await.position.unwrap();
    assert_eq!(
        [
            place(of_ada[0]).await,
            place(of_bert[0]).await,
            place(of_ada[1]).await
        ],
        [1, 2, 3]
    );
    assert_eq!(
        [
            place(of_bert[1]).await,
            place(of_ada[2]).await,
            place(of_ada[49]).await
        ],
        [4, 5, 52]
    );
    let next = async || claimed(&lab, &worker("w")).await.unwrap();
    assert_eq!(next().await, of_ada[0]);
    assert_eq!(next().await, of_bert[0], "one of Ada's runs already");
    // priority still goes before turns
    let urgent = submit(&ada, 3, |_| {}).await;
    assert_eq!(next().await, urgent);
    assert_eq!(next().await, of_bert[1]);
    assert_eq!(next().await, of_ada[1], "nobody else waits");
}

#[tokio::test]
async fn what_was_used_counts_after_its_attempts_have_ended() {
    let lab = Lab::open(LONG).await;
    let [(ada_id, ada), (bert_id, bert)] = group(&lab, ["Ada", "Bert"]).await;
    submit(&ada, 0, |_| {}).await;
    let mut wide = worker("wide");
    wide.threads = 4000;
    let lease = lab.claim(&wide).await.unwrap().unwrap();
    tokio::time::sleep(Duration::from_millis(30)).await;
    lab.finish(&lease).await;
    let used = lab.allowance(ada_id).await.unwrap().used;
    // 0.03 s of 4000 threads are 120 core s at least
    assert!(used.recent_core_h >= 120.0 / 3600.0, "{used:?}");
    assert_eq!((used.running, used.queued_core_h), (0, 0.0));
    assert!(used.disk_gb > 0.0, "its files count");
    assert_eq!(
        lab.allowance(bert_id).await.unwrap().used.recent_core_h,
        0.0
    );
    let first = submit(&ada, 0, |_| {}).await;
    let second = submit(&bert, 0, |_| {}).await;
    assert_eq!(lab.view(second).await.position, Some(1));
    assert_eq!(lab.view(first).await.position, Some(2));
    assert_eq!(claimed(&lab, &worker("w")).await, Some(second));
    // files go with their jobs
    lab.delete(lease.job_id).await.unwrap();
    assert_eq!(lab.allowance(ada_id).await.unwrap().used.disk_gb, 0.0);
}

#[tokio::test]
async fn no_more_jobs_of_a_person_run_than_may_and_the_next_waits_for_that() {
    let lab = Lab::open(LONG).await;
    let [(_, ada), (bert_id, bert)] = group(&lab, ["Ada", "Bert"]).await;
    let limits = PersonLimits {
        running: Some(1),
        ..PersonLimits::default()
    };
    let set = lab.set_limits(bert_id, limits).await.unwrap();
    assert_eq!(set.left.running, Some(1));
    submit(&bert, 0, |_| {}).await;
    let second = submit(&bert, 0, |_| {}).await;
    let running = lab.claim(&worker("w")).await.unwrap().unwrap();
    assert_eq!(claimed(&lab, &worker("x")).await, None);
    let waiting = lab.waiting(second).await.unwrap();
    assert_eq!(waiting.code, WaitCode::RunningLimit);
    assert_eq!(waiting.reason, "1 of Bert's jobs run, and 1 may at once");
    // others' jobs of lower priority are not held up
    let other = submit(&ada, -5, |_| {}).await;
    assert_eq!(claimed(&lab, &worker("y")).await, Some(other));
    lab.finish(&running).await;
    assert_eq!(claimed(&lab, &worker("z")).await, Some(second));
}

/// The sentence that a submission is refused with.
async fn refusal(store: &Store, priority: i32) -> Option<String> {
    let checked = CheckedSubmission::new(submission("", priority), None);
    match store.enqueue_checked(checked, None).await {
        Ok(_) => None,
        Err(StoreError::Refused(violations)) => Some(violations[0].to_string()),
        Err(error) => panic!("{error}"),
    }
}

#[tokio::test]
async fn what_a_person_may_not_is_refused_with_one_sentence() {
    let lab = Lab::open(LONG).await;
    let [(_, ada), (bert_id, bert)] = group(&lab, ["Ada", "Bert"]).await;
    let refused = refusal(&bert, 1).await.expect("refused");
    assert_eq!(
        refused,
        "/priority: a priority above 0 is a right that an administrator gives (given 1); allowed: ≤ 0"
    );
    assert_eq!(refusal(&ada, 1).await, None, "administrators may");
    let id = submit(&bert, -3, |_| {}).await;
    let raise = |priority| JobEdit {
        priority: Some(priority),
        ..JobEdit::default()
    };
    assert!(matches!(
        bert.edit(id, raise(2)).await,
        Err(StoreError::Refused(_))
    ));
    assert_eq!(bert.edit(id, raise(0)).await.unwrap().priority, 0);
    let limits = PersonLimits {
        queued_core_h: Some(1e-9),
        may_hurry: true,
        ..PersonLimits::default()
    };
    lab.set_limits(bert_id, limits).await.unwrap();
    let refused = refusal(&bert, 1).await.expect("refused");
    assert!(
        refused
            .starts_with("/spec: the limit queued_core_h of 0.000000001 core h would be exceeded"),
        "{refused}"
    );
    lab.set_limits(
        bert_id,
        PersonLimits {
            may_hurry: true,
            ..PersonLimits::default()
        },
    )
    .await
    .unwrap();
    assert_eq!(refusal(&bert, 1).await, None);
    let none = lab
        .set_limits(Uuid::from_u128(4), PersonLimits::default())
        .await;
    assert!(matches!(none, Err(StoreError::NotFound(_))));
}

#[tokio::test]
async fn a_disk_limit_below_what_is_used_is_refused() {
    let lab = Lab::open(LONG).await;
    let [(ada_id, ada), _] = group(&lab, ["Ada", "Bert"]).await;
    submit(&ada, 0, |_| {}).await;
    let lease = lab.lease().await;
    lab.put(&lease, "large.bin", &vec![7; 3_000_000]).await;
    // the same name again takes its place
    lab.put(&lease, "large.bin", &vec![8; 2_000_000]).await;
    lab.checkpoint_with(&lease, &[1; 500_000], 1.0).await;
    let used = lab.allowance(ada_id).await.unwrap().used.disk_gb;
    assert_eq!(used, 0.0025);
    let limit = |disk_gb| PersonLimits {
        disk_gb: Some(disk_gb),
        ..PersonLimits::default()
    };
    let refused = lab.set_limits(ada_id, limit(0.002)).await;
    let Err(StoreError::Refused(violations)) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(violations[0].pointer, "/disk_gb");
    let set = lab.set_limits(ada_id, limit(0.0025)).await.unwrap();
    assert_eq!(set.left.disk_gb, Some(0.0));
    assert!(refusal(&ada, 0).await.expect("full").contains("disk_gb"));
}

#[tokio::test]
async fn a_lost_attempt_is_charged_as_any_other() {
    let lab = Lab::open(NONE).await;
    let [(ada_id, ada), _] = group(&lab, ["Ada", "Bert"]).await;
    let id = submit(&ada, 0, |_| {}).await;
    let mut wide = worker("wide");
    wide.threads = 4000;
    let lease = lab.claim(&wide).await.unwrap().unwrap();
    lab.heartbeat(key(&lease)).await.unwrap();
    tokio::time::sleep(Duration::from_millis(20)).await;
    lab.sweep().await.unwrap();
    assert_eq!(lab.view(id).await.status, JobStatus::Queued);
    let used = lab.allowance(ada_id).await.unwrap().used;
    assert!(used.recent_core_h >= 80.0 / 3600.0, "{used:?}");
}
