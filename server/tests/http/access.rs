//! Who is let in.
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
        .problem(403, "foreign-host");
    ask(&[("origin", "null")])
        .await
        .problem(403, "foreign-host");
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
    let token = lab.store.create_token("a person").await.expect("a token");
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
    lab.store.revoke_token(token.id).await.expect("revoked");
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
    let token = lab.store.create_token("a person").await.expect("a token");
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
