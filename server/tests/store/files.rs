//! Bytes on their way in, and out again.
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll};

use loadframe_api::sha256_hex;
use loadframe_api::worker::ReleaseReason;
use loadframe_server::store::StoreError;
use tokio::io::{AsyncRead, ReadBuf};

use crate::lab::{LONG, Lab, is_invalid, is_lost, is_missing, key};

/// A body that breaks off after its first bytes.
struct Broken<'b>(&'b [u8]);

impl AsyncRead for Broken<'_> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        if self.0.is_empty() {
            return Poll::Ready(Err(io::ErrorKind::ConnectionReset.into()));
        }
        let (now, later) = self.0.split_at(self.0.len().min(buffer.remaining()));
        buffer.put_slice(now);
        self.0 = later;
        Poll::Ready(Ok(()))
    }
}

/// Files on their way; servers that share a folder have one each for them, with a lock.
fn incoming(lab: &Lab) -> usize {
    let entries = |folder: &std::path::Path| {
        let entries = std::fs::read_dir(folder).unwrap();
        entries
            .map(|entry| entry.unwrap().path())
            .collect::<Vec<_>>()
    };
    let all = entries(&lab.folder.path().join("incoming"));
    let (folders, files): (Vec<_>, Vec<_>) = all.into_iter().partition(|path| path.is_dir());
    let of_servers = folders.iter().map(|folder| entries(folder).len() - 1);
    files.len() + of_servers.sum::<usize>()
}

#[tokio::test]
async fn what_does_not_arrive_whole_and_right_leaves_nothing() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    let content: &[u8] = b"content";
    let right = sha256_hex(content);
    let wrong = "0".repeat(64);
    assert!(is_invalid(
        lab.upload(key(&lease), "a.txt", &wrong, content).await
    ));
    assert!(is_invalid(
        lab.upload(key(&lease), "a.txt", "../../etc/passwd", content)
            .await
    ));
    assert!(is_invalid(
        lab.upload(key(&lease), "../a.txt", &right, content).await
    ));
    assert!(is_invalid(
        lab.upload(key(&lease), "partial/a.txt", &right, content)
            .await
    ));
    let broken = lab
        .upload(key(&lease), "a.txt", &right, Broken(b"con"))
        .await;
    assert!(matches!(broken, Err(StoreError::Interrupted(_))));
    assert_eq!((lab.blobs().await, incoming(&lab)), (0, 0));

    let mut forged = key(&lease);
    forged.token = uuid::Uuid::new_v4();
    assert!(is_lost(lab.upload(forged, "a.txt", &right, content).await));
    lab.release(key(&lease), ReleaseReason::Shutdown)
        .await
        .unwrap();
    assert!(is_lost(
        lab.upload(key(&lease), "a.txt", &right, content).await
    ));
    assert_eq!((lab.blobs().await, incoming(&lab)), (0, 0));
}

/// A request ends with its connection, whatever it was about: a file without a row goes.
#[tokio::test]
async fn an_upload_may_be_broken_off_at_any_moment_and_leaves_nothing() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    let (mut moments, mut ended) = (0, 0);
    while ended < 3 {
        let content = format!("content {moments}");
        let (name, sha256) = (format!("{moments}.txt"), sha256_hex(content.as_bytes()));
        let mut upload = Box::pin(lab.upload(key(&lease), &name, &sha256, content.as_bytes()));
        for _ in 0..moments {
            if futures_util::poll!(&mut upload).is_ready() {
                ended += 1;
                break;
            }
            tokio::time::sleep(std::time::Duration::from_micros(50)).await;
        }
        moments += 1;
    }
    assert!(moments > 4, "{moments}");
    lab.release(key(&lease), ReleaseReason::Shutdown)
        .await
        .unwrap();
    lab.delete(id).await.unwrap();
    // what was begun goes on to its end, and is then let go of
    for _ in 0..500 {
        if lab.blobs().await == 0 {
            break;
        }
        tokio::time::sleep(std::time::Duration::from_millis(20)).await;
    }
    assert_eq!((lab.blobs().await, incoming(&lab)), (0, 0));
}

#[tokio::test]
async fn an_attempt_that_ends_without_a_result_leaves_only_its_checkpoint() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.put(&lease, "kept.vtp", b"before the checkpoint").await;
    lab.checkpoint_with(&lease, b"first", 1.0).await;
    lab.checkpoint_with(&lease, b"second", 2.0).await;
    lab.put(&lease, "lost.vtp", b"after the checkpoint").await;
    lab.release(key(&lease), ReleaseReason::Shutdown)
        .await
        .unwrap();

    let next = lab.lease().await;
    let (_, path) = lab.checkpoint(key(&next), None).await.unwrap();
    assert_eq!(std::fs::read(path).unwrap(), b"second");
    lab.finish(&next).await;
    // the checkpoint has served, and what it brought was not named by the result
    let other = lab.submit().await;
    lab.delete(other).await.unwrap();
    assert_eq!(lab.blobs().await, lab.files(id).await.unwrap().len());
    assert!(is_missing(lab.file(id, "kept.vtp").await));
    assert!(is_lost(lab.checkpoint(key(&next), None).await));
}

#[tokio::test]
async fn an_upload_replaces_the_one_before_it() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.put(&lease, "notes.txt", b"first").await;
    let second = lab.put(&lease, "notes.txt", b"second").await;
    let mut result = lab.result(&lease).await;
    result.files.push(second);
    lab.complete(key(&lease), &result).await.unwrap();
    let file = lab.file(id, "notes.txt").await.unwrap();
    let path = lab.content(id, &file).await.unwrap();
    assert_eq!(std::fs::read(path).unwrap(), b"second");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_content_uploaded_and_deleted_at_once_is_never_lost() {
    let lab = Lab::open(LONG).await;
    for round in 0..30 {
        let old = lab.submit().await;
        let lease = lab.lease().await;
        lab.finish(&lease).await;
        let new = lab.submit().await;
        let lease = lab.lease().await;
        let store = lab.store.clone();
        let deleting = tokio::spawn(async move { store.delete(old).await });
        lab.finish(&lease).await;
        deleting.await.unwrap().unwrap();
        for file in lab.files(new).await.unwrap() {
            let path = lab.content(new, &file).await.unwrap();
            assert_eq!(
                std::fs::metadata(path).unwrap().len(),
                file.bytes,
                "round {round}"
            );
        }
        lab.delete(new).await.unwrap();
        assert_eq!(lab.blobs().await, 0);
    }
}

#[tokio::test]
async fn an_upload_that_broke_off_is_gone_on_with_by_its_sender_alone() {
    let lab = Lab::open(LONG).await;
    lab.submit().await;
    let lease = lab.lease().await;
    let content: Vec<u8> = (0..3_000_000_u32)
        .map(|number| (number % 251) as u8)
        .collect();
    let sha256 = sha256_hex(&content);
    let part = async || lab.uploaded_part(key(&lease), &sha256).await.unwrap();
    assert_eq!(part().await, 0);
    // less than a megabyte is sent anew
    let begun = lab.upload(key(&lease), "a.bin", &sha256, Broken(&content[..900_000]));
    assert!(matches!(begun.await, Err(StoreError::Interrupted(_))));
    assert_eq!(part().await, 0);
    let begun = lab.upload(key(&lease), "a.bin", &sha256, Broken(&content[..1_200_000]));
    assert!(matches!(begun.await, Err(StoreError::Interrupted(_))));
    assert_eq!(part().await, 1_200_000);
    let further = Broken(&content[1_200_000..2_000_000]);
    let further = lab.upload_rest(key(&lease), "a.bin", &sha256, 1_200_000, further);
    assert!(matches!(further.await, Err(StoreError::Interrupted(_))));
    assert_eq!(part().await, 2_000_000);
    let mut forged = key(&lease);
    forged.token = uuid::Uuid::new_v4();
    assert!(is_lost(lab.uploaded_part(forged, &sha256).await));
    let rest = lab.upload_rest(
        key(&lease),
        "a.bin",
        &sha256,
        2_000_000,
        &content[2_000_000..],
    );
    let entry = rest.await.unwrap();
    assert_eq!(
        (entry.bytes, entry.sha256.as_str()),
        (3_000_000, sha256.as_str())
    );
    assert_eq!(part().await, 0);
    // where other bytes are kept than the sender believes, it is told to ask again
    let unknown = lab.upload_rest(key(&lease), "a.bin", &sha256, 5, &content[5..]);
    assert!(matches!(unknown.await, Err(StoreError::Unavailable)));
    for strange in ["", "../../lock", &sha256[..63]] {
        assert_eq!(lab.uploaded_part(key(&lease), strange).await.unwrap(), 0);
    }
}
