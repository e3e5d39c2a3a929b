//! What of old jobs is removed, and what fills the disk.
use std::collections::BTreeMap;

use loadframe_api::Timestamp;
use loadframe_api::people::{HandOver, RetentionRule, Visibility};
use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, Somebody, id_of};
use crate::support::{example, key};

const DAY: i64 = 24 * 3_600_000;

fn in_days(days: i64) -> Timestamp {
    Timestamp(Timestamp::now().as_millis() + days * DAY)
}

/// Submits a job to a project and finishes it with snapshots, a curve and a log.
async fn finished(group: &Group, by: &Somebody, project: Uuid) -> Uuid {
    let id = group.submit(by, project).await;
    let files: [(&str, &[u8]); 5] = [
        ("curve.csv", b"strain,force_n\n0,1\n"),
        ("fragments.csv", b"a\n1\n"),
        ("snapshots.pvd", b"<VTKFile/>"),
        ("snapshots/0001.vtp", b"points"),
        ("log.jsonl", b"{}\n"),
    ];
    group.lab.finish(id, &files).await;
    id
}

async fn names(group: &Group, by: &Somebody, job: Uuid) -> Vec<String> {
    let files = group.get(by, &format!("/v1/jobs/{job}/files")).await.json();
    let files = files["items"].as_array().expect("files").clone();
    files
        .iter()
        .map(|of| of["name"].as_str().expect("a name").to_owned())
        .collect()
}

#[tokio::test]
async fn snapshots_go_before_curves_and_the_outcome_stays() {
    let group = Group::open().await;
    let (anna, store) = (&group.anna, &group.lab.store);
    let project = group.project(anna, Visibility::Private, None).await.id;
    let other = group.project(anna, Visibility::Private, None).await.id;
    let (job, kept) = (
        finished(&group, anna, project).await,
        finished(&group, anna, other).await,
    );
    let path = format!("/v1/projects/{project}/retention");
    let preview = async |query: &str| {
        group.get(anna, &format!("{path}{query}")).await.json()["would_remove"].clone()
    };
    // nothing is old enough today
    assert_eq!(
        preview("?snapshots_days=1").await,
        json!({ "jobs": 0, "files": 0, "bytes": 0 })
    );
    let asked = RetentionRule {
        snapshots_days: Some(10),
        curves_days: Some(20),
    };
    let later = store
        .retention(project, Some(asked), in_days(11))
        .await
        .expect("a preview");
    assert_eq!(
        (
            later.would_remove.jobs,
            later.would_remove.files,
            later.would_remove.bytes
        ),
        (1, 2, 16)
    );
    let later = store
        .retention(project, Some(asked), in_days(21))
        .await
        .expect("a preview");
    assert_eq!(later.would_remove.files, 4);

    let body = json!({ "snapshots_days": 10, "curves_days": 20 }).to_string();
    let set = group.send(anna, "PUT", &path, &body).await;
    assert_eq!(set.status, 200, "{set:?}");
    assert!(set.json()["in_force_at"].is_string());
    // announced for a week: even what is old enough stays until then
    assert_eq!(
        store.retain(in_days(6)).await.expect("nothing to do"),
        (0, 0)
    );
    assert_eq!(store.retain(in_days(11)).await.expect("removed"), (2, 0));
    assert_eq!(
        names(&group, anna, job).await,
        ["curve.csv", "fragments.csv", "log.jsonl", "outcome.json"]
    );
    let gone = group
        .get(anna, &format!("/v1/jobs/{job}/files/snapshots.pvd"))
        .await;
    gone.problem(404, "not-found");
    assert_eq!(
        store.retain(in_days(11)).await.expect("done already"),
        (0, 0)
    );
    assert_eq!(store.retain(in_days(21)).await.expect("removed"), (2, 0));
    assert_eq!(
        names(&group, anna, job).await,
        ["log.jsonl", "outcome.json"]
    );
    assert_eq!(
        names(&group, anna, kept).await.len(),
        6,
        "another project's"
    );

    // all of it comes back, and the rule with which it went is over
    let undo = format!("{path}/undo");
    assert_eq!(group.send(anna, "POST", &undo, "").await.status, 204);
    assert_eq!(names(&group, anna, job).await.len(), 6);
    let curve = group
        .get(anna, &format!("/v1/jobs/{job}/files/curve.csv"))
        .await;
    assert_eq!(curve.text(), "strain,force_n\n0,1\n");
    let view = group.get(anna, &path).await.json();
    assert_eq!(
        (&view["rule"], &view["in_force_at"]),
        (&json!({}), &Value::Null)
    );
    assert_eq!(store.retain(in_days(40)).await.expect("no rule"), (0, 0));

    // and two weeks after it went it is gone for good
    assert_eq!(group.send(anna, "PUT", &path, &body).await.status, 200);
    assert_eq!(store.retain(in_days(21)).await.expect("removed"), (4, 0));
    assert_eq!(
        store.retain(in_days(34)).await.expect("still there"),
        (0, 0)
    );
    assert_eq!(store.retain(in_days(36)).await.expect("gone"), (0, 4));
    assert_eq!(group.send(anna, "POST", &undo, "").await.status, 204);
    assert_eq!(
        names(&group, anna, job).await,
        ["log.jsonl", "outcome.json"]
    );
    store.settled_files().await;
    let result = group.get(anna, &format!("/v1/jobs/{job}")).await.json();
    assert_eq!(result["summary"]["max_force"]["value"], 12.5);
    let audit = group
        .get(&group.ada, &format!("/v1/audit?object={project}"))
        .await
        .json();
    let lines: Vec<String> = audit["items"]
        .as_array()
        .expect("lines")
        .iter()
        .map(|of| format!("{} {}: {}", of["who"], of["action"], of["detail"]).replace('"', ""))
        .collect();
    assert_eq!(lines[0], "Anna retention.undone: 0 files brought back");
    assert_eq!(
        lines[1],
        "server retention.removed: curves of 1 jobs: 2 files"
    );
    assert_eq!(
        lines[3],
        "Anna retention.set: snapshots 10 days, curves 20 days"
    );
}

#[tokio::test]
async fn a_rule_that_cannot_be_is_refused_in_a_sentence() {
    let group = Group::open().await;
    let project = group
        .project(&group.anna, Visibility::Private, None)
        .await
        .id;
    let path = format!("/v1/projects/{project}/retention");
    for (body, pointer) in [
        (json!({ "snapshots_days": 0 }), "/snapshots_days"),
        (
            json!({ "curves_days": -1, "snapshots_days": 1 }),
            "/curves_days",
        ),
        (
            json!({ "snapshots_days": 20, "curves_days": 10 }),
            "/curves_days",
        ),
        (json!({ "curves_days": 10 }), "/curves_days"),
        (json!({ "outcome_days": 10 }), "/outcome_days"),
    ] {
        let answer = group
            .send(&group.anna, "PUT", &path, &body.to_string())
            .await;
        let problem = answer.problem(422, "invalid-request");
        assert_eq!(
            problem["violations"].as_array().map(Vec::len),
            Some(1),
            "{problem}"
        );
        assert_eq!(problem["violations"][0]["pointer"], pointer, "{problem}");
    }
    let zero = group
        .get(&group.anna, &format!("{path}?snapshots_days=0"))
        .await;
    assert_eq!(zero.status, 400);
}

/// What `/v1/storage` says, by person, project and kind.
async fn storage(group: &Group, by: &Somebody) -> BTreeMap<(String, String, String), (u64, u64)> {
    let view = group.get(by, "/v1/storage").await.json();
    let word = |value: &Value| value.as_str().unwrap_or("-").to_owned();
    let line = |of: &Value| {
        let place = (
            word(&of["person"]["name"]),
            word(&of["project"]["id"]),
            word(&of["kind"]),
        );
        (
            place,
            (
                of["files"].as_u64().expect("files"),
                of["bytes"].as_u64().expect("bytes"),
            ),
        )
    };
    view["items"]
        .as_array()
        .expect("items")
        .iter()
        .map(line)
        .collect()
}

#[tokio::test]
async fn disk_use_follows_every_file_wherever_it_goes() {
    let group = Group::open().await;
    let (anna, bert, ada) = (&group.anna, &group.bert, &group.ada);
    let project = group.project(anna, Visibility::Private, None).await.id;
    let other = group.project(bert, Visibility::Private, None).await.id;
    let place = |person: &str, project: Uuid, kind: &str| {
        (person.to_owned(), project.to_string(), kind.to_owned())
    };
    let (first, second) = (
        finished(&group, anna, project).await,
        finished(&group, anna, project).await,
    );
    let all = storage(&group, ada).await;
    assert_eq!(all[&place("Anna", project, "snapshots")], (4, 32));
    assert_eq!(all[&place("Anna", project, "curves")], (4, 2 * (19 + 4)));
    assert_eq!(all[&place("Anna", project, "others")], (2, 6));
    assert_eq!(all[&place("Anna", project, "outcome")].0, 2);
    // others see their own alone
    assert_eq!(storage(&group, anna).await, all);
    assert!(storage(&group, bert).await.is_empty());
    assert!(storage(&group, &group.gina).await.is_empty());
    // a job that moves takes its files along, one that is deleted to the trash
    let moved = json!({ "project": group.project(anna, Visibility::Private, None).await.id });
    let answer = group
        .send(
            anna,
            "PATCH",
            &format!("/v1/jobs/{second}"),
            &moved.to_string(),
        )
        .await;
    assert_eq!(answer.status, 200, "{answer:?}");
    let all = storage(&group, ada).await;
    assert_eq!(all[&place("Anna", project, "snapshots")], (2, 16));
    assert_eq!(
        group
            .send(anna, "DELETE", &format!("/v1/jobs/{second}"), "")
            .await
            .status,
        204
    );
    let all = storage(&group, ada).await;
    assert_eq!(all.len(), 5, "{all:?}");
    let moved_to: Vec<_> = all.keys().filter(|(.., kind)| kind == "trash").collect();
    assert_eq!((moved_to.len(), all[moved_to[0]].0), (1, 6));
    // handed over, then removed by a rule: counted as long as it is there
    let to = json!(HandOver { to: bert.id }).to_string();
    let answer = group
        .send(
            ada,
            "POST",
            &format!("/v1/people/{}/hand-over", anna.id),
            &to,
        )
        .await;
    assert_eq!(answer.status, 204, "{answer:?}");
    let all = storage(&group, ada).await;
    assert_eq!(all[&place("Bert", project, "curves")], (2, 23));
    let rule = RetentionRule {
        snapshots_days: Some(1),
        curves_days: None,
    };
    group
        .lab
        .store
        .set_retention(project, rule)
        .await
        .expect("a rule");
    group.lab.store.retain(in_days(8)).await.expect("removed");
    assert_eq!(storage(&group, ada).await, all);
    group.lab.store.retain(in_days(23)).await.expect("gone");
    let all = storage(&group, ada).await;
    assert!(
        !all.contains_key(&place("Bert", project, "snapshots")),
        "{all:?}"
    );
    // a file that is sent twice is one
    let id = {
        let path = format!("/v1/jobs?project={other}");
        id_of(&group.send(bert, "POST", &path, example()).await.json())
    };
    let lease = group.lab.claim().await;
    for bytes in [b"12".as_slice(), b"12345", b"12345"] {
        let sha256 = loadframe_api::sha256_hex(bytes);
        group
            .lab
            .store
            .upload(key(&lease), "a.csv", &sha256, bytes)
            .await
            .expect("uploaded");
    }
    assert_eq!(lease.job_id, id);
    let all = storage(&group, ada).await;
    assert_eq!(all[&place("Bert", other, "curves")], (1, 5));
    assert!(names(&group, bert, first).await.len() == 4);
}
