//! Losses that are forgiven, and checkpoints that cannot be used.
use loadframe_api::worker::{ClaimRequest, Lease};
use loadframe_api::{JobOutcome, JobStatus};
use loadframe_server::store::UserAction;

use crate::lab::{LONG, Lab, NONE, is_missing, key, worker};

#[tokio::test]
async fn leases_that_were_never_used_cost_nothing() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    for _ in 0..5 {
        lab.lease().await;
        assert_eq!(lab.sweep().await.unwrap(), 1);
        let job = lab.view(id).await;
        assert_eq!(job.status, JobStatus::Queued);
        assert!(job.reason.contains("never heard of"), "{}", job.reason);
    }
}

#[tokio::test]
async fn a_newer_checkpoint_forgives_the_losses_before_it() {
    let lab = Lab::open(NONE).await;
    let id = lab.submit().await;
    // every attempt comes further before its worker dies
    for attempt in 1..=8 {
        let lease = lab.lease().await;
        let wall_s = f64::from(attempt);
        lab.checkpoint_with(&lease, format!("{attempt}").as_bytes(), wall_s)
            .await;
        lab.sweep().await.unwrap();
        assert_eq!(lab.view(id).await.status, JobStatus::Queued, "{attempt}");
    }
    // from here on none does: the one after the last that did was the first loss
    for loss in 2..=3 {
        let lease = lab.lease().await;
        lab.checkpoint_with(&lease, b"no further", 8.0).await;
        lab.sweep().await.unwrap();
        assert_eq!(lab.view(id).await.status == JobStatus::Finished, loss == 3);
    }
    assert_eq!(lab.view(id).await.outcome, Some(JobOutcome::Quarantined));
    // what it had is there for whoever asks again
    lab.request(id, UserAction::Retry).await.unwrap();
    let kept = lab.lease().await.checkpoint.expect("a checkpoint");
    assert_eq!(kept.wall_s.to_bits(), 8.0_f64.to_bits());
}

/// Changes the bytes of the newest checkpoint.
async fn spoil_newest(lab: &Lab, lease: &Lease) {
    let (_, path) = lab.checkpoint(key(lease), None).await.unwrap();
    std::fs::write(path, b"something else").unwrap();
}

#[tokio::test]
async fn a_broken_checkpoint_leaves_the_one_before_it_and_then_the_start() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let first = lab.put(&lease, "first.vtp", b"first").await;
    lab.checkpoint_with(&lease, b"state 1", 1.0).await;
    lab.put(&lease, "second.vtp", b"second").await;
    lab.checkpoint_with(&lease, b"state 2", 2.0).await;
    spoil_newest(&lab, &lease).await;
    let release = loadframe_api::worker::ReleaseReason::Shutdown;
    lab.release(key(&lease), release).await.unwrap();

    let lease = lab.lease().await;
    let (info, path) = lab.checkpoint(key(&lease), None).await.unwrap();
    assert_eq!(std::fs::read(path).unwrap(), b"state 1");
    assert_eq!(info.files, [first]);
    let log = lab.log(id, 0).await.unwrap();
    assert!(
        log[0]
            .message
            .ends_with("the job goes on from the one before"),
        "{log:?}"
    );
    // the files that came with the broken one are not this attempt's any more
    let mut result = lab.result(&lease).await;
    result.files.push(loadframe_api::FileEntry {
        name: "second.vtp".to_owned(),
        bytes: 6,
        sha256: loadframe_api::sha256_hex(b"second"),
    });
    assert!(lab.complete(key(&lease), &result).await.is_err());

    spoil_newest(&lab, &lease).await;
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(log[1].message.ends_with("the job begins anew"), "{log:?}");
    lab.finish(&lease).await;
}

#[tokio::test]
async fn a_checkpoint_whose_files_are_gone_cannot_be_used() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let file = lab.put(&lease, "snapshot.vtp", b"a picture").await;
    lab.checkpoint_with(&lease, b"state", 1.0).await;
    let blob = crate::lab::stored(lab.folder.path())
        .into_iter()
        .find(|path| path.ends_with(&file.sha256));
    std::fs::remove_file(blob.unwrap()).unwrap();
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(
        log[0]
            .message
            .starts_with("snapshot.vtp of the checkpoint is missing"),
        "{log:?}"
    );
}

#[tokio::test]
async fn a_worker_that_cannot_use_a_checkpoint_gets_the_one_before_and_none_is_lost() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    lab.checkpoint_with(&lease, b"state 1", 1.0).await;
    lab.checkpoint_with(&lease, b"state 2", 2.0).await;
    lab.checkpoint_with(&lease, b"state 3", 3.0).await;
    let bytes = async |before: Option<&[u8]>| {
        let before = before.map(loadframe_api::sha256_hex);
        let found = lab.checkpoint(key(&lease), before.as_deref()).await;
        found.map(|(_, path)| std::fs::read(path).unwrap())
    };
    assert_eq!(bytes(None).await.unwrap(), b"state 3");
    assert_eq!(bytes(Some(b"state 3")).await.unwrap(), b"state 2");
    assert!(is_missing(bytes(Some(b"state 2")).await), "two are kept");
    assert_eq!(bytes(None).await.unwrap(), b"state 3");
}

#[tokio::test]
async fn a_worker_goes_on_only_from_what_its_own_build_has_made() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let of_build = |engine: &str| ClaimRequest {
        engine_version: engine.to_owned(),
        ..worker(engine)
    };
    let claim = async |worker: ClaimRequest| {
        let lease = lab.claim(&worker).await.unwrap();
        lease.expect("a job")
    };
    let release = loadframe_api::worker::ReleaseReason::Shutdown;
    let lease = claim(of_build("0.2.0+aaaa")).await;
    lab.checkpoint_with(&lease, b"of a", 1.0).await;
    lab.release(key(&lease), release).await.unwrap();
    let lease = claim(of_build("0.2.0+bbbb")).await;
    assert!(lease.checkpoint.is_none());
    assert!(is_missing(lab.checkpoint(key(&lease), None).await));
    let log = lab.log(id, 0).await.unwrap();
    assert!(
        log[0].message.contains("0.2.0+aaaa") && log[0].message.contains("0.2.0+bbbb"),
        "{log:?}"
    );
    lab.release(key(&lease), release).await.unwrap();
    let lease = claim(of_build("0.2.0+aaaa")).await;
    assert!(lease.checkpoint.is_some(), "its own is still there");
    let engines: Vec<String> = lab
        .view(id)
        .await
        .attempts
        .into_iter()
        .map(|attempt| attempt.engine)
        .collect();
    assert_eq!(engines, ["0.2.0+aaaa", "0.2.0+bbbb", "0.2.0+aaaa"]);
}
