//! Single sign-on by the word of a proxy.
use std::net::SocketAddr;

use axum::extract::ConnectInfo;
use loadframe_api::people::PersonChanges;
use serde_json::{Value, json};

use super::group::Group;
use super::single_sign_on::lab_with;
use crate::support::{JSON, request};

const ORIGIN: &str = "http://localhost:8400";
const HOST: (&str, &str) = ("host", "localhost:8400");

#[tokio::test]
async fn a_proxy_signs_people_in_and_nobody_else_by_its_header() {
    let settings = json!({
        "proxy": { "addresses": ["10.1.0.0/16"], "email_header": "X-Forwarded-Email" },
        "admit": [{ "email_domain": "example.org", "role": "member" }],
    });
    let group = Group::of(lab_with(settings).await).await;
    let ask =
        async |peer: [u8; 4], method: &str, path: &str, headers: &[(&str, &str)], body: &str| {
            let mut request = request(method, path, headers, body);
            request
                .extensions_mut()
                .insert(ConnectInfo(SocketAddr::from((peer, 40_000))));
            group.lab.send(request).await
        };
    let dora = [
        ("x-forwarded-user", "dora"),
        ("x-forwarded-email", "dora@example.org"),
    ];
    let proxy = [10, 1, 2, 3];
    // from elsewhere the header says nothing
    for peer in [[10, 2, 0, 1], [127, 0, 0, 1]] {
        ask(peer, "GET", "/v1/me", &dora, "")
            .await
            .problem(401, "sign-in-needed");
    }
    let me = ask(proxy, "GET", "/v1/me", &dora, "").await.json();
    assert_eq!(
        (&me["person"]["name"], &me["scope"]),
        (&json!("dora"), &Value::Null)
    );
    let eve = [
        ("x-forwarded-user", "eve"),
        ("x-forwarded-email", "eve@evil.example"),
    ];
    ask(proxy, "GET", "/v1/me", &eve, "")
        .await
        .problem(403, "not-allowed");
    // the header comes along by itself, as a cookie does
    let body = json!({ "name": "a project", "visibility": "private" }).to_string();
    let mut headers = dora.to_vec();
    headers.push(JSON);
    ask(proxy, "POST", "/v1/projects", &headers, &body)
        .await
        .problem(403, "foreign-origin");
    headers.extend([("origin", ORIGIN), HOST]);
    assert_eq!(
        ask(proxy, "POST", "/v1/projects", &headers, &body)
            .await
            .status,
        201
    );
    ask(proxy, "DELETE", "/v1/sessions/current", &headers, "")
        .await
        .problem(403, "not-allowed");
    // with the next request after they have left
    let people = group.lab.store.people().await.expect("people");
    let dora_here = people.iter().find(|of| of.name == "dora").expect("Dora").id;
    let changes = PersonChanges {
        left: Some(true),
        ..PersonChanges::default()
    };
    group
        .lab
        .store
        .change_person(dora_here, changes)
        .await
        .expect("changed");
    ask(proxy, "GET", "/v1/me", &dora, "")
        .await
        .problem(403, "not-allowed");
    // the audit log and the limits of guesses know who sent it to the proxy
    let mut wrong = vec![
        ("x-forwarded-for", "192.0.2.9"),
        ("origin", ORIGIN),
        HOST,
        JSON,
    ];
    let body = json!({ "name": "Anna", "password": "wrong" }).to_string();
    for number in 0..12 {
        let answer = ask(
            proxy,
            "POST",
            "/v1/sessions",
            &wrong,
            &body.replace("Anna", &format!("{number}")),
        )
        .await;
        assert_eq!(
            answer.status,
            if number < 10 { 403 } else { 429 },
            "{number}"
        );
    }
    wrong[0].1 = "192.0.2.10";
    assert_eq!(
        ask(proxy, "POST", "/v1/sessions", &wrong, &body)
            .await
            .status,
        403
    );
}
