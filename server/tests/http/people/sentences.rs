//! What a group asks that cannot be: one clear sentence each.
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use loadframe_api::Timestamp;
use loadframe_api::people::Visibility;
use loadframe_server::store::Clock;
use serde_json::{Value, json};

use super::group::{Group, PASSWORD, Somebody, to_job};
use crate::support::{Answer, JSON, Lab, example, request};

/// What the answer says: of the first thing wrong with the request, or else of the whole.
fn sentence(answer: &Answer) -> String {
    let problem = answer.json();
    let violations = problem["violations"].as_array().map_or(0, Vec::len);
    assert!(violations <= 1, "one thing is wrong: {problem}");
    let detail = match violations {
        0 => &problem["detail"],
        _ => &problem["violations"][0]["detail"],
    };
    detail.as_str().expect("a sentence").to_owned()
}

/// Holds against it that this one value of the request is wrong; what is told of it.
fn refuses(answer: &Answer, pointer: &str, value: Value) -> Value {
    let problem = answer.problem(422, "invalid-request");
    let violation = &problem["violations"][0];
    assert_eq!(
        (&violation["pointer"], &violation["value"]),
        (&json!(pointer), &value),
        "{problem}"
    );
    violation.clone()
}

async fn asks(group: &Group, by: &Somebody, method: &str, path: &str, body: Value) -> Answer {
    group.send(by, method, path, &body.to_string()).await
}

#[tokio::test]
async fn a_group_name_twice() {
    let group = Group::open().await;
    let answer = asks(
        &group,
        &group.ada,
        "POST",
        "/v1/groups",
        json!({ "name": "paper" }),
    )
    .await;
    refuses(&answer, "/name", json!("paper"));
    assert_eq!(sentence(&answer), "there is a group of this name already");
}

#[tokio::test]
async fn the_last_administrator_leaving() {
    let group = Group::open().await;
    let path = format!("/v1/people/{}", group.ada.id);
    let answer = asks(&group, &group.ada, "PATCH", &path, json!({ "left": true })).await;
    answer.problem(409, "conflict");
    let said = sentence(&answer);
    assert!(said.contains("the last administrator"), "{said}");
}

#[tokio::test]
async fn an_expired_invitation() {
    let now = Arc::new(AtomicI64::new(Timestamp::now().as_millis()));
    let clock = Clock::Told(Arc::clone(&now));
    let lab = Lab::with(|config| config.store.clock = clock).await;
    let group = Group::of(lab).await;
    let new = json!({ "role": "member", "days": 1 });
    let made = asks(&group, &group.ada, "POST", "/v1/invitations", new).await;
    let path = made.json()["path"].as_str().expect("a path").to_owned();
    let (_, secret) = path.split_once('#').expect("a secret");
    let body = json!({ "secret": secret, "name": "Dora", "password": PASSWORD }).to_string();
    let accept = async || {
        let headers = [
            ("origin", "http://localhost:8400"),
            ("host", "localhost:8400"),
            JSON,
        ];
        let path = "/v1/invitations/accept";
        group.lab.send(request("POST", path, &headers, &body)).await
    };
    now.fetch_add(24 * 3_600_000, Ordering::SeqCst);
    let late = accept().await;
    let problem = late.problem(422, "invalid-request");
    assert_eq!(problem["violations"][0]["pointer"], "/secret");
    assert_eq!(
        sentence(&late),
        "this invitation is not in force: it was accepted, taken back or is too old; ask for a new one"
    );
    // a moment earlier it was
    now.fetch_sub(1, Ordering::SeqCst);
    assert_eq!(accept().await.status, 201);
}

#[tokio::test]
async fn a_link_to_a_deleted_job() {
    let group = Group::open().await;
    let project = group.project(&group.anna, Visibility::Private, None).await;
    let job = group.submit(&group.anna, project.id).await;
    let (link, _) = group.link(&group.anna, to_job(job, false)).await;
    let path = format!("/v1/jobs/{job}");
    assert_eq!(group.get(&link, &path).await.status, 200);
    assert_eq!(
        group.send(&group.anna, "DELETE", &path, "").await.status,
        204
    );
    let answer = group.get(&link, &path).await;
    answer.problem(401, "sign-in-needed");
    assert_eq!(
        sentence(&answer),
        "this link is not in force: it has expired or was taken back, or what it showed was deleted"
    );
}

#[tokio::test]
async fn a_webhook_to_a_private_address() {
    let group = Group::open().await;
    let body = json!({ "url": "http://192.168.1.7/hook", "events": ["ended"] });
    let answer = asks(&group, &group.anna, "POST", "/v1/webhooks", body).await;
    refuses(&answer, "/url", json!("http://192.168.1.7/hook"));
    let said = sentence(&answer);
    assert!(
        said.contains("192.168.1.7, which is a private address"),
        "{said}"
    );
}

#[tokio::test]
async fn a_retention_of_zero_days() {
    let group = Group::open().await;
    let project = group.project(&group.anna, Visibility::Private, None).await;
    let path = format!("/v1/projects/{}/retention", project.id);
    let answer = asks(
        &group,
        &group.anna,
        "PUT",
        &path,
        json!({ "snapshots_days": 0 }),
    )
    .await;
    let violation = refuses(&answer, "/snapshots_days", json!(0));
    let allowed = violation["allowed"].as_str().expect("a range");
    assert!(
        allowed.contains('1') && allowed.contains("36500"),
        "{allowed}"
    );
    assert_ne!(sentence(&answer), "");
}

#[tokio::test]
async fn a_quota_below_what_is_used() {
    let lab = Lab::open().await;
    // a MB of files, which becomes the first administrator's
    lab.finished(&[("curve.csv", &[b'1'; 1_000_000])]).await;
    let group = Group::of(lab).await;
    let path = format!("/v1/people/{}/limits", group.ada.id);
    let answer = asks(
        &group,
        &group.ada,
        "PUT",
        &path,
        json!({ "disk_gb": 0.0005 }),
    )
    .await;
    refuses(&answer, "/disk_gb", json!(0.0005));
    assert_eq!(
        sentence(&answer),
        "0.0005 GB are below the 0.001 GB that the person's files take; files have to be deleted first"
    );
    let fits = asks(
        &group,
        &group.ada,
        "PUT",
        &path,
        json!({ "disk_gb": 0.002 }),
    )
    .await;
    assert_eq!(fits.status, 200, "{fits:?}");
}

#[tokio::test]
async fn a_job_where_all_of_ones_projects_are_archived() {
    let group = Group::open().await;
    let projects = group.get(&group.anna, "/v1/projects").await.json();
    for project in projects["items"].as_array().expect("projects") {
        if project["person"]["name"] == "Anna" {
            let path = format!("/v1/projects/{}", project["id"].as_str().expect("an id"));
            let archived = json!({ "archived": true });
            let answer = asks(&group, &group.anna, "PATCH", &path, archived).await;
            assert_eq!(answer.status, 200, "{answer:?}");
        }
    }
    for path in ["/v1/jobs", "/v1/jobs?dry_run=true"] {
        let answer = group.send(&group.anna, "POST", path, example()).await;
        answer.problem(409, "conflict");
        assert_eq!(
            sentence(&answer),
            "you have no project of your own making that takes jobs; make one, bring one back, or name one"
        );
    }
    let listed = group.get(&group.anna, "/v1/jobs").await.json();
    assert_eq!(listed["items"], json!([]), "nothing of it is kept");
}
