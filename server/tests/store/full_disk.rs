//! A disk that fills up under the store, and has room again. It is a small one of its own, which only
//! root may mount; elsewhere the tests say so and are done.
#![allow(clippy::print_stderr, reason = "a test that could not run says so")]
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use loadframe_api::{JobOutcome, sha256_hex};
use loadframe_server::store::{Store, StoreError, StoreOptions, UserAction};
use tempfile::TempDir;

use crate::lab::{LONG, Lab, key, options, submission, worker};

/// A small disk, gone when dropped.
struct Disk(TempDir);

impl Disk {
    /// `None`, having said why, where nothing may be mounted.
    fn mount(megabytes: u32) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={megabytes}m"), "tmpfs"])
            .arg(folder.path())
            .output();
        match mounted {
            Ok(output) if output.status.success() => Some(Self(folder)),
            other => {
                eprintln!("not tested: no file system can be mounted here ({other:?})");
                None
            }
        }
    }

    fn data(&self) -> PathBuf {
        self.0.path().join("data")
    }

    /// Takes all the room there is.
    fn fill(&self) -> PathBuf {
        let place = self.0.path().join("filler");
        let mut file = File::create(&place).unwrap();
        for size in [1 << 20, 4096] {
            while file.write_all(&vec![1; size]).is_ok() {}
        }
        place
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(self.0.path()).output();
    }
}

async fn open(data: &Path) -> Store {
    let options = StoreOptions {
        lease: LONG,
        ..StoreOptions::new(data)
    };
    Store::open(options).await.unwrap()
}

fn is_full<T>(result: Result<T, StoreError>) -> bool {
    matches!(result, Err(StoreError::Full))
}

/// Submits until the disk is found to be full.
async fn submit_until_full(store: &Store) {
    for _ in 0..2000 {
        match store.enqueue(&submission("filling", 0), None).await {
            Ok(_) => {}
            Err(StoreError::Full) => return,
            Err(error) => panic!("{error:?}"),
        }
    }
    panic!("two thousand jobs went on a full disk");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_full_disk_keeps_reads_and_cancels_alive_and_heals_by_itself() {
    let Some(disk) = Disk::mount(48) else { return };
    let store = open(&disk.data()).await;
    let looking = tokio::spawn(store.clone().keep_looking_for_room());
    for round in 0..3 {
        let running = store
            .enqueue(&submission("running", 1), None)
            .await
            .unwrap();
        let id = running.job.id;
        let lease = store.claim(&worker("w")).await.unwrap().unwrap();
        assert_eq!(lease.job_id, id, "round {round}");
        assert!(store.try_write().await.is_ok(), "round {round}");
        let filler = disk.fill();
        submit_until_full(&store).await;
        assert!(store.full().is_some() && store.counts().await.unwrap().is_full);

        // what needs room waits
        assert!(is_full(store.try_write().await));
        assert!(is_full(store.claim(&worker("other")).await));
        let content: &[u8] = b"a result";
        let sha256 = sha256_hex(content);
        let upload = store.upload(key(&lease), "a.txt", &sha256, content);
        assert!(is_full(upload.await));
        // what frees or saves something does not, however often
        for _ in 0..200 {
            store.heartbeat(key(&lease)).await.unwrap();
        }
        assert_eq!(store.job(id).await.unwrap().id, id);
        store.request(id, UserAction::Cancel).await.unwrap();
        let release = loadframe_api::worker::ReleaseReason::Cancelled;
        store.release(key(&lease), release).await.unwrap();
        let job = store.job(id).await.unwrap();
        assert_eq!(job.outcome, Some(JobOutcome::Cancelled));
        store.delete(id).await.unwrap();

        // nobody has to tell it that there is room again
        std::fs::remove_file(filler).unwrap();
        while store.full().is_some() {
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
        let page = store.jobs(&Default::default(), None, 1000).await.unwrap();
        for job in page.items {
            store.request(job.id, UserAction::Cancel).await.unwrap();
            store.delete(job.id).await.unwrap();
        }
    }
    looking.abort();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_starts_on_a_full_disk() {
    let Some(disk) = Disk::mount(48) else { return };
    let store = open(&disk.data()).await;
    let id = store
        .enqueue(&submission("", 0), None)
        .await
        .unwrap()
        .job
        .id;
    drop(store);
    disk.fill();
    let store = open(&disk.data()).await;
    assert_eq!(store.job(id).await.unwrap().id, id);
    store.request(id, UserAction::Cancel).await.unwrap();
}

#[tokio::test]
async fn a_store_with_room_has_its_reserve_and_writes() {
    let lab = Lab::open(LONG).await;
    let reserve = lab.folder.path().join("reserve");
    assert_eq!(std::fs::metadata(&reserve).unwrap().len(), 16 << 20);
    assert!(lab.full().is_none() && lab.try_write().await.is_ok());
    // a command beside it leaves it alone
    Store::open_beside(options(&lab.folder, LONG))
        .await
        .unwrap();
    assert!(reserve.exists());
}
