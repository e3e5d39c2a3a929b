//! Health, metrics, version.
use crate::support::Lab;

#[tokio::test]
async fn health_follows_the_servers_life() {
    let lab = Lab::open().await;
    assert_eq!(lab.get("/healthz").await.status, 200);
    assert_eq!(lab.get("/readyz").await.status, 200);
    lab.state.stopping.cancel();
    assert_eq!(lab.get("/healthz").await.status, 200);
    let stopping = lab.get("/readyz").await;
    stopping.problem(503, "busy");
    assert_ne!(stopping.header("retry-after"), "");
}

#[tokio::test]
async fn metrics_tell_of_jobs_and_requests() {
    let lab = Lab::open().await;
    lab.finished(&[]).await;
    lab.submit().await;
    lab.get("/v1/nothing").await;
    let metrics = lab.get("/metrics").await;
    assert!(metrics.header("content-type").starts_with("text/plain"));
    let text = metrics.text();
    for line in [
        "loadframe_jobs{status=\"queued\"} 1",
        "loadframe_jobs{status=\"succeeded\"} 1",
        "loadframe_workers_alive 1",
        "loadframe_submissions_total{kind=\"nonwoven_tensile\"}",
        "loadframe_http_request_seconds_count{route=\"/v1/jobs\",method=\"POST\",status=\"201\"}",
        "loadframe_http_request_seconds_count{route=\"other\",method=\"GET\",status=\"404\"}",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
}

#[tokio::test]
async fn the_version_is_told() {
    let version = Lab::open().await.get("/version").await.json();
    assert_eq!(version["version"], loadframe_server::VERSION);
    assert_eq!(version["commit"], loadframe_server::COMMIT);
}
