//! Submitting, listing, reading, changing, deleting.
use serde_json::json;

use crate::support::{JSON, Lab, example, request};

#[tokio::test]
async fn a_submitted_job_is_where_location_says() {
    let lab = Lab::open().await;
    let created = lab.post("/v1/jobs", example()).await;
    assert_eq!(created.status, 201);
    let job = created.json();
    assert_eq!(created.header("location"), job["links"]["self"]);
    assert_eq!(
        (&job["status"], &job["position"]),
        (&json!("queued"), &json!(1))
    );
    let read = lab.get(created.header("location")).await;
    assert_eq!((read.status, read.json()), (200, job));
}

#[tokio::test]
async fn an_idempotency_key_stands_for_one_body() {
    let lab = Lab::open().await;
    let send = async |key: &str, body: &str| {
        let headers = [JSON, ("idempotency-key", key)];
        lab.send(request("POST", "/v1/jobs", &headers, body)).await
    };
    let first = send("a", example()).await;
    let again = send("a", example()).await;
    assert_eq!((first.status, again.status), (201, 201));
    assert_eq!(first.json(), again.json());
    assert_eq!(first.header("idempotency-replayed"), "");
    assert_eq!(again.header("idempotency-replayed"), "true");
    let other = example().replace("\"seed\": 1", "\"seed\": 2");
    send("a", &other)
        .await
        .problem(422, "idempotency-key-reused");
    assert_ne!(send("b", example()).await.json()["id"], first.json()["id"]);
    assert_eq!(
        lab.get("/v1/jobs").await.json()["items"]
            .as_array()
            .map(Vec::len),
        Some(2)
    );

    send(&"k".repeat(201), example())
        .await
        .problem(422, "invalid-request");
    send("two words", example())
        .await
        .problem(422, "invalid-request");
    assert_eq!(send(&"k".repeat(200), example()).await.status, 201);
}

#[tokio::test]
async fn a_repeated_submission_gets_its_first_answer_whatever_limits_say_now() {
    let mut lab = Lab::open().await;
    let headers = [JSON, ("idempotency-key", "a")];
    let first = lab
        .send(request("POST", "/v1/jobs", &headers, example()))
        .await;
    assert_eq!(first.status, 201);
    lab.limit(|limits| limits.memory_mb = 1e-3);
    let again = lab
        .send(request("POST", "/v1/jobs", &headers, example()))
        .await;
    assert_eq!((again.status, again.json()), (201, first.json()));
    assert_eq!(again.header("idempotency-replayed"), "true");
    // whereas what is new is held against them
    let fresh = [JSON, ("idempotency-key", "b")];
    let fresh = lab
        .send(request("POST", "/v1/jobs", &fresh, example()))
        .await;
    fresh.problem(422, "invalid-job");
    let id = first.json()["id"].as_str().expect("an id").to_owned();
    let deleted = lab
        .send(request("DELETE", &format!("/v1/jobs/{id}"), &[], ""))
        .await;
    assert_eq!(deleted.status, 204);
    let gone = lab
        .send(request("POST", "/v1/jobs", &headers, example()))
        .await;
    gone.problem(409, "conflict");
}

#[tokio::test]
async fn an_edit_does_not_overwrite_one_that_it_does_not_know() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}");
    let edit = async |tag: &str, body: &str| {
        lab.send(request("PATCH", &path, &[JSON, ("if-match", tag)], body))
            .await
    };
    let seen = lab.get(&path).await.header("etag").to_owned();
    // a job goes on by itself: that is no edit
    let lease = lab.claim().await;
    lab.report(&lease, 0, vec![vec![0.0, 1.0]]).await;
    let one = edit(&seen, r#"{"notes": "of one"}"#).await;
    assert_eq!((one.status, &one.json()["notes"]), (200, &json!("of one")));
    let other = edit(&seen, r#"{"notes": "of another"}"#).await;
    let detail = other.problem(412, "changed-since")["detail"].to_string();
    assert!(detail.contains("notes"), "{detail}");
    assert_eq!(lab.get(&path).await.json()["notes"], "of one");
    // who has seen it may go on, by the tag of the answer, of a list of tags, or a number
    let mut tag = one.header("etag").to_owned();
    for others in ["", "\"x\", "] {
        let known = format!("{others}{tag}");
        let further = edit(&known, r#"{"notes": "of one, further"}"#).await;
        assert_eq!(further.status, 200, "{known}");
        tag = further.header("etag").to_owned();
        edit(&known, "{}").await.problem(412, "changed-since");
    }
    let number = tag
        .trim_end_matches('"')
        .rsplit('-')
        .next()
        .expect("a number")
        .to_owned();
    assert_eq!(
        edit(&format!("\"{number}\""), r#"{"priority": 1}"#)
            .await
            .status,
        200
    );
    assert_eq!(edit("*", r#"{"priority": 2}"#).await.status, 200);
    for unknown in ["\"x\"", "", "12", "W/\"\"", "\"-\""] {
        edit(unknown, r#"{"priority": 3}"#)
            .await
            .problem(412, "changed-since");
    }
    let blind = lab
        .send(request("PATCH", &path, &[JSON], r#"{"priority": 4}"#))
        .await;
    assert_eq!((blind.status, &blind.json()["priority"]), (200, &json!(4)));
}

#[tokio::test]
async fn a_dry_run_says_what_would_be_and_stores_nothing() {
    let lab = Lab::open().await;
    let headers = [JSON, ("idempotency-key", "dry")];
    let dry = lab
        .send(request(
            "POST",
            "/v1/jobs?dry_run=true",
            &headers,
            example(),
        ))
        .await;
    assert_eq!(dry.status, 200);
    let dry = dry.json();
    assert!(dry["estimate"]["wall_s"].as_f64() > Some(0.0));
    assert_eq!(dry["estimate"]["calibrated"], false);
    assert_eq!(dry["warnings"][0]["code"], "not_calibrated");
    assert_eq!(
        dry["spec"]["fabric"]["lattice"]["jaws"], "half_bond",
        "defaults are written out"
    );
    assert_eq!(lab.get("/v1/jobs").await.json()["items"], json!([]));
    // nor does it use the key up
    let job = lab
        .send(request("POST", "/v1/jobs", &headers, example()))
        .await;
    assert_eq!((job.status, job.header("idempotency-replayed")), (201, ""));
    assert_eq!(job.json()["spec_sha256"], dry["spec_sha256"]);
}

#[tokio::test]
async fn what_has_not_changed_is_not_sent_again() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    for path in [format!("/v1/jobs/{id}"), "/v1/jobs".to_owned()] {
        let first = lab.get(&path).await;
        let tag = first.header("etag");
        let again = lab.get_with(&path, &[("if-none-match", tag)]).await;
        assert_eq!((again.status, again.body.len()), (304, 0));
        assert_eq!(again.header("etag"), tag);
        let other = lab.get_with(&path, &[("if-none-match", "\"other\"")]).await;
        assert_eq!(other.status, 200);
        lab.post(&format!("/v1/jobs/{id}/pause"), "").await;
        let changed = lab.get_with(&path, &[("if-none-match", tag)]).await;
        assert_eq!(changed.status, 200);
        lab.post(&format!("/v1/jobs/{id}/resume"), "").await;
    }
}

#[tokio::test]
async fn the_position_in_the_queue_is_part_of_the_tag() {
    let lab = Lab::open().await;
    let ahead = lab.submit().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}");
    let first = lab.get(&path).await;
    assert_eq!(first.json()["position"], 2);
    lab.post(&format!("/v1/jobs/{ahead}/cancel"), "").await;
    let moved = lab
        .get_with(&path, &[("if-none-match", first.header("etag"))])
        .await;
    assert_eq!((moved.status, &moved.json()["position"]), (200, &json!(1)));
}

#[tokio::test]
async fn pages_follow_each_other_and_filters_narrow() {
    let lab = Lab::open().await;
    for index in 0..5 {
        let body = example().replace("Small fabric, quick look", &format!("Fabric {index}"));
        assert_eq!(lab.post("/v1/jobs", &body).await.status, 201);
    }
    let mut names = Vec::new();
    let mut path = "/v1/jobs?limit=2".to_owned();
    loop {
        let page = lab.get(&path).await.json();
        let items = page["items"].as_array().expect("items");
        names.extend(
            items
                .iter()
                .map(|job| job["name"].as_str().expect("a name").to_owned()),
        );
        let Some(next) = page["next"].as_str() else {
            break;
        };
        path = format!("/v1/jobs?limit=2&cursor={next}");
    }
    assert_eq!(
        names,
        ["Fabric 4", "Fabric 3", "Fabric 2", "Fabric 1", "Fabric 0"]
    );
    let count = async |query: &str| {
        let page = lab.get(&format!("/v1/jobs?{query}")).await.json();
        page["items"].as_array().map(Vec::len)
    };
    assert_eq!(count("q=fabric%203").await, Some(1));
    assert_eq!(count("tag=quick").await, Some(5));
    assert_eq!(count("tag=slow").await, Some(0));
    assert_eq!(count("status=queued&kind=nonwoven_tensile").await, Some(5));
    assert_eq!(count("outcome=succeeded").await, Some(0));
    assert_eq!(count("created_after=2026-01-01T00:00:00Z").await, Some(5));
    assert_eq!(
        count("created_before=2026-01-01T00:00:00%2B01:00").await,
        Some(0)
    );
    lab.get("/v1/jobs?cursor=nonsense")
        .await
        .problem(422, "invalid-request");
}

#[tokio::test]
async fn name_notes_tags_and_priority_can_change() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}");
    let patch = async |body: &str| lab.send(request("PATCH", &path, &[JSON], body)).await;
    let changed = patch(r#"{"name": "New", "priority": 7}"#).await;
    assert_eq!(changed.status, 200);
    assert_eq!(
        (&changed.json()["name"], &changed.json()["priority"]),
        (&json!("New"), &json!(7))
    );
    let tagged = patch(r#"{"tags": ["a", "b"]}"#).await.json();
    assert_eq!(
        (&tagged["name"], &tagged["tags"]),
        (&json!("New"), &json!(["a", "b"]))
    );
    let problem = patch(r#"{"priority": 1001, "spec": {}}"#)
        .await
        .problem(422, "invalid-job");
    assert_eq!(problem["violations"].as_array().map(Vec::len), Some(2));
    patch("{").await.problem(400, "not-json");
}

#[tokio::test]
async fn requests_of_users_follow_the_state() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}");
    let ask = async |action: &str| lab.post(&format!("{path}/{action}"), "").await;
    assert_eq!(ask("pause").await.json()["status"], "paused");
    ask("retry").await.problem(409, "conflict");
    assert_eq!(ask("resume").await.json()["status"], "queued");
    assert_eq!(ask("cancel").await.json()["outcome"], "cancelled");
    assert_eq!(ask("retry").await.json()["status"], "queued");
    let lease = lab.claim().await;
    assert_eq!(lease.job_id, id);
    let delete = async || lab.send(request("DELETE", &path, &[], "")).await;
    delete().await.problem(409, "conflict");
    assert_eq!(
        ask("cancel").await.json()["reason_code"],
        "cancel_requested"
    );
}

#[tokio::test]
async fn a_deleted_job_is_gone() {
    let lab = Lab::open().await;
    let id = lab.finished(&[("a.csv", b"1")]).await;
    let path = format!("/v1/jobs/{id}");
    let deleted = lab.send(request("DELETE", &path, &[], "")).await;
    assert_eq!((deleted.status, deleted.body.len()), (204, 0));
    lab.get(&path).await.problem(404, "not-found");
    lab.get(&format!("{path}/files/a.csv"))
        .await
        .problem(404, "not-found");
}
