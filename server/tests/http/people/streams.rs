//! Events: each follower hears of what it sees.
use axum::body::Body;
use axum::http::Response;
use futures_util::StreamExt;
use loadframe_api::people::Visibility;
use serde_json::json;

use super::group::{Group, Somebody};
use crate::support::request;

async fn follow(group: &Group, by: &Somebody) -> Response<Body> {
    let (name, value) = &by.known_by;
    let response = group
        .lab
        .begin(request("GET", "/v1/events", &[(name, value)], ""))
        .await;
    assert_eq!(response.status(), 200);
    response
}

/// What comes until the stream ends or `word` was heard.
async fn heard(response: Response<Body>, word: &str) -> String {
    let mut pieces = response.into_body().into_data_stream();
    let mut text = String::new();
    let listen = async {
        while !text.contains(word) {
            match pieces.next().await {
                Some(piece) => text.push_str(&String::from_utf8_lossy(&piece.expect("a piece"))),
                None => break,
            }
        }
    };
    let wait = std::time::Duration::from_secs(20);
    tokio::time::timeout(wait, listen)
        .await
        .expect("it is heard, or the stream ends");
    text
}

#[tokio::test]
async fn a_follower_hears_of_what_it_sees_also_of_its_end() {
    let group = Group::open().await;
    let (anna, bert) = (&group.anna, &group.bert);
    let announcing = tokio::spawn(group.lab.state.announce());
    let private = group.project(anna, Visibility::Private, None).await.id;
    let shared = group
        .project(anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let stream = follow(&group, bert).await;
    let secret = group.submit(anna, private).await;
    group
        .send(anna, "DELETE", &format!("/v1/jobs/{secret}"), "")
        .await;
    let seen = group.submit(anna, shared).await;
    group
        .send(anna, "DELETE", &format!("/v1/jobs/{seen}"), "")
        .await;
    let last = group.submit(anna, shared).await;
    let text = heard(stream, &last.to_string()).await;
    assert!(!text.contains(&secret.to_string()), "{text}");
    assert!(text.contains(&seen.to_string()), "{text}");
    // the same when it is read from the store, from the beginning
    let (name, value) = &bert.known_by;
    let headers = [(*name, &**value), ("last-event-id", "0")];
    let stream = group
        .lab
        .begin(request("GET", "/v1/events", &headers, ""))
        .await;
    let text = heard(stream, &last.to_string()).await;
    assert!(!text.contains(&secret.to_string()), "{text}");
    assert!(
        text.contains(&seen.to_string()) && text.contains("deleted"),
        "{text}"
    );
    // named ones that are foreign are not there
    let path = format!("/v1/events?jobs={secret},{last}");
    let stream = group
        .lab
        .begin(request("GET", &path, &[(name, value)], ""))
        .await;
    let text = heard(stream, &last.to_string()).await;
    assert!(!text.contains(&secret.to_string()), "{text}");
    announcing.abort();
}

#[tokio::test]
async fn a_stream_follows_what_its_follower_may_see() {
    let group = Group::open().await;
    let announcing = tokio::spawn(group.lab.state.announce());
    let shared = group
        .project(&group.anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let job = group.submit(&group.anna, shared).await;
    let stream = follow(&group, &group.carl).await;
    let mut access = group.lab.store.access_changes();
    let version = group.lab.store.access_version().await.expect("a count");
    let joined = group.lab.store.set_member(group.paper, group.carl.id, true);
    joined.await.expect("a member");
    access
        .wait_for(|seen| *seen > version)
        .await
        .expect("it is told");
    // the follower is woken by the same count; a change after it shows what is seen now
    let name = job.to_string();
    let hears = heard(stream, &name);
    let change = async {
        loop {
            let body = json!({ "priority": -1 }).to_string();
            group
                .send(&group.anna, "PATCH", &format!("/v1/jobs/{job}"), &body)
                .await;
            tokio::time::sleep(std::time::Duration::from_millis(100)).await;
        }
    };
    tokio::select! {
        text = hears => assert!(text.contains(&name)),
        () = change => {}
    }
    // and ends with the session
    let stream = follow(&group, &group.carl).await;
    let body = json!({ "left": true }).to_string();
    group
        .send(
            &group.ada,
            "PATCH",
            &format!("/v1/people/{}", group.carl.id),
            &body,
        )
        .await;
    heard(stream, "what never comes").await;
    announcing.abort();
}
