//! Whatever goes wrong, the answer has one form.
use crate::support::{JSON, Lab, example, request};

#[tokio::test]
async fn the_frameworks_own_refusals_are_problems_too() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    lab.get("/v1/nothing").await.problem(404, "not-found");
    lab.get("/nothing").await.problem(404, "not-found");
    lab.get("/v1/jobs/12").await.problem(400, "bad-request");
    lab.get("/v1/jobs?limit=0")
        .await
        .problem(400, "bad-request");
    lab.get("/v1/jobs?limit=201")
        .await
        .problem(400, "bad-request");
    lab.get("/v1/jobs?status=lost")
        .await
        .problem(400, "bad-request");
    lab.get("/v1/jobs?colour=red")
        .await
        .problem(400, "bad-request");
    lab.get("/v1/jobs?created_after=yesterday")
        .await
        .problem(400, "bad-request");
    lab.get("/v1/events?jobs=1,2")
        .await
        .problem(400, "bad-request");
    lab.get(&format!("/v1/jobs/{id}/curve?max_points=1"))
        .await
        .problem(400, "bad-request");
    lab.get(&format!("/v1/jobs/{id}/files/%FF"))
        .await
        .problem(400, "bad-request");

    let refused = lab.send(request("PUT", "/v1/jobs", &[], "")).await;
    refused.problem(405, "method-not-allowed");
    let allowed: Vec<&str> = refused.header("allow").split(',').collect();
    for method in ["GET", "HEAD", "POST"] {
        assert!(allowed.contains(&method), "{allowed:?}");
    }
    let refused = lab.send(request("TRACE", "/healthz", &[], "")).await;
    refused.problem(405, "method-not-allowed");

    let untyped = lab.send(request("POST", "/v1/jobs", &[], example())).await;
    untyped.problem(415, "unsupported-media-type");
    let large = [JSON, ("content-length", "40000000")];
    let large = lab.send(request("POST", "/v1/jobs", &large, "{}")).await;
    large.problem(413, "too-large");
}

#[tokio::test]
async fn a_wrong_parameter_is_named_with_its_value_and_what_is_allowed() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    for (path, name, value, allowed) in [
        ("/v1/jobs?limit=-1", "limit", "-1", "1 … 200"),
        (
            "/v1/jobs?status=queued&limit=x%2F1",
            "limit",
            "x/1",
            "1 … 200",
        ),
        (
            "/v1/jobs?created_after=2026-11-29",
            "created_after",
            "2026-11-29",
            "2026-11-29T09:00:00Z",
        ),
        ("/v1/jobs?status=lost", "status", "lost", "`queued`"),
        ("/v1/jobs?project=7", "project", "7", "a UUID"),
        ("/v1/jobs?colour=red", "colour", "red", "`limit`"),
        ("/v1/jobs?tag=", "tag", "", "1 … 50"),
        (
            "/v1/jobs/ID/curve?max_points=1",
            "max_points",
            "1",
            "10 … 20000",
        ),
    ] {
        let path = path.replace("ID", &id.to_string());
        let problem = lab.get(&path).await.problem(400, "bad-request");
        let violation = &problem["violations"][0];
        assert_eq!(violation["pointer"], format!("/{name}"), "{problem}");
        assert_eq!(violation["value"], value, "{problem}");
        for text in [&violation["allowed"], &problem["detail"]] {
            let text = text.as_str().expect("a text");
            assert!(text.contains(allowed), "{problem}");
        }
        let detail = problem["detail"].as_str().expect("a sentence");
        assert!(detail.contains(name), "{problem}");
    }
}

#[tokio::test]
async fn problems_can_be_read_by_clients_that_take_gzip() {
    let lab = Lab::open().await;
    let refused = lab
        .get_with("/v1/jobs?limit=0", &[("accept-encoding", "gzip")])
        .await;
    refused.problem(400, "bad-request");
    assert_eq!(refused.header("content-encoding"), "");
}

#[tokio::test]
async fn a_body_longer_than_it_says_is_refused() {
    let lab = Lab::open().await;
    let short = [JSON, ("content-length", "10")];
    let answer = lab
        .send(request("POST", "/v1/jobs", &short, example()))
        .await;
    answer.problem(413, "too-large");
}

#[tokio::test]
async fn unknown_jobs_are_404_everywhere() {
    let lab = Lab::open().await;
    let job = "/v1/jobs/00000000-0000-4000-8000-000000000000";
    for path in [
        "",
        "/events",
        "/curve",
        "/curve.csv",
        "/curve.json",
        "/outcome",
        "/log",
        "/files",
        "/files/a.csv",
        "/archive.zip",
    ] {
        lab.get(&format!("{job}{path}"))
            .await
            .problem(404, "not-found");
    }
    for action in ["cancel", "pause", "resume", "retry"] {
        lab.post(&format!("{job}/{action}"), "")
            .await
            .problem(404, "not-found");
    }
    let edited = lab.send(request("PATCH", job, &[JSON], "{}")).await;
    edited.problem(404, "not-found");
    let deleted = lab.send(request("DELETE", job, &[], "")).await;
    deleted.problem(404, "not-found");
}

#[tokio::test]
async fn mistakes_in_a_job_are_named_and_nothing_is_stored() {
    let lab = Lab::open().await;
    let truncated = lab.post("/v1/jobs", &example()[..100]).await;
    truncated.problem(400, "not-json");
    let wrong = example().replace("\"rows\": 17", "\"rows\": 0");
    let problem = lab
        .post("/v1/jobs", &wrong)
        .await
        .problem(422, "invalid-job");
    let violation = &problem["violations"][0];
    assert_eq!(violation["pointer"], "/spec/fabric/lattice/rows");
    assert_eq!(violation["value"], 0);
    assert_eq!(
        lab.get("/v1/jobs").await.json()["items"],
        serde_json::json!([])
    );
}

#[tokio::test]
async fn a_job_beyond_the_limits_is_refused_with_the_numbers() {
    let lab = Lab::with(|config| config.limits.disk_mb = 0.0).await;
    let problem = lab
        .post("/v1/jobs", example())
        .await
        .problem(422, "invalid-job");
    let violation = &problem["violations"][0];
    assert_eq!(violation["code"], "too_expensive");
    assert_eq!(violation["unit"], "MB");
    assert!(violation["value"].as_f64() > Some(0.0));
}
