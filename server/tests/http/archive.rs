//! The zip of everything.
use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::support::{Lab, request};

#[tokio::test]
async fn the_zip_holds_every_file_under_the_jobs_name() {
    let long = vec![b'x'; 300_000];
    let lab = Lab::open().await;
    let id = lab
        .finished(&[("curve.csv", &long), ("snapshots/a.vtp", b"vtk")])
        .await;
    let answer = lab.get(&format!("/v1/jobs/{id}/archive.zip")).await;
    assert_eq!(
        (answer.status, answer.header("content-type")),
        (200, "application/zip")
    );
    let folder = format!("small-fabric-quick-look-{}", &id.simple().to_string()[24..]);
    assert_eq!(
        answer.header("content-disposition"),
        format!("attachment; filename=\"{folder}.zip\"")
    );
    let mut zip = ZipArchive::new(Cursor::new(answer.body.to_vec())).expect("a zip");
    let names: Vec<String> = zip
        .file_names()
        .map(|name| name.expect("text").into_owned())
        .collect();
    let expected = ["curve.csv", "outcome.json", "snapshots/a.vtp"];
    assert_eq!(names, expected.map(|name| format!("{folder}/{name}")));
    for (name, content) in [("curve.csv", &long[..]), ("snapshots/a.vtp", b"vtk")] {
        let mut bytes = Vec::new();
        let mut file = zip.by_name(&format!("{folder}/{name}")).expect("the file");
        file.read_to_end(&mut bytes).expect("readable");
        assert_eq!(bytes, content);
    }
}

#[tokio::test]
async fn a_job_without_files_has_no_archive() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    lab.get(&format!("/v1/jobs/{id}/archive.zip"))
        .await
        .problem(404, "not-found");
}

/// A client that leaves in the middle frees the thread that wrote for it.
#[tokio::test]
async fn a_download_broken_off_is_not_written_on() {
    // does not compress, and is longer than what waits between writer and connection
    let mut state = 1_u32;
    let noise = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    let noise: Vec<u8> = noise.take(2 << 20).collect();
    let lab = Lab::open().await;
    let id = lab.finished(&[("noise.vtp", &noise)]).await;
    let path = format!("/v1/jobs/{id}/archive.zip");
    // more than are written at once: were they not given up, the last would be sent away
    for _ in 0..100 {
        let answer = lab.begin(request("GET", &path, &[], "")).await;
        assert_eq!(answer.status(), 200);
    }
    assert_eq!(lab.get(&path).await.status, 200);
}
