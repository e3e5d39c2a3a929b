//! Two servers on one database: what one does the other knows, and what only one may do one does.
//!
//! They need PostgreSQL; `tests/postgres store` runs them.
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use loadframe_api::worker::{CurveBlock, ProgressReport};
use loadframe_server::store::trash::TrashSight;
use loadframe_server::store::{
    DatabasePlace, JobFilter, Store, StoreOptions, UserAction, move_store,
};
use serde_json::{Value, json};

use crate::lab::{LONG, Lab, key, options, worker};

/// Longer than any of these tests takes; what is waited for comes at once.
const AT_MOST: Duration = Duration::from_secs(60);

/// A second server on the database and the folder of the first.
async fn beside(lab: &Lab) -> Store {
    Store::open(options(&lab.folder, LONG)).await.unwrap()
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn a_change_by_one_server_wakes_who_waits_at_the_other() {
    let lab = Lab::open(LONG).await;
    let other = beside(&lab).await;
    let (mut changes, mut queued) = (other.changes(), other.queued());
    changes.mark_unchanged();
    queued.mark_unchanged();
    let id = lab.submit().await;
    let woken = async {
        changes.changed().await.unwrap();
        queued.changed().await.unwrap();
    };
    tokio::time::timeout(AT_MOST, woken).await.expect("news");
    assert_eq!(other.last_event().await, lab.last_event().await);
    let told = other.events_after(0, None, 10).await.unwrap();
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].event.job_id(), id);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn workers_of_two_servers_never_share_a_job() {
    let lab = Lab::open(LONG).await;
    let other = beside(&lab).await;
    const JOBS: usize = 24;
    for _ in 0..JOBS {
        lab.submit().await;
    }
    let claim = |store: Store| {
        tokio::spawn(async move {
            let mut claimed = Vec::new();
            while let Some(lease) = store.claim(&worker("one")).await.unwrap() {
                claimed.push(lease.job_id);
            }
            claimed
        })
    };
    let tasks = [
        claim(lab.store.clone()),
        claim(other.clone()),
        claim(lab.store.clone()),
        claim(other),
    ];
    let mut claimed = Vec::new();
    for task in tasks {
        claimed.extend(task.await.unwrap());
    }
    claimed.sort_unstable();
    claimed.dedup();
    assert_eq!(claimed.len(), JOBS);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn a_worker_goes_on_at_the_other_server_and_hears_what_was_asked_at_the_first() {
    let lab = Lab::open(LONG).await;
    let other = beside(&lab).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.put(&lease, "at-first.csv", b"a\n1\n").await;
    other.heartbeat(key(&lease)).await.unwrap();
    lab.request(id, UserAction::Cancel).await.unwrap();
    let heard = other.heartbeat(key(&lease)).await.unwrap();
    assert_eq!(heard, loadframe_api::worker::Command::Cancel);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn heartbeats_at_one_server_keep_the_lease_from_the_others_sweep() {
    let short = Duration::from_secs(2);
    let lab = Lab::open(short).await;
    let other = Store::open(options(&lab.folder, short)).await.unwrap();
    lab.submit().await;
    let lease = lab.lease().await;
    let end = tokio::time::Instant::now() + 3 * short;
    while tokio::time::Instant::now() < end {
        lab.heartbeat(key(&lease)).await.unwrap();
        // each server sweeps every second
        lab.sweep().await.unwrap();
        assert_eq!(other.sweep().await.unwrap(), 0);
        tokio::time::sleep(Duration::from_millis(300)).await;
    }
    lab.heartbeat(key(&lease)).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn a_duty_is_done_by_one_server_and_taken_over_when_it_has_gone() {
    let lab = Lab::open(LONG).await;
    let stores = [lab.store.clone(), beside(&lab).await];
    let (at_work, begun) = (Arc::<AtomicUsize>::default(), Arc::<AtomicUsize>::default());
    let tasks = stores.map(|store| {
        let (at_work, begun) = (Arc::clone(&at_work), Arc::clone(&begun));
        tokio::spawn(async move {
            let work = async {
                begun.fetch_add(1, Ordering::SeqCst);
                assert_eq!(at_work.fetch_add(1, Ordering::SeqCst), 0, "two at once");
                tokio::time::sleep(Duration::from_millis(300)).await;
                at_work.fetch_sub(1, Ordering::SeqCst);
            };
            store.as_duty("a test", work).await;
        })
    });
    for task in tasks {
        tokio::time::timeout(AT_MOST, task)
            .await
            .expect("its turn")
            .unwrap();
    }
    assert_eq!(begun.load(Ordering::SeqCst), 2);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn what_one_server_stores_another_does_not_take_for_forgotten() {
    let lab = Lab::open(LONG).await;
    let hasty = StoreOptions {
        unnamed_wait: Duration::ZERO,
        ..options(&lab.folder, LONG)
    };
    let other = Store::open(hasty).await.unwrap();
    let mut jobs = Vec::new();
    for round in 0..12_u8 {
        let id = lab.submit().await;
        let lease = lab.lease().await;
        // the same bytes again and again: what one job lets go of the next one names
        let request = lab.finish(&lease).await;
        if round % 2 == 0 {
            other.delete(id).await.unwrap();
        } else {
            jobs.push((id, request));
        }
        other.settled_files().await;
    }
    for (id, request) in jobs {
        for file in &request.files {
            lab.content(id, file).await.unwrap();
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn a_server_that_starts_leaves_the_others_uploads_and_removes_what_a_dead_one_left() {
    let lab = Lab::open(LONG).await;
    let incoming = lab.folder.path().join("incoming");
    let own = std::fs::read_dir(&incoming)
        .unwrap()
        .next()
        .unwrap()
        .unwrap();
    let on_its_way = own.path().join("half");
    std::fs::write(&on_its_way, b"of a server that lives").unwrap();
    let left = incoming.join("0".repeat(32));
    std::fs::create_dir(&left).unwrap();
    for name in ["lock", "half"] {
        std::fs::write(left.join(name), b"of a server that was killed").unwrap();
    }
    let _other = beside(&lab).await;
    assert!(on_its_way.exists());
    assert!(!left.exists());
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn a_folder_of_servers_is_not_one_of_sqlite() {
    let lab = Lab::open(LONG).await;
    let alone = Store::open(StoreOptions::new(lab.folder.path())).await;
    let refused = alone.expect_err("it is in use").to_string();
    assert!(refused.contains("in use"), "{refused}");
}

/// All that clients see of a lab.
async fn picture(store: &Store) -> Value {
    let filter = JobFilter::default();
    let jobs = store.jobs(&filter, None, 100).await.unwrap();
    let mut of_jobs = Vec::new();
    for job in &jobs.items {
        of_jobs.push(json!({
            "job": store.job(job.id).await.unwrap(),
            "files": store.files(job.id).await.unwrap(),
            "log": store.log(job.id, 0).await.unwrap(),
            "points": store.curve(job.id, 0, None).await.unwrap().points,
        }));
    }
    let now = loadframe_api::Timestamp::now();
    let trash = store.trash(TrashSight::Everything, None, 100, now).await;
    let found = JobFilter {
        q: Some("Wet strip".to_owned()),
        ..filter
    };
    json!({
        "jobs": of_jobs,
        "trash": trash.unwrap().items,
        "people": store.people().await.unwrap(),
        "found": store.jobs(&found, None, 100).await.unwrap().items.len(),
        "events": store.last_event().await,
    })
}

/// Until the tasks of a store that was dropped have let go of its folder.
async fn moved(folder: &tempfile::TempDir, server: &DatabasePlace, back: bool) -> u64 {
    for _ in 0..100 {
        match move_store(folder.path(), server, back).await {
            Err(loadframe_server::store::StoreError::InUse(_)) => {
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
            report => return report.unwrap().rows,
        }
    }
    panic!("the folder stays in use");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs PostgreSQL: tests/postgres store"]
async fn a_lab_moves_to_postgresql_and_back_with_all_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let server = options(&folder, LONG).database;
    let at = |database: &DatabasePlace| StoreOptions {
        database: database.clone(),
        ..options(&folder, LONG)
    };
    let in_folder = DatabasePlace::Folder;
    let store = Store::open(at(&in_folder)).await.unwrap();
    let lab = Lab {
        store,
        folder: tempfile::tempdir().unwrap(),
    };
    lab.submit_with("Wet strip, \u{e4}ltere Probe", 3).await;
    let lease = lab.lease().await;
    let report = ProgressReport {
        progress: 0.5,
        phase: "pulling".to_owned(),
        eta_s: Some(1.5),
        points: Some(CurveBlock {
            first: 0,
            columns: vec!["a".to_owned(), "b".to_owned()],
            rows: vec![vec![0.1, -2e-300], vec![0.2, 3.0]],
        }),
        log: vec!["a line".to_owned()],
        log_from: None,
    };
    lab.report(key(&lease), &report).await.unwrap();
    lab.checkpoint_with(&lease, b"state", 1.25).await;
    lab.finish(&lease).await;
    let deleted = lab.submit().await;
    lab.discard(deleted).await.unwrap();
    lab.submit().await;
    lab.create_first_administrator("Anna", "a long enough password")
        .await
        .unwrap();
    let before = picture(&lab.store).await;
    assert_eq!(before["found"], 1);
    drop(lab);

    let rows = moved(&folder, &server, false).await;
    assert!(!folder.path().join("loadframe.db").exists());
    let store = Store::open(at(&server)).await.unwrap();
    assert_eq!(picture(&store).await, before);
    // numbers go on where they were, and what triggers keep was not counted twice
    assert_eq!(store.counts().await.unwrap().queued, 1);
    let lab = Lab {
        store,
        folder: tempfile::tempdir().unwrap(),
    };
    let next = lab.submit().await;
    assert_eq!(lab.view(next).await.position, Some(2));
    let before = picture(&lab.store).await;
    drop(lab);

    let again = moved(&folder, &server, true).await;
    assert!(again > rows);
    let store = Store::open(at(&in_folder)).await.unwrap();
    assert_eq!(picture(&store).await, before);
    assert_eq!(store.counts().await.unwrap().queued, 2);
}
