//! Who is called when jobs come. None of these workers looks by itself: a call that is lost would be a job that
//! nobody takes.
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use loadframe_api::people::PersonLimits;
use loadframe_server::store::Store;
use tokio::sync::mpsc;
use tokio::task::JoinSet;
use tokio::time::timeout;
use uuid::Uuid;

use crate::lab::{LONG, Lab, worker};

/// What has not come after this time does not come.
const NEVER: Duration = Duration::from_secs(60);

/// Takes one job after the other, each as a process just started, and tells of it.
async fn take(store: Store, looks: Arc<AtomicUsize>, taken: mpsc::UnboundedSender<Uuid>) {
    loop {
        let claim = worker("one of many");
        let mut waiting = store.wait_in_line(&claim);
        let lease = loop {
            waiting.looks();
            looks.fetch_add(1, Ordering::Relaxed);
            if let Some(lease) = store.claim(&claim).await.expect("an answer") {
                break lease;
            }
            waiting.called().await;
        };
        if taken.send(lease.job_id).is_err() {
            return;
        }
    }
}

/// Goes away whenever it is called, without a look.
async fn desert(store: Store) {
    loop {
        store.wait_in_line(&worker("deserter")).called().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_sends_one_of_many_workers_that_wait_to_look() {
    const WORKERS: usize = 40;
    const JOBS: usize = 30;
    let lab = Lab::open(LONG).await;
    let (looks, mut tasks) = (Arc::<AtomicUsize>::default(), JoinSet::new());
    let (taken, mut told) = mpsc::unbounded_channel();
    for _ in 0..WORKERS {
        tasks.spawn(take(lab.store.clone(), Arc::clone(&looks), taken.clone()));
    }
    for _ in 0..JOBS {
        let id = lab.submit().await;
        assert_eq!(timeout(NEVER, told.recv()).await, Ok(Some(id)));
    }
    // each its first look; for each job the look of who takes it, its next one, and one in vain where that
    // next one was faster than who was called
    let looks = looks.load(Ordering::Relaxed);
    assert!(looks <= WORKERS + 3 * JOBS, "{looks} looks for {JOBS} jobs");
}

#[tokio::test(flavor = "multi_thread")]
async fn no_call_is_lost_by_workers_that_go_away() {
    const SUBMITTERS: usize = 4;
    const JOBS: usize = 40;
    let lab = Lab::open(LONG).await;
    let mut tasks = JoinSet::new();
    let (taken, mut told) = mpsc::unbounded_channel();
    for _ in 0..6 {
        tasks.spawn(desert(lab.store.clone()));
        tasks.spawn(take(lab.store.clone(), Arc::default(), taken.clone()));
    }
    for _ in 0..SUBMITTERS {
        let store = lab.store.clone();
        tasks.spawn(async move {
            for _ in 0..JOBS {
                let submission = crate::lab::submission("", 0);
                store.enqueue(&submission, None).await.expect("accepted");
            }
        });
    }
    let mut seen = HashSet::new();
    for _ in 0..SUBMITTERS * JOBS {
        let id = timeout(NEVER, told.recv()).await;
        let id = id.expect("every job is taken").expect("workers are there");
        assert!(seen.insert(id), "{id} was taken twice");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_waited_for_its_owners_limit_calls_a_worker_when_another_ends() {
    let lab = Lab::open(LONG).await;
    let ada = lab.create_first_administrator("Ada", "a password for tests");
    let ada = ada.await.expect("an administrator").id;
    let limits = PersonLimits {
        running: Some(1),
        ..PersonLimits::default()
    };
    lab.set_limits(ada, limits).await.expect("set");
    // jobs of before there were people are hers, at the last moment too
    let first = lab.submit().await;
    let running = lab.claim(&worker("first")).await.expect("an answer");
    let running = running.expect("a job");
    assert_eq!(running.job_id, first);
    let (second, third) = (lab.submit().await, lab.submit().await);
    let (looks, mut tasks) = (Arc::<AtomicUsize>::default(), JoinSet::new());
    let (taken, mut told) = mpsc::unbounded_channel();
    for _ in 0..8 {
        tasks.spawn(take(lab.store.clone(), Arc::clone(&looks), taken.clone()));
    }
    while looks.load(Ordering::Relaxed) < 8 {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    lab.finish(&running).await;
    let next = timeout(NEVER, told.recv())
        .await
        .expect("a worker is called");
    assert_eq!(next, Some(second));
    // one more may run, and one was called for it, though two waited
    let looks = looks.load(Ordering::Relaxed);
    assert!(looks <= 8 + 3, "{looks} looks for one job");
    assert_eq!(lab.view(third).await.position, Some(1));
}
