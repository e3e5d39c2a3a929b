//! Databases that are missing, foreign or old; files that are missing or have changed; copies of both.
use std::fs;
use std::path::Path;
use std::time::Duration;

use loadframe_server::store::{Loss, Store, StoreError, StoreOptions, backup, restore};
use tempfile::tempdir;

use crate::lab::{LONG, Lab, is_missing, key, options, stored};

/// Takes the database away from a closed store.
fn without_database(data: &Path) {
    for name in ["loadframe.db", "loadframe.db-wal", "loadframe.db-shm"] {
        let _ = fs::remove_file(data.join(name));
    }
}

async fn refused(data: &Path) -> String {
    match Store::open(StoreOptions::new(data)).await {
        Err(StoreError::NotTogether(sentence)) => sentence,
        other => panic!("it should not open: {other:?}"),
    }
}

/// Changes a byte of a stored file.
fn spoil(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    bytes[0] ^= 1;
    fs::write(path, bytes).unwrap();
}

/// A job that has succeeded, with a file of this content; its id.
async fn finished(lab: &Lab, content: &[u8]) -> uuid::Uuid {
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let own = lab.put(&lease, "own.txt", content).await;
    let mut result = lab.result(&lease).await;
    result.files.push(own);
    lab.complete(key(&lease), &result).await.unwrap();
    id
}

#[tokio::test]
async fn a_missing_or_empty_database_refuses_to_start_and_no_file_is_touched() {
    let lab = Lab::open(LONG).await;
    finished(&lab, b"kept").await;
    let Lab { store, folder } = lab;
    store.settled_files().await;
    let copy = tempdir().unwrap();
    backup(folder.path(), copy.path()).await.unwrap();
    drop(store);
    let data = folder.path();
    let before = stored(data);
    assert_eq!(before.len(), 3);
    for content in [None, Some(b"".as_slice())] {
        without_database(data);
        if let Some(content) = content {
            fs::write(data.join("loadframe.db"), content).unwrap();
        }
        let sentence = refused(data).await;
        assert!(sentence.contains("loadframe restore"), "{sentence}");
        // a command beside it makes no database that would be taken for its own
        let beside = Store::make_beside(StoreOptions::new(data)).await;
        assert!(matches!(beside, Err(StoreError::NotTogether(_))));
        let beside = Store::open_beside(StoreOptions::new(data)).await;
        assert!(matches!(beside, Err(StoreError::Invalid(_))));
        assert_eq!(stored(data), before);
    }
    without_database(data);
    fs::copy(copy.path().join("loadframe.db"), data.join("loadframe.db")).unwrap();
    let store = Store::open(options(&folder, LONG)).await.unwrap();
    assert_eq!(store.counts().await.unwrap().succeeded, 1);
}

#[tokio::test]
async fn files_of_another_store_or_none_at_all_refuse_to_start() {
    let [one, other] = [Lab::open(LONG).await, Lab::open(LONG).await];
    finished(&one, b"one").await;
    finished(&other, b"other").await;
    let [one, other] = [one, other].map(|Lab { store, folder }| {
        drop(store);
        folder
    });
    let [mine, away] = [one.path().join("blobs"), one.path().join("away")];
    fs::rename(&mine, &away).unwrap();
    assert!(refused(one.path()).await.contains("gone"));
    let _ = fs::remove_dir_all(&mine);
    fs::rename(other.path().join("blobs"), &mine).unwrap();
    assert!(refused(one.path()).await.contains("another"));
    assert_eq!(stored(one.path()).len(), 3);
    fs::remove_dir_all(&mine).unwrap();
    fs::rename(&away, &mine).unwrap();
    assert!(Store::open(options(&one, LONG)).await.is_ok());
}

#[tokio::test]
async fn an_older_database_that_was_put_back_deletes_nothing() {
    let lab = Lab::open(LONG).await;
    let known = finished(&lab, b"known to both").await;
    let folder = tempdir().unwrap();
    let old = folder.path().join("old");
    backup(lab.folder.path(), &old).await.unwrap();
    let lab = lab.reopen(LONG).await;
    finished(&lab, b"known to the newer one alone").await;
    let Lab { store, folder } = lab;
    drop(store);
    let data = folder.path();
    let before = stored(data).len();
    without_database(data);
    fs::copy(old.join("loadframe.db"), data.join("loadframe.db")).unwrap();
    // not even when nothing is to wait
    let hasty = || StoreOptions {
        unnamed_wait: Duration::ZERO,
        ..options(&folder, LONG)
    };
    for _ in 0..2 {
        let store = Store::open(hasty()).await.unwrap();
        store.settled_files().await;
        assert_eq!(stored(data).len(), before);
        // its own file; the two others are the same in every job here
        assert_eq!(store.counts().await.unwrap().files_unnamed, 1);
        assert_eq!(store.files(known).await.unwrap().len(), 3);
    }
    // a person may say that they are not wanted
    let store = Store::open(hasty()).await.unwrap();
    store.release_unnamed().await.unwrap();
    drop(store);
    let store = Store::open(hasty()).await.unwrap();
    store.settled_files().await;
    assert_eq!(stored(data).len(), before - 1);
    assert_eq!(store.scrub(None).await.unwrap().lost, []);
}

#[tokio::test]
async fn changed_and_missing_files_are_errors_that_name_job_and_file() {
    let lab = Lab::open(LONG).await;
    let id = finished(&lab, b"own").await;
    let file = lab.file(id, "own.txt").await.unwrap();
    let path = lab.content(id, &file).await.unwrap();
    spoil(&path);
    let error = lab.content(id, &file).await.unwrap_err();
    let sentence = error.to_string();
    assert!(
        sentence.starts_with(&format!("own.txt of job {id} is not what was stored")),
        "{sentence}"
    );
    // what was found is kept for people, and is not given out again
    let aside = fs::read_dir(lab.folder.path().join("set-aside")).unwrap();
    assert_eq!(aside.count(), 1);
    let again = lab.content(id, &file).await.unwrap_err().to_string();
    assert!(
        again.contains("own.txt") && again.contains("missing"),
        "{again}"
    );
    // the same content from another run heals it
    finished(&lab, b"own").await;
    assert_eq!(
        fs::read(lab.content(id, &file).await.unwrap()).unwrap(),
        b"own"
    );
}

#[tokio::test]
async fn an_upload_is_not_taken_for_a_stored_file_that_has_changed() {
    let lab = Lab::open(LONG).await;
    let first = finished(&lab, b"own").await;
    let file = lab.file(first, "own.txt").await.unwrap();
    spoil(&lab.content(first, &file).await.unwrap());
    let second = finished(&lab, b"own").await;
    for id in [first, second] {
        assert_eq!(
            fs::read(lab.content(id, &file).await.unwrap()).unwrap(),
            b"own"
        );
    }
}

#[tokio::test]
async fn a_scrub_finds_what_is_lost_and_says_whose_it_is() {
    let lab = Lab::open(LONG).await;
    let id = finished(&lab, b"own").await;
    let clean = lab.scrub(None).await.unwrap();
    assert_eq!((clean.files, clean.lost.len(), clean.unnamed), (3, 0, 0));
    let path = |name: &'static str| {
        let lab = &lab;
        async move {
            let file = lab.file(id, name).await.unwrap();
            lab.content(id, &file).await.unwrap()
        }
    };
    spoil(&path("own.txt").await);
    fs::remove_file(path("curve.csv").await).unwrap();
    let report = lab.scrub(Some(1e9)).await.unwrap();
    let mut lost: Vec<_> = report
        .lost
        .iter()
        .map(|lost| (lost.job, &*lost.file, lost.loss))
        .collect();
    lost.sort_by_key(|(_, file, _)| file.to_owned());
    assert_eq!(
        lost,
        [
            (id, "curve.csv", Loss::Missing),
            (id, "own.txt", Loss::Changed)
        ]
    );
    assert_eq!(lab.counts().await.unwrap().files_lost, 2);
}

#[tokio::test]
async fn a_job_whose_checkpoint_has_changed_begins_anew_and_says_so() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.checkpoint_with(&lease, b"state", 1.0).await;
    let (_, path) = lab.checkpoint(key(&lease), None).await.unwrap();
    spoil(&path);
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(log[0].message.contains("begins anew"), "{log:?}");
    // it can leave another, and nothing holds the job
    lab.checkpoint_with(&lease, b"state", 2.0).await;
    assert!(lab.checkpoint(key(&lease), None).await.is_ok());
    lab.finish(&lease).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_taken_while_jobs_come_and_go_is_whole_and_can_be_restored() {
    let lab = Lab::open(LONG).await;
    let mut kept = vec![finished(&lab, b"before").await];
    let store = lab.store.clone();
    let folder = tempdir().unwrap();
    let (copies, mut round) = (folder.path().to_owned(), 0_u32);
    let data = lab.folder.path().to_owned();
    let copying = tokio::spawn(async move {
        let mut copied = Vec::new();
        for number in 0..5 {
            let to = copies.join(format!("copy{number}"));
            let report = backup(&data, &to).await.unwrap();
            assert_eq!(report.lost, [], "copy {number}");
            copied.push(to);
        }
        copied
    });
    while !copying.is_finished() {
        round += 1;
        let id = finished(&lab, format!("content {round}").as_bytes()).await;
        if round.is_multiple_of(2) {
            store.delete(id).await.unwrap();
        } else {
            kept.push(id);
        }
    }
    for copy in copying.await.unwrap() {
        let place = tempdir().unwrap();
        let data = place.path().join("data");
        let report = restore(&copy, &data, false).await.unwrap();
        assert_eq!(report.lost, []);
        let restored = Store::open(StoreOptions::new(&data)).await.unwrap();
        let scrubbed = restored.scrub(None).await.unwrap();
        assert_eq!((scrubbed.lost.len(), scrubbed.files), (0, report.files));
        // a prefix of the history: of what was kept all up to one, and nothing after it
        let mut is_there = Vec::new();
        for id in &kept {
            is_there.push(restored.job(*id).await.is_ok());
        }
        let known = is_there.iter().take_while(|there| **there).count();
        assert!(known >= 1);
        assert!(is_there[known..].iter().all(|there| !there), "{is_there:?}");
    }
}

#[tokio::test]
async fn a_backup_that_has_changed_is_not_restored_unless_asked_and_no_store_is_overwritten() {
    let lab = Lab::open(LONG).await;
    let id = finished(&lab, b"own").await;
    let folder = tempdir().unwrap();
    let copy = folder.path().join("copy");
    backup(lab.folder.path(), &copy).await.unwrap();
    let again = backup(lab.folder.path(), &copy).await;
    assert!(matches!(again, Err(StoreError::Invalid(_))));
    let over = restore(&copy, lab.folder.path(), false).await;
    assert!(matches!(over, Err(StoreError::Invalid(_))));

    let own = lab.file(id, "own.txt").await.unwrap().sha256;
    spoil(&copy.join("blobs").join(&own[..2]).join(&own));
    let data = folder.path().join("data");
    let report = restore(&copy, &data, false).await.unwrap();
    assert_eq!((report.lost.len(), &*report.lost[0].file), (1, "own.txt"));
    assert!(!data.join("loadframe.db").exists());
    let data = folder.path().join("all the same");
    restore(&copy, &data, true).await.unwrap();
    let restored = Store::open(StoreOptions::new(&data)).await.unwrap();
    assert_eq!(restored.scrub(None).await.unwrap().lost.len(), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn time_in_which_the_database_cannot_be_written_is_not_charged_to_workers() {
    use sqlx::{ConnectOptions as _, Executor as _};
    let lab = Lab::open(Duration::from_secs(2)).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let database = lab.folder.path().join("loadframe.db");
    let other = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    let mut other = other.connect().await.unwrap();
    other.execute("BEGIN IMMEDIATE").await.unwrap();
    let sweeping = tokio::spawn(lab.store.clone().keep_sweeping());
    // the lease runs out and the sweeper waits to say so, before a healthy worker knocks
    tokio::time::sleep(Duration::from_millis(4000)).await;
    let store = lab.store.clone();
    let knocking = tokio::spawn(async move { store.heartbeat(key(&lease)).await });
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert!(!knocking.is_finished());
    other.execute("ROLLBACK").await.unwrap();
    assert!(knocking.await.unwrap().is_ok(), "it still holds its lease");
    sweeping.abort();
    assert_eq!(lab.view(id).await.status, loadframe_api::JobStatus::Running);
}

/// Runs a statement on the database of a closed store, or beside it.
async fn tampered(data: &Path, statement: &'static str) {
    use sqlx::{ConnectOptions as _, Executor as _};
    let database = data.join("loadframe.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    let mut connection = options.connect().await.unwrap();
    connection.execute(statement).await.unwrap();
}

#[tokio::test]
async fn a_database_of_a_newer_version_is_refused_in_those_words() {
    let Lab { store, folder } = Lab::open(LONG).await;
    drop(store);
    tampered(
        folder.path(),
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
         VALUES (999, 'of tomorrow', 1, x'00', 0)",
    )
    .await;
    let refused = Store::open(options(&folder, LONG)).await.unwrap_err();
    let sentence = refused.to_string();
    assert!(
        sentence.contains("newer version of loadframe") && sentence.contains("step 999"),
        "{sentence}"
    );
}

#[tokio::test]
async fn one_job_that_cannot_be_read_does_not_empty_the_list() {
    let lab = Lab::open(LONG).await;
    let [first, broken, last] = [lab.submit().await, lab.submit().await, lab.submit().await];
    tampered(
        lab.folder.path(),
        "UPDATE jobs SET kind = 'of tomorrow' WHERE seq = 2",
    )
    .await;
    let page = lab.jobs(&Default::default(), None, 10).await.unwrap();
    let ids: Vec<_> = page.items.iter().map(|job| job.id).collect();
    assert_eq!((ids, page.unreadable), (vec![last, first], 1));
    assert!(lab.job(broken).await.is_err());
    // nor does it keep the events of others from being told
    assert!(!lab.events_after(0, None, 100).await.unwrap().is_empty());
}

#[tokio::test]
async fn while_a_backup_is_taken_files_stay_and_nobody_waits_for_it() {
    let lab = Lab::open(LONG).await;
    let id = finished(&lab, b"own").await;
    let file = lab.file(id, "own.txt").await.unwrap();
    let path = lab.content(id, &file).await.unwrap();
    // what a backup holds
    let backup = fs::File::open(lab.folder.path().join("removal.lock")).unwrap();
    backup.lock_shared().unwrap();
    lab.store.delete(id).await.unwrap();
    assert!(path.exists());
    drop(backup);
    while path.exists() {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}
