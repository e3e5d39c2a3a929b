//! Who is let in.
use loadframe_api::people::Scope;

use crate::support::{Lab, request};

#[tokio::test]
async fn an_open_server_answers_its_own_machine_only() {
    let lab = Lab::open().await;
    let ask = async |headers: &[(&str, &str)]| lab.get_with("/v1/jobs", headers).await;
    for host in ["localhost:8400", "127.0.0.1:8400", "[::1]:8400"] {
        let origin = format!("http://{host}");
        assert_eq!(
            ask(&[("host", host), ("origin", &origin)]).await.status,
            200
        );
    }
    ask(&[("host", "evil.example")])
        .await
        .problem(403, "foreign-host");
    ask(&[("origin", "https://evil.example")])
        .await
        .problem(403, "foreign-origin");
    ask(&[("origin", "null")])
        .await
        .problem(403, "foreign-origin");
    // a page on another port of this machine is from elsewhere, too
    ask(&[
        ("host", "localhost:8400"),
        ("origin", "http://localhost:5173"),
    ])
    .await
    .problem(403, "foreign-origin");
    // the page as well: it must not be shown under a foreign name
    let page = lab
        .get_with("/", &[("host", "evil.example"), ("accept", "text/html")])
        .await;
    page.problem(403, "foreign-host");
}

#[tokio::test]
async fn further_names_can_be_allowed() {
    let lab = Lab::with(|config| config.allowed_hosts = vec!["Lab.example".to_owned()]).await;
    let named = lab
        .get_with("/v1/jobs", &[("host", "lab.example:80")])
        .await;
    assert_eq!(named.status, 200);
    let other = lab.get_with("/v1/jobs", &[("host", "evil.example")]).await;
    other.problem(403, "foreign-host");
}

#[tokio::test]
async fn elsewhere_a_token_is_demanded() {
    let lab = Lab::with(|config| config.listen = "192.0.2.7:8400".to_owned()).await;
    let host = ("host", "lab.example");
    for path in ["/v1/jobs", "/v1/nothing", "/v1/worker/claims", "/metrics"] {
        let refused = lab.get_with(path, &[host]).await;
        refused.problem(401, "token-needed");
        assert!(refused.header("www-authenticate").starts_with("Bearer"));
    }
    for path in [
        "/healthz",
        "/readyz",
        "/version",
        "/openapi.json",
        "/docs",
        "/guide",
        "/guide/quality",
        "/guide/search?q=token",
        "/guide/calibrate/fields",
        "/guide/pictures/lab.png",
    ] {
        assert_eq!(lab.get_with(path, &[host]).await.status, 200, "{path}");
    }
    let token = lab.token(Scope::Submit).await;
    let bearer = format!("Bearer {}", token.secret);
    let ask = async || {
        lab.get_with("/v1/jobs", &[host, ("authorization", &bearer)])
            .await
    };
    assert_eq!(ask().await.status, 200);
    // a token in a header is not sent by foreign pages, so their names do not matter here
    let origin = [
        host,
        ("authorization", &*bearer),
        ("origin", "https://lab.example"),
    ];
    assert_eq!(lab.get_with("/v1/jobs", &origin).await.status, 200);
    lab.store
        .revoke_token(token.id, None)
        .await
        .expect("revoked");
    ask().await.problem(401, "token-needed");
}

#[tokio::test]
async fn a_token_can_be_demanded_on_this_machine_too() {
    let lab = Lab::with(|config| config.require_token = true).await;
    lab.get("/v1/jobs").await.problem(401, "token-needed");
    let basic = lab
        .get_with("/v1/jobs", &[("authorization", "Basic YTpi")])
        .await;
    basic.problem(401, "token-needed");
}

#[tokio::test]
async fn guessing_is_slowed_down_and_locks_out_nobody() {
    let lab = Lab::with(|config| config.require_token = true).await;
    let token = lab.token(Scope::Submit).await;
    let ask = async |secret: &str| {
        let bearer = format!("Bearer {secret}");
        lab.send(request(
            "GET",
            "/v1/jobs",
            &[("authorization", &bearer)],
            "",
        ))
        .await
    };
    for guess in 0..10 {
        ask(&guess.to_string()).await.problem(401, "token-needed");
    }
    let slowed = ask("one more").await;
    slowed.problem(429, "too-many-guesses");
    assert!(
        slowed
            .header("retry-after")
            .parse::<u32>()
            .is_ok_and(|seconds| seconds <= 61)
    );
    assert_eq!(ask(&token.secret).await.status, 200);
}

#[tokio::test]
async fn a_page_on_another_port_cancels_no_job() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}/cancel");
    for header in [
        ("origin", "http://localhost:5173"),
        ("sec-fetch-site", "same-site"),
        ("sec-fetch-site", "cross-site"),
    ] {
        let answer = lab.send(request("POST", &path, &[header], "")).await;
        answer.problem(403, "foreign-origin");
    }
    let own = [
        ("origin", "http://localhost"),
        ("sec-fetch-site", "same-origin"),
    ];
    assert_eq!(lab.send(request("POST", &path, &own, "")).await.status, 200);
}

#[tokio::test]
async fn the_secret_of_the_start_is_good_as_long_as_the_server_was_started_with_it() {
    let lab = Lab::with(|config| {
        config.require_token = true;
        config.token = Some("of the environment".to_owned());
        config.worker_token = Some("of the workers".to_owned());
    })
    .await;
    let ask = async |secret: &str, path: &str| {
        let bearer = format!("Bearer {secret}");
        lab.get_with(path, &[("authorization", &bearer)]).await
    };
    assert_eq!(ask("of the environment", "/v1/jobs").await.status, 200);
    ask("of before", "/v1/jobs")
        .await
        .problem(401, "token-needed");
    ask("of the workers", "/v1/jobs")
        .await
        .problem(403, "not-allowed");
    // it is written down nowhere: changed at the next start, it is out of force
    assert!(lab.store.tokens(None).await.expect("tokens").is_empty());
}

#[tokio::test]
async fn a_token_does_what_its_scope_says() {
    let lab = Lab::with(|config| config.require_token = true).await;
    let (read, submit) = (lab.token(Scope::Read).await, lab.token(Scope::Submit).await);
    let worker = lab.token(Scope::Worker).await;
    let send = async |method: &str, path: &str, secret: &str| {
        let bearer = format!("Bearer {secret}");
        let headers = [("authorization", &*bearer), crate::support::JSON];
        lab.send(request(method, path, &headers, "{}")).await.status
    };
    for (token, expected) in [
        (&read, [200, 403, 403]),
        (&submit, [200, 422, 403]),
        (&worker, [403, 403, 422]),
    ] {
        let got = [
            send("GET", "/v1/jobs", &token.secret).await,
            send("POST", "/v1/jobs", &token.secret).await,
            send("POST", "/v1/worker/claims", &token.secret).await,
        ];
        assert_eq!(got, expected, "{:?}", token.scope);
    }
}

#[tokio::test]
async fn a_stream_ends_with_its_token() {
    let lab = Lab::with(|config| config.require_token = true).await;
    let token = lab.token(Scope::Read).await;
    let bearer = format!("Bearer {}", token.secret);
    let stream = lab
        .begin(request(
            "GET",
            "/v1/events",
            &[("authorization", &bearer)],
            "",
        ))
        .await;
    assert_eq!(stream.status(), 200);
    lab.store
        .revoke_token(token.id, None)
        .await
        .expect("revoked");
    // ended by the server: the body comes to its end
    let body = axum::body::to_bytes(stream.into_body(), 1 << 20);
    let ended = tokio::time::timeout(std::time::Duration::from_secs(10), body).await;
    assert!(ended.expect("within a moment").is_ok());
}

#[tokio::test]
async fn who_asks_a_batch_system_for_machines_needs_a_workers_token_and_is_seen_by_readers() {
    let lab = Lab::with(|config| config.require_token = true).await;
    let (read, worker) = (lab.token(Scope::Read).await, lab.token(Scope::Worker).await);
    let send = async |method: &str, path: &str, secret: &str, body: &str| {
        let bearer = format!("Bearer {secret}");
        let headers = [("authorization", &*bearer), crate::support::JSON];
        lab.send(request(method, path, &headers, body)).await
    };
    let report = r#"{"source": "slurm on login1", "allocations":
        [{"id": "7_0", "state": "PENDING", "reason": "Priority"}], "trouble": null}"#;
    let (put, path) = ("PUT", "/v1/worker/allocations");
    assert_eq!(send(put, path, &read.secret, report).await.status, 403);
    assert_eq!(send(put, path, &worker.secret, report).await.status, 204);
    let unnamed = report.replace("slurm on login1", "");
    let refused = send(put, path, &worker.secret, &unnamed).await;
    assert_eq!(
        refused.problem(422, "invalid-request")["violations"][0]["pointer"],
        "/source"
    );
    let backlog = send("GET", "/v1/worker/backlog", &worker.secret, "").await;
    assert_eq!(
        backlog.json(),
        serde_json::json!({"waiting": 0, "classes": []})
    );
    let seen = send("GET", "/v1/allocations", &read.secret, "")
        .await
        .json();
    assert_eq!(seen["items"][0]["allocations"][0]["reason"], "Priority");
    assert_eq!(
        send("GET", "/v1/allocations", &worker.secret, "")
            .await
            .status,
        403
    );
}
