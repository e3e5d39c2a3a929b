//! Result files: whole, in parts, and not again.
use loadframe_api::sha256_hex;

use crate::support::Lab;

const CONTENT: &[u8] = b"0123456789";

async fn lab_with_file() -> (Lab, String) {
    let lab = Lab::open().await;
    let id = lab.finished(&[("snapshots/a.vtp", CONTENT)]).await;
    (lab, format!("/v1/jobs/{id}/files/snapshots/a.vtp"))
}

#[tokio::test]
async fn a_file_says_what_it_is() {
    let (lab, path) = lab_with_file().await;
    let whole = lab.get(&path).await;
    assert_eq!((whole.status, &whole.body[..]), (200, CONTENT));
    assert_eq!(whole.header("etag"), format!("\"{}\"", sha256_hex(CONTENT)));
    assert_eq!(whole.header("accept-ranges"), "bytes");
    assert_eq!(whole.header("content-length"), "10");
    assert_eq!(whole.header("content-type"), "application/octet-stream");
    assert_eq!(
        whole.header("content-disposition"),
        "attachment; filename=\"a.vtp\""
    );
    assert_eq!(whole.header("x-content-type-options"), "nosniff");
    let head = lab
        .send(crate::support::request("HEAD", &path, &[], ""))
        .await;
    assert_eq!(
        (head.status, head.header("content-length"), head.body.len()),
        (200, "10", 0)
    );
}

#[tokio::test]
async fn ranges_are_answered_exactly() {
    let (lab, path) = lab_with_file().await;
    for (range, part, content_range) in [
        ("bytes=0-3", "0123", "bytes 0-3/10"),
        ("bytes=4-", "456789", "bytes 4-9/10"),
        ("bytes=-3", "789", "bytes 7-9/10"),
        ("bytes=8-100", "89", "bytes 8-9/10"),
        ("bytes=-100", "0123456789", "bytes 0-9/10"),
    ] {
        let answer = lab.get_with(&path, &[("range", range)]).await;
        assert_eq!(
            (answer.status, answer.text().as_str()),
            (206, part),
            "{range}"
        );
        assert_eq!(answer.header("content-range"), content_range);
        assert_eq!(answer.header("content-length"), part.len().to_string());
    }
    for range in ["lines=0-3", "bytes=0-1,4-5"] {
        let answer = lab.get_with(&path, &[("range", range)]).await;
        assert_eq!((answer.status, &answer.body[..]), (200, CONTENT), "{range}");
    }
    let beyond = lab.get_with(&path, &[("range", "bytes=10-")]).await;
    beyond.problem(416, "range-not-satisfiable");
    assert_eq!(beyond.header("content-range"), "bytes */10");
}

#[tokio::test]
async fn tags_decide_about_ranges_and_repeats() {
    let (lab, path) = lab_with_file().await;
    let tag = format!("\"{}\"", sha256_hex(CONTENT));
    let known = lab.get_with(&path, &[("if-none-match", &tag)]).await;
    assert_eq!((known.status, known.body.len()), (304, 0));
    let range = ("range", "bytes=0-3");
    let same = lab.get_with(&path, &[range, ("if-range", &tag)]).await;
    assert_eq!(same.status, 206);
    let weak = format!("W/{tag}");
    for other in ["\"other\"", &weak, "Sat, 21 Nov 2026 09:00:00 GMT"] {
        let whole = lab.get_with(&path, &[range, ("if-range", other)]).await;
        assert_eq!((whole.status, &whole.body[..]), (200, CONTENT), "{other}");
    }
}

#[tokio::test]
async fn only_the_jobs_own_files_are_served() {
    let (lab, path) = lab_with_file().await;
    for other in [
        "b.vtp",
        "../../a.vtp",
        "%2e%2e/a.vtp",
        "/etc/passwd",
        "a%00b",
    ] {
        let path = path.replace("snapshots/a.vtp", other);
        lab.get(&path).await.problem(404, "not-found");
    }
}

#[tokio::test]
async fn lists_outcome_and_log_are_json() {
    let lab = Lab::open().await;
    let id = lab.finished(&[("a.csv", CONTENT)]).await;
    let job = format!("/v1/jobs/{id}");
    let files = lab.get(&format!("{job}/files")).await.json();
    let names: Vec<_> = files["items"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|file| &file["name"])
        .collect();
    assert_eq!(names, ["a.csv", "outcome.json"]);
    let outcome = lab.get(&format!("{job}/outcome")).await;
    assert_eq!(outcome.header("content-type"), "application/json");
    assert_eq!(outcome.json()["summary"]["max_force"]["value"], 12.5);
    let log = lab.get(&format!("{job}/log")).await.json();
    assert_eq!(log["items"][0]["message"], "a line");
    let rest = lab.get(&format!("{job}/log?since=1")).await.json();
    assert_eq!(rest["items"], serde_json::json!([]));
    let csv = lab.get(&format!("{job}/files/a.csv")).await;
    assert_eq!(csv.header("content-type"), "text/csv; charset=utf-8");
}

#[tokio::test]
async fn a_file_that_has_changed_is_an_error_that_names_job_and_file() {
    let (lab, path) = lab_with_file().await;
    let sha256 = sha256_hex(CONTENT);
    let stored = lab.state.store.options().data.join("blobs");
    let stored = stored.join(&sha256[..2]).join(&sha256);
    std::fs::write(&stored, b"0123456780").expect("it is there");
    let problem = lab.get(&path).await.problem(500, "file-lost");
    let detail = problem["detail"].as_str().expect("a sentence");
    let id = path.split('/').nth(3).expect("an id");
    assert!(
        detail.contains(id) && detail.contains("snapshots/a.vtp"),
        "{detail}"
    );
    // an archive breaks off rather than hold it
    let archive = lab
        .begin(crate::support::request(
            "GET",
            &format!("/v1/jobs/{id}/archive.zip"),
            &[],
            "",
        ))
        .await;
    assert_eq!(archive.status(), 200);
    assert!(
        axum::body::to_bytes(archive.into_body(), 1 << 20)
            .await
            .is_err()
    );
}
