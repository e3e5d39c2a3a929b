//! Servers that come and go.
use std::time::Duration;

use loadframe_api::people::{NewToken, Scope};
use loadframe_api::sha256_hex;
use loadframe_server::store::{IdempotencyKey, Store, StoreError, StoreOptions};
use tokio::runtime::Builder;

use crate::lab::{LONG, Lab, NONE, is_lost, key, options, submission};

#[tokio::test]
async fn a_lease_outlives_the_server() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    // run out when the server comes back; but that was the server's absence, not the worker's
    let lab = lab.reopen(LONG).await;
    assert_eq!(lab.sweep().await.unwrap(), 0);
    lab.heartbeat(key(&lease)).await.unwrap();
    lab.finish(&lease).await;
    assert_eq!(lab.files(id).await.unwrap().len(), 2);
}

#[tokio::test]
async fn a_start_removes_half_received_files_and_lets_those_without_a_row_wait() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.finish(&lease).await;
    let data = lab.folder.path();
    std::fs::write(data.join("incoming/half"), b"half a file").unwrap();
    let orphan = data.join("blobs/ab").join(format!("ab{}", "0".repeat(62)));
    std::fs::write(&orphan, b"renamed, but no row was committed").unwrap();

    let lab = lab.reopen(LONG).await;
    lab.settled_files().await;
    assert!(orphan.exists());
    assert_eq!(lab.counts().await.unwrap().files_unnamed, 1);
    let incoming = std::fs::read_dir(lab.folder.path().join("incoming")).unwrap();
    assert_eq!(incoming.count(), 0);

    let Lab { store, folder } = lab;
    drop(store);
    let patient = StoreOptions {
        unnamed_wait: Duration::ZERO,
        ..options(&folder, LONG)
    };
    let store = Store::open(patient).await.unwrap();
    let lab = Lab { store, folder };
    lab.settled_files().await;
    assert!(!orphan.exists());
    assert_eq!(lab.counts().await.unwrap().files_unnamed, 0);
    assert_eq!(lab.files(id).await.unwrap().len(), 2);
    assert_eq!(lab.blobs().await, 2);
}

#[tokio::test]
async fn a_folder_has_one_server() {
    let lab = Lab::open(LONG).await;
    let second = Store::open(options(&lab.folder, LONG)).await;
    assert!(matches!(second, Err(StoreError::InUse(_))));
    let beside = Store::open_beside(options(&lab.folder, LONG))
        .await
        .unwrap();
    let new = NewToken {
        name: "made beside".to_owned(),
        scope: Scope::Submit,
        days: None,
    };
    let token = beside.create_token(None, new).await.unwrap();
    let hash = sha256_hex(token.secret.as_bytes());
    assert!(lab.caller_by_token(&hash).await.unwrap().is_some());
}

/// Everything in the process that belongs to the store is dropped in the middle of its work, at a
/// different moment each round.
#[test]
fn a_store_dropped_in_its_work_has_kept_what_it_answered_and_doubled_nothing() {
    const JOBS: usize = 60;
    let named = |job: usize| IdempotencyKey {
        key: format!("job-{job}"),
        body_sha256: "body".to_owned(),
    };
    let runtime = || {
        Builder::new_multi_thread()
            .worker_threads(2)
            .enable_all()
            .build()
            .unwrap()
    };
    for round in 0..10 {
        let folder = tempfile::tempdir().unwrap();
        let first = runtime();
        let answered = first.block_on(async {
            let store = Store::open(options(&folder, LONG)).await.unwrap();
            let (tell, mut answers) = tokio::sync::mpsc::unbounded_channel();
            for job in 0..JOBS {
                let (store, tell) = (store.clone(), tell.clone());
                tokio::spawn(async move {
                    let enqueued = store.enqueue(&submission("", 0), Some(named(job))).await;
                    let _ = tell.send((job, enqueued.unwrap().job.id));
                });
            }
            let mut answered = Vec::new();
            while answered.len() < 1 + round * 5 {
                answered.push(answers.recv().await.unwrap());
            }
            answered
        });
        first.shutdown_background();

        runtime().block_on(async {
            let store = reopened(&folder).await;
            for (job, id) in answered {
                assert_eq!(
                    store.job(id).await.unwrap().id,
                    id,
                    "an accepted job was lost"
                );
                let again = store
                    .enqueue(&submission("", 0), Some(named(job)))
                    .await
                    .unwrap();
                assert_eq!((again.job.id, again.replayed), (id, true));
            }
            for job in 0..JOBS {
                store
                    .enqueue(&submission("", 0), Some(named(job)))
                    .await
                    .unwrap();
            }
            assert_eq!(store.counts().await.unwrap().queued, JOBS as u64);
        });
    }
}

/// Opens the store once the dropped one has let go of the folder.
async fn reopened(folder: &tempfile::TempDir) -> Store {
    loop {
        match Store::open(options(folder, LONG)).await {
            Err(StoreError::InUse(_)) => tokio::task::yield_now().await,
            opened => return opened.unwrap(),
        }
    }
}

#[tokio::test]
async fn a_server_killed_between_upload_and_complete_lets_the_worker_go_on() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let result = lab.result(&lease).await;
    let lab = lab.reopen(LONG).await;
    lab.complete(key(&lease), &result).await.unwrap();
    let lab = lab.reopen(LONG).await;
    lab.complete(key(&lease), &result).await.unwrap();
    assert_eq!(lab.files(id).await.unwrap().len(), 2);
    assert!(is_lost(lab.heartbeat(key(&lease)).await));
}
