//! To which project a job goes that names none, and that a repeated one goes nowhere else.
use loadframe_api::people::Visibility;
use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, Somebody, id_of};
use crate::support::{JSON, example, request};

/// The project that somebody's account was made with.
async fn first_of(group: &Group, by: &Somebody) -> Uuid {
    let projects = group.get(by, "/v1/projects").await.json();
    let name = format!("Jobs of {}", by.name);
    let items = projects["items"].as_array().expect("projects");
    let is_first = |project: &&Value| project["name"] == json!(name);
    id_of(items.iter().find(is_first).expect("a first project"))
}

async fn changed(group: &Group, by: &Somebody, project: Uuid, changes: Value) {
    let path = format!("/v1/projects/{project}");
    let answer = group.send(by, "PATCH", &path, &changes.to_string()).await;
    assert_eq!(answer.status, 200, "{answer:?}");
}

/// Submits without naming a project; the job, and where it went.
async fn submitted(group: &Group, by: &Somebody) -> (String, Uuid) {
    let answer = group.send(by, "POST", "/v1/jobs", example()).await;
    assert_eq!(answer.status, 201, "{answer:?}");
    let job = answer.json();
    (format!("/v1/jobs/{}", id_of(&job)), id_of(&job["project"]))
}

#[tokio::test]
async fn jobs_do_not_go_to_what_somebody_left_behind() {
    let group = Group::open().await;
    let (ada, anna, bert) = (&group.ada, &group.anna, &group.bert);
    // older than any of Bert's, and read by everyone
    let left = first_of(&group, anna).await;
    changed(&group, anna, left, json!({ "visibility": "everyone" })).await;
    let own = first_of(&group, bert).await;
    let person = format!("/v1/people/{}", anna.id);
    let leaves = json!({ "left": true }).to_string();
    assert_eq!(group.send(ada, "PATCH", &person, &leaves).await.status, 200);
    let path = format!("{person}/hand-over");
    let to = json!({ "to": bert.id }).to_string();
    assert_eq!(group.send(ada, "POST", &path, &to).await.status, 204);

    let (job, project) = submitted(&group, bert).await;
    assert_eq!(project, own);
    group.get(&group.carl, &job).await.problem(404, "not-found");
    // nobody hands over to themselves what is theirs
    let path = format!("/v1/people/{}/hand-over", bert.id);
    group.send(ada, "POST", &path, &to).await;
    assert_eq!(submitted(&group, bert).await.1, own);
}

#[tokio::test]
async fn nobody_chooses_for_others_where_their_jobs_go() {
    let group = Group::open().await;
    let (anna, bert) = (&group.anna, &group.bert);
    let (given, own) = (first_of(&group, anna).await, first_of(&group, bert).await);
    let gift = json!({ "name": "Jobs of Bert", "visibility": "everyone", "person": bert.id });
    changed(&group, anna, given, gift).await;
    let (job, project) = submitted(&group, bert).await;
    assert_eq!(project, own);
    for other in [anna, &group.carl] {
        group.get(other, &job).await.problem(404, "not-found");
    }
    // it takes no job by itself when the others take none, and any that names it
    changed(&group, bert, own, json!({ "archived": true })).await;
    for path in ["/v1/jobs", "/v1/jobs?dry_run=true"] {
        let answer = group.send(bert, "POST", path, example()).await;
        answer.problem(409, "conflict");
    }
    group.submit(bert, given).await;
    let made = group.project(bert, Visibility::Private, None).await.id;
    assert_eq!(submitted(&group, bert).await.1, made);
    changed(&group, bert, own, json!({ "archived": false })).await;
    // given to whom it is already, it stays what it was
    changed(&group, bert, own, json!({ "person": bert.id })).await;
    assert_eq!(submitted(&group, bert).await.1, own);

    // given back, it is shown to whom Bert has chosen
    changed(&group, bert, given, json!({ "person": anna.id })).await;
    let answer = group.send(anna, "POST", "/v1/jobs", example()).await;
    answer.problem(409, "conflict");
    // so it is with one that a group had
    let paper = json!({ "group": group.paper, "visibility": "group" });
    changed(&group, bert, made, paper).await;
    changed(&group, bert, own, json!({ "archived": true })).await;
    let back = json!({ "person": bert.id });
    changed(&group, &group.ada, made, back).await;
    let answer = group.send(bert, "POST", "/v1/jobs", example()).await;
    answer.problem(409, "conflict");
}

#[tokio::test]
async fn the_same_key_for_another_project_is_another_request() {
    let group = Group::open().await;
    let anna = &group.anna;
    let project = group.project(anna, Visibility::Private, None).await.id;
    let submit = async |path: &str, key: &str| {
        let (name, value) = &anna.known_by;
        let headers = [
            (*name, &**value),
            ("origin", "http://localhost"),
            JSON,
            ("idempotency-key", key),
        ];
        group
            .lab
            .send(request("POST", path, &headers, example()))
            .await
    };
    let [home, there] = ["/v1/jobs".to_owned(), format!("/v1/jobs?project={project}")];
    for (key, one, other) in [("monday", &home, &there), ("friday", &there, &home)] {
        let first = submit(one, key).await;
        assert_eq!(first.status, 201, "{first:?}");
        let refused = submit(other, key).await;
        refused.problem(422, "idempotency-key-reused");
        assert_eq!(submit(one, key).await.json(), first.json());
    }
}

#[tokio::test]
async fn a_job_that_shows_another_name_of_its_project_has_another_tag() {
    let group = Group::open().await;
    let anna = &group.anna;
    let project = group.project(anna, Visibility::Private, None).await.id;
    let path = format!("/v1/jobs/{}", group.submit(anna, project).await);
    let asked = async |tag: &str| {
        let (name, value) = &anna.known_by;
        let headers = [(*name, &**value), ("if-none-match", tag)];
        group.lab.send(request("GET", &path, &headers, "")).await
    };
    let before = asked("\"none\"").await;
    let tag = before.header("etag").to_owned();
    assert_eq!(asked(&tag).await.status, 304);
    changed(&group, anna, project, json!({ "name": "another" })).await;
    let after = asked(&tag).await;
    assert_eq!(after.status, 200);
    assert_eq!(after.json()["project"]["name"], "another");
    // which still names the version that an edit may know
    let (name, value) = &anna.known_by;
    let headers = [
        (*name, &**value),
        ("origin", "http://localhost"),
        JSON,
        ("if-match", after.header("etag")),
    ];
    let edit = request("PATCH", &path, &headers, "{\"name\": \"n\"}");
    assert_eq!(group.lab.send(edit).await.status, 200);
}
