//! Who gets which job.
use std::collections::HashSet;

use loadframe_api::worker::{ClaimRequest, Command};
use loadframe_api::{Calibration, JobStatus};

use crate::lab::{LONG, Lab, key, worker};

#[tokio::test(flavor = "multi_thread")]
async fn claimers_that_race_never_share_a_job() {
    const JOBS: usize = 200;
    const CLAIMERS: usize = 8;
    let lab = Lab::open(LONG).await;
    for _ in 0..JOBS {
        lab.submit().await;
    }
    let race = (0..CLAIMERS).map(|claimer| {
        let store = lab.store.clone();
        tokio::spawn(async move {
            let mut jobs = Vec::new();
            // a fresh process for every claim, so that no unused lease is handed out again
            while let Some(lease) = store.claim(&worker(&claimer.to_string())).await.unwrap() {
                jobs.push((lease.job_id, lease.attempt));
            }
            jobs
        })
    });
    let mut seen = HashSet::new();
    for claimer in race.collect::<Vec<_>>() {
        for (job, attempt) in claimer.await.unwrap() {
            assert_eq!(attempt, 1);
            assert!(seen.insert(job), "{job} was handed out twice");
        }
    }
    assert_eq!(seen.len(), JOBS);
    let counts = lab.counts().await.unwrap();
    assert_eq!((counts.running, counts.queued), (JOBS as u64, 0));
}

#[tokio::test]
async fn priority_goes_first_then_the_order_of_submission() {
    let lab = Lab::open(LONG).await;
    let first = lab.submit_with("first", 0).await;
    let second = lab.submit_with("second", 0).await;
    let low = lab.submit_with("low", -1).await;
    let urgent = lab.submit_with("urgent", 5).await;

    let order = [urgent, first, second, low];
    for (place, id) in order.into_iter().enumerate() {
        assert_eq!(lab.view(id).await.position, Some(place as u64 + 1));
    }
    for id in order {
        assert_eq!(lab.lease().await.job_id, id);
    }
    assert!(lab.claim(&worker("late")).await.unwrap().is_none());
}

#[tokio::test]
async fn a_worker_gets_only_kinds_it_offers() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let mut narrow = worker("narrow");
    narrow.kinds.clear();
    assert!(lab.claim(&narrow).await.unwrap().is_none());
    assert!(lab.claim(&worker("any")).await.unwrap().is_some());
}

#[tokio::test]
async fn a_lease_that_was_never_used_is_handed_out_again_and_a_used_one_not() {
    let lab = Lab::open(LONG).await;
    let (first, second) = (lab.submit().await, lab.submit().await);
    let me = worker("me");
    let lost_answer = lab.claim(&me).await.unwrap().unwrap();
    let again = lab.claim(&me).await.unwrap().unwrap();
    assert_eq!((again.id, again.token), (lost_answer.id, lost_answer.token));
    assert_eq!((again.job_id, again.attempt), (first, 1));

    assert_eq!(lab.heartbeat(key(&again)).await.unwrap(), Command::Continue);
    assert_eq!(lab.claim(&me).await.unwrap().unwrap().job_id, second);
}

#[tokio::test]
async fn a_lease_carries_the_spec_and_the_job_shows_its_attempt() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let job = lab.view(id).await;
    assert_eq!(job.status, JobStatus::Running);
    assert_eq!((job.attempt, lease.attempt), (1, 1));
    assert_eq!(job.attempts.len(), 1);
    assert_eq!(job.attempts[0].worker, "bench");
    assert_eq!(job.attempts[0].ended_at, None);
    assert!(job.started_at.is_some() && job.position.is_none());
    let spec: serde_json::Value = serde_json::from_str(lease.spec.get()).unwrap();
    assert_eq!(job.spec, Some(spec));
    assert_eq!(
        loadframe_api::sha256_hex(lease.spec.get().as_bytes()),
        job.spec_sha256
    );

    let workers = lab.workers().await.unwrap();
    assert_eq!(workers.len(), 1);
    assert!(workers[0].alive);
    assert_eq!(workers[0].job_id, Some(id));
    let speed = lab.calibration().await.unwrap().unwrap();
    assert_eq!(speed, worker("").calibration.unwrap());
}

#[tokio::test]
async fn what_no_machine_can_be_is_not_believed_and_one_liar_prices_no_job() {
    let lab = Lab::open(LONG).await;
    let says = |name: &str, speed: f64| {
        let calibration = Some(Calibration {
            bond_evaluations_per_s: speed,
        });
        ClaimRequest {
            calibration,
            ..worker(name)
        }
    };
    let speed = async || {
        let speed = lab.calibration().await.unwrap();
        speed.map(|speed| speed.bond_evaluations_per_s)
    };
    for absurd in [1e-3, 0.0, -1.0, 1e300] {
        lab.claim(&says("absurd", absurd)).await.unwrap();
        assert_eq!(speed().await, None, "{absurd}");
    }
    // of two the slower, of many the one in the middle, whatever one of them says
    lab.claim(&says("a", 2e8)).await.unwrap();
    lab.claim(&says("fast liar", 9e9)).await.unwrap();
    assert_eq!(speed().await, Some(2e8));
    lab.claim(&says("b", 3e8)).await.unwrap();
    lab.claim(&says("slow liar", 1e6)).await.unwrap();
    lab.claim(&says("c", 2.5e8)).await.unwrap();
    assert_eq!(speed().await, Some(2.5e8));
}

#[tokio::test]
async fn whoever_waits_is_woken_by_a_submission() {
    let lab = Lab::open(LONG).await;
    let mut queued = lab.queued();
    queued.mark_unchanged();
    let waiting = tokio::spawn(async move { queued.changed().await });
    lab.submit().await;
    waiting.await.unwrap().unwrap();
}
