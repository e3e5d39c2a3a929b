//! How many requests a second are answered, and whose.
use axum::body::Body;
use axum::http::Request;
use loadframe_api::people::Scope;
use loadframe_api::worker::ClaimRequest;
use uuid::Uuid;

use crate::support::{Answer, JSON, Lab, key, request};

/// Asks until it is told to come later; how often it was answered before.
async fn exhaust(ask: impl AsyncFn() -> Answer) -> (usize, Answer) {
    for answered in 0..1_000 {
        let answer = ask().await;
        if answer.status == 429 {
            return (answered, answer);
        }
    }
    panic!("a thousand requests were answered");
}

/// Makes a POST, as often as it is asked.
fn request_of(path: &str, headers: &[(&str, &str)], body: &str) -> impl Fn() -> Request<Body> {
    move || request("POST", path, headers, body)
}

#[tokio::test]
async fn too_many_requests_with_one_token_or_from_one_address_hold_up_nobody_else() {
    let lab = Lab::with(|config| {
        config.require_token = true;
        config.requests_per_s = 1;
    })
    .await;
    let lease = {
        let submission =
            loadframe_api::Submission::from_slice(crate::support::example().as_bytes());
        let submission = submission.expect("a job");
        lab.store
            .enqueue(&submission, None)
            .await
            .expect("it is queued");
        lab.claim().await
    };
    let [hasty, worker, other] =
        [Scope::Submit, Scope::Worker, Scope::Read].map(|scope| lab.token(scope));
    let bearer = |secret: &str| format!("Bearer {secret}");
    let [hasty, worker, other] =
        [hasty.await, worker.await, other.await].map(|of| bearer(&of.secret));
    let list = async |token: &str| lab.get_with("/v1/jobs", &[("authorization", token)]).await;

    let (answered, refused) = exhaust(async || list(&hasty).await).await;
    assert!(answered >= 2, "twice the rate may come at once: {answered}");
    let problem = refused.problem(429, "too-many-requests");
    assert_eq!(
        problem["detail"],
        "requests with this token come faster than 1 a second"
    );
    let wait: u32 = refused.header("retry-after").parse().expect("seconds");
    assert!((1..=2).contains(&wait), "{wait}");

    // wrong tokens and none are their address's, and so are pages
    let (_, refused) = exhaust(async || lab.get("/v1/jobs").await).await;
    let problem = refused.problem(429, "too-many-requests");
    assert_eq!(
        problem["detail"],
        "requests from your address come faster than 1 a second"
    );
    let (_, refused) = exhaust(async || lab.get("/docs").await).await;
    refused.problem(429, "too-many-requests");

    // from the same address: a worker keeps its lease and claims, and somebody reads
    let token = lease.token.to_string();
    let headers = [
        JSON,
        ("authorization", worker.as_str()),
        ("loadframe-lease-token", token.as_str()),
    ];
    let heartbeat = format!("/v1/worker/leases/{}/heartbeat", key(&lease).id);
    let beat = lab.send(request("POST", &heartbeat, &headers, "")).await;
    assert_eq!(beat.status, 200, "{beat:?}");
    assert_eq!(list(&other).await.status, 200);

    // also where claims with its token come too fast: heartbeats are counted by themselves, but counted
    let hasty_worker = [JSON, ("authorization", worker.as_str())];
    let claim = ClaimRequest::new(Uuid::from_u128(8), "hasty", "test", "0");
    let claim = serde_json::to_string(&claim).expect("JSON");
    let claims = request_of("/v1/worker/claims", &hasty_worker, &claim);
    let (_, refused) = exhaust(async || lab.send(claims()).await).await;
    refused.problem(429, "too-many-requests");
    let heartbeats = request_of(&heartbeat, &headers, "");
    assert_eq!(lab.send(heartbeats()).await.status, 200);
    let (_, refused) = exhaust(async || lab.send(heartbeats()).await).await;
    refused.problem(429, "too-many-requests");

    // and who waits as it was told is answered
    tokio::time::sleep(std::time::Duration::from_secs(wait.into())).await;
    assert_eq!(list(&hasty).await.status, 200);
}
