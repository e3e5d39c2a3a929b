//! Files of every size arrive as they are: small ones are in memory until they go to the disk in one go.
use loadframe_api::sha256_hex;
use loadframe_api::worker::CompleteRequest;

use crate::lab::{LONG, Lab, is_invalid, key};
use crate::outcome::outcome;

/// Files of fewer bytes are in memory.
const IN_MEMORY: usize = 256 << 10;

#[tokio::test]
async fn files_of_any_size_arrive_as_they_are_however_often() {
    let lab = Lab::open(LONG).await;
    let job = lab.submit().await;
    let lease = lab.lease().await;
    let sizes = [
        0,
        1,
        IN_MEMORY - 1,
        IN_MEMORY,
        IN_MEMORY + 1,
        5 * IN_MEMORY + 3,
    ];
    let content = |size: usize| -> Vec<u8> {
        (0..size)
            .map(|place| (place * 31 + size) as u8 ^ (place >> 8) as u8)
            .collect()
    };
    let mut files = Vec::new();
    for size in sizes {
        let (name, bytes) = (format!("{size}.bin"), content(size));
        let other = sha256_hex(b"another content");
        let wrong = lab.upload(key(&lease), &name, &other, &bytes[..]).await;
        assert!(is_invalid(wrong), "{size}");
        let first = lab.put(&lease, &name, &bytes).await;
        let again = lab.put(&lease, &name, &bytes).await;
        assert_eq!(first, again);
        files.push(first);
    }
    assert_eq!(lab.blobs().await, sizes.len());
    let result = outcome(&lease, &files);
    let text = serde_json::to_vec(&result).unwrap();
    files.push(lab.put(&lease, "outcome.json", &text).await);
    let request = CompleteRequest {
        outcome: result,
        files: files.clone(),
    };
    lab.complete(key(&lease), &request).await.unwrap();
    for (file, size) in files.iter().zip(sizes) {
        let path = lab.content(job, file).await.unwrap();
        assert!(std::fs::read(path).unwrap() == content(size), "{size}");
    }
}
