//! What a person may use, over HTTP; and why a job waits.
use serde_json::{Value, json};

use super::group::{Group, id_of};
use crate::support::example;

/// The example with another priority.
fn with_priority(priority: i32) -> String {
    let mut body: Value = serde_json::from_str(example()).expect("JSON");
    body["priority"] = json!(priority);
    body.to_string()
}

#[tokio::test]
async fn limits_are_set_by_administrators_shown_before_submitting_and_held() {
    let group = Group::open().await;
    let (ada, anna) = (&group.ada, &group.anna);
    let path = format!("/v1/people/{}/limits", anna.id);
    let dry = async |body: &str| {
        group
            .send(anna, "POST", "/v1/jobs?dry_run=true", body)
            .await
    };

    let free = dry(example()).await.json();
    assert_eq!(free["allowance"]["left"]["disk_gb"], Value::Null);
    let rushed = dry(&with_priority(1)).await;
    rushed.problem(422, "invalid-job");
    assert_eq!(rushed.json()["violations"][0]["pointer"], "/priority");
    assert_eq!(
        rushed.json()["detail"],
        "a priority above 0 is a right that an administrator gives"
    );

    let limits = json!({ "running": 2, "queued_core_h": 1, "may_hurry": true }).to_string();
    group
        .send(anna, "PUT", &path, &limits)
        .await
        .problem(403, "not-allowed");
    let set = group.send(ada, "PUT", &path, &limits).await;
    assert_eq!(
        (set.status, &set.json()["left"]["running"]),
        (200, &json!(2))
    );
    let people = group.get(ada, "/v1/people").await.json();
    let shown = people["items"].as_array().expect("people").iter();
    let mut shown = shown.filter(|person| person["name"] == "Anna");
    assert_eq!(shown.next().expect("Anna")["limits"]["running"], 2);

    assert_eq!(dry(&with_priority(1)).await.status, 200);
    let before = dry(example()).await.json()["allowance"]["left"]["queued_core_h"].clone();
    assert_eq!(before, json!(1.0));
    let submitted = group.send(anna, "POST", "/v1/jobs", example()).await;
    assert_eq!(submitted.status, 201);
    let mine = group.get(anna, "/v1/me/limits").await.json();
    let left = mine["left"]["queued_core_h"].as_f64().expect("a limit");
    assert!(
        left < 1.0 && mine["used"]["queued_core_h"].as_f64() > Some(0.0),
        "{mine}"
    );

    let none = json!({ "queued_core_h": 0 }).to_string();
    assert_eq!(group.send(ada, "PUT", &path, &none).await.status, 200);
    let refused = group.send(anna, "POST", "/v1/jobs", example()).await;
    refused.problem(422, "invalid-job");
    let detail = refused.json()["detail"].as_str().expect("text").to_owned();
    assert!(
        detail.starts_with("the limit queued_core_h of 0 core h would be exceeded"),
        "{detail}"
    );

    for bad in [
        json!({ "running": 0 }),
        json!({ "disk_gb": -1 }),
        json!({ "queued_core_h": -1 }),
        json!({ "queued_core_h": 1e300 }),
        json!({ "queued_core_h": "all" }),
        json!({ "running": 1.5 }),
        json!({ "files": 1 }),
    ] {
        let answer = group.send(ada, "PUT", &path, &bad.to_string()).await;
        answer.problem(422, "invalid-request");
    }
    // who is no person has no limits
    let log = group.get(ada, "/v1/audit").await.text();
    assert!(
        log.contains("person.limited") && log.contains("running 2, queued 1 core h"),
        "{log}"
    );
}

#[tokio::test]
async fn a_queued_job_tells_why_it_waits() {
    let group = Group::open().await;
    let id = {
        let answer = group.send(&group.anna, "POST", "/v1/jobs", example()).await;
        id_of(&answer.json())
    };
    let path = format!("/v1/jobs/{id}/waiting");
    let waiting = group.get(&group.anna, &path).await;
    assert_eq!(waiting.status, 200);
    let waiting = waiting.json();
    assert_eq!(
        (&waiting["code"], &waiting["position"]),
        (&json!("no_worker"), &json!(1))
    );
    assert_eq!(waiting["needs"]["threads"], 1);
    let cancel = format!("/v1/jobs/{id}/cancel");
    assert_eq!(
        group.send(&group.anna, "POST", &cancel, "").await.status,
        200
    );
    group.get(&group.anna, &path).await.problem(409, "conflict");
}

#[tokio::test]
async fn a_submission_asks_for_threads_in_a_range() {
    let group = Group::open().await;
    let with = |threads: Value| {
        let mut body: Value = serde_json::from_str(example()).expect("JSON");
        body["threads"] = threads;
        body.to_string()
    };
    let asked = group
        .send(&group.anna, "POST", "/v1/jobs", &with(json!(8)))
        .await;
    assert_eq!((asked.status, &asked.json()["threads"]), (201, &json!(8)));
    for bad in [json!(0), json!(4097), json!(1.5), json!("two")] {
        let refused = group
            .send(&group.anna, "POST", "/v1/jobs", &with(bad))
            .await;
        refused.problem(422, "invalid-job");
        assert_eq!(refused.json()["violations"][0]["pointer"], "/threads");
    }
}
