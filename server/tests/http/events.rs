//! Streams of events, live and again.
use axum::body::{Body, BodyDataStream};
use futures_util::StreamExt;
use serde_json::Value;

use crate::support::{Lab, request};

/// A client of an event stream.
struct Listener {
    stream: BodyDataStream,
    text: String,
}

/// An event as it was received.
#[derive(Debug)]
struct Received {
    id: u64,
    name: String,
    data: Value,
}

impl Listener {
    async fn open(lab: &Lab, path: &str, headers: &[(&str, &str)]) -> Self {
        let answer = lab.begin(request("GET", path, headers, "")).await;
        assert_eq!(answer.status(), 200);
        assert_eq!(answer.headers()["content-type"], "text/event-stream");
        // no proxy gathers events until they are no news
        assert_eq!(answer.headers()["x-accel-buffering"], "no");
        assert_eq!(answer.headers()["cache-control"], "no-cache, no-transform");
        let body: Body = answer.into_body();
        let mut listener = Self {
            stream: body.into_data_stream(),
            text: String::new(),
        };
        let opening = listener.block().await.expect("an opening");
        assert!(opening.contains("retry: 2000"), "{opening}");
        listener
    }

    /// The next block of lines; `None` at the end of the stream.
    async fn block(&mut self) -> Option<String> {
        loop {
            if let Some((block, rest)) = self.text.split_once("\n\n") {
                let block = block.to_owned();
                self.text = rest.to_owned();
                return Some(block);
            }
            let piece = self.stream.next().await?.expect("readable");
            self.text += std::str::from_utf8(&piece).expect("text");
        }
    }

    async fn next(&mut self) -> Option<Received> {
        let block = self.block().await?;
        let field = |name: &str| {
            let line = block.lines().find_map(|line| line.strip_prefix(name));
            line.unwrap_or_else(|| panic!("{name} is not in {block:?}"))
                .trim()
        };
        Some(Received {
            id: field("id:").parse().expect("a number"),
            name: field("event:").to_owned(),
            data: serde_json::from_str(field("data:")).expect("JSON"),
        })
    }

    /// Skips to the next event of this name.
    async fn next_named(&mut self, name: &str) -> Received {
        loop {
            let event = self.next().await.expect("the stream goes on");
            if event.name == name {
                return event;
            }
        }
    }
}

async fn lab_that_announces() -> Lab {
    let lab = Lab::open().await;
    tokio::spawn(lab.state.announce());
    lab
}

#[tokio::test]
async fn a_stream_begins_with_the_present_and_goes_on_live() {
    let lab = lab_that_announces().await;
    let id = lab.submit().await;
    let mut listener = Listener::open(&lab, &format!("/v1/jobs/{id}/events"), &[]).await;
    let present = listener.next().await.expect("the present state");
    assert_eq!(
        (present.name.as_str(), &present.data["status"]),
        ("job", &"queued".into())
    );
    assert_eq!(present.data["id"], id.to_string());
    let lease = lab.claim().await;
    let running = listener.next_named("job").await;
    assert_eq!(running.data["status"], "running");
    assert!(running.id > present.id);
    lab.report(&lease, 0, vec![vec![0.0, 1.0]]).await;
    let points = listener.next_named("points").await;
    assert_eq!(points.data["total"], 1);
}

#[tokio::test]
async fn what_was_missed_is_replayed_in_order() {
    let lab = lab_that_announces().await;
    let id = lab.submit().await;
    let other = lab.submit().await;
    let path = format!("/v1/jobs/{id}/events");
    let mut listener = Listener::open(&lab, &path, &[]).await;
    let last = listener
        .next()
        .await
        .expect("the present state")
        .id
        .to_string();
    drop(listener);
    // nobody listens meanwhile
    lab.post(&format!("/v1/jobs/{other}/pause"), "").await;
    lab.post(&format!("/v1/jobs/{id}/pause"), "").await;
    lab.post(&format!("/v1/jobs/{id}/cancel"), "").await;

    for (path, headers) in [
        (path.clone(), vec![("last-event-id", last.as_str())]),
        (format!("{path}?last_event_id={last}"), vec![]),
        (format!("/v1/events?jobs={id}&last_event_id={last}"), vec![]),
    ] {
        let mut listener = Listener::open(&lab, &path, &headers).await;
        let mut seen = last.parse::<u64>().expect("a number");
        loop {
            let event = listener.next().await.expect("the stream goes on");
            assert!(event.id > seen);
            seen = event.id;
            assert_eq!(
                event.data["id"],
                id.to_string(),
                "the other job is not told of"
            );
            if event.data["outcome"] == "cancelled" {
                break;
            }
        }
    }
}

#[tokio::test]
async fn all_jobs_can_be_followed_at_once() {
    let lab = lab_that_announces().await;
    let mut listener = Listener::open(&lab, "/v1/events", &[]).await;
    let first = lab.submit().await;
    assert_eq!(
        listener.next_named("job").await.data["id"],
        first.to_string()
    );
    let second = lab.submit().await;
    assert_eq!(
        listener.next_named("job").await.data["id"],
        second.to_string()
    );
    let deleted = request("DELETE", &format!("/v1/jobs/{first}"), &[], "");
    assert_eq!(lab.send(deleted).await.status, 204);
    let event = listener.next_named("deleted").await;
    assert_eq!(event.data["job_id"], first.to_string());
}

#[tokio::test]
async fn a_number_from_another_store_starts_afresh() {
    let lab = lab_that_announces().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}/events?last_event_id=1000000");
    let event = Listener::open(&lab, &path, &[]).await.next().await;
    assert_eq!(event.expect("the present state").data["status"], "queued");
    let bad = [("last-event-id", "x")];
    let refused = lab.get_with(&path, &bad).await;
    refused.problem(400, "bad-request");
}

#[tokio::test]
async fn streams_end_when_the_server_stops() {
    let lab = lab_that_announces().await;
    let mut listener = Listener::open(&lab, "/v1/events", &[]).await;
    lab.state.stopping.cancel();
    assert!(listener.next().await.is_none());
}
