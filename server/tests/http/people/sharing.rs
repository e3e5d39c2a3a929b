//! Who sees what: projects, groups, links, and the log of it.
use loadframe_api::people::{NewShare, Visibility};
use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, Somebody, id_of, ids, to_job};
use crate::support::{JSON, Lab, example, request};

async fn listed(group: &Group, by: &Somebody, query: &str) -> Vec<Uuid> {
    ids(&group.get(by, &format!("/v1/jobs{query}")).await.json())
}

#[tokio::test]
async fn lists_and_searches_hold_what_one_sees() {
    let group = Group::open().await;
    let (anna, bert, carl, gina) = (&group.anna, &group.bert, &group.carl, &group.gina);
    let shared = group
        .project(anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let public = group.project(anna, Visibility::Everyone, None).await.id;
    let private = id_of(&group.send(anna, "POST", "/v1/jobs", example()).await.json());
    let in_group = group.submit(bert, shared).await;
    let for_all = group.submit(anna, public).await;
    let none: [Uuid; 0] = [];
    for (by, query, expected) in [
        (anna, "", &[for_all, in_group, private][..]),
        (&group.ada, "", &[for_all, in_group, private]),
        (bert, "", &[for_all, in_group]),
        (carl, "", &[for_all]),
        (gina, "", &[for_all, in_group]),
        (anna, "?whose=mine", &[for_all, private]),
        (bert, "?whose=groups", &[in_group]),
        (bert, "?whose=shared", &[for_all]),
        (carl, "?whose=mine", &none),
        (&group.ada, "?whose=groups", &none),
    ] {
        assert_eq!(
            listed(&group, by, query).await,
            expected,
            "{} {query}",
            by.name
        );
        // a search finds no more than the list has
        let search = match query {
            "" => "?q=fabric".to_owned(),
            query => format!("{query}&q=fabric"),
        };
        let found = listed(&group, by, &search).await;
        assert!(
            found.iter().all(|id| expected.contains(id)),
            "{} {search}",
            by.name
        );
    }
    assert_eq!(listed(&group, carl, &format!("?q={private}")).await, none);
    assert_eq!(
        listed(&group, carl, &format!("?project={shared}")).await,
        none
    );
    let projects = group.get(carl, "/v1/projects").await.json();
    let seen = ids(&projects);
    assert!(seen.contains(&public) && !seen.contains(&shared));
    // the same tag for another person would show the other's list
    let tag = |answer: &crate::support::Answer| answer.header("etag").to_owned();
    let (hers, his) = (
        group.get(anna, "/v1/jobs").await,
        group.get(carl, "/v1/jobs").await,
    );
    assert_ne!(tag(&hers), tag(&his));
}

#[tokio::test]
async fn a_list_in_pages_is_the_same_by_every_way_to_it() {
    let group = Group::open().await;
    let (anna, bert) = (&group.anna, &group.bert);
    let mut projects = Vec::new();
    for visibility in [Visibility::Group, Visibility::Everyone, Visibility::Private] {
        projects.push(group.project(anna, visibility, None).await.id);
    }
    projects.push(
        group
            .project(bert, Visibility::Group, Some(group.paper))
            .await
            .id,
    );
    for turn in 0..24 {
        let by = if turn % 8 == 3 { bert } else { anna };
        let project = if by.id == bert.id {
            projects[3]
        } else {
            projects[turn * 7 % 4]
        };
        group.submit(by, project).await;
    }
    for by in [anna, bert, &group.carl, &group.gina] {
        for part in ["", "whose=mine&", "whose=groups&", "whose=shared&"] {
            // a filter that every job passes goes the other way, through all jobs
            let whole = listed(&group, by, &format!("?{part}status=queued&limit=200")).await;
            let mut merged = Vec::new();
            let mut cursor = String::new();
            loop {
                let path = format!("/v1/jobs?{part}limit=5{cursor}");
                let page = group.get(by, &path).await.json();
                merged.extend(ids(&page));
                match page["next"].as_str() {
                    Some(next) => cursor = format!("&cursor={next}"),
                    None => break,
                }
            }
            assert_eq!(merged, whole, "{} {part}", by.name);
        }
    }
    assert_eq!(listed(&group, anna, "?limit=200").await.len(), 24);
}

#[tokio::test]
async fn a_job_moves_and_a_project_is_shown_archived_and_handed_over() {
    let group = Group::open().await;
    let (anna, bert) = (&group.anna, &group.bert);
    let id = id_of(&group.send(anna, "POST", "/v1/jobs", example()).await.json());
    let path = format!("/v1/jobs/{id}");
    let shared = group
        .project(anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let to = |project: Uuid| json!({ "project": project }).to_string();
    group.get(bert, &path).await.problem(404, "not-found");
    assert_eq!(
        group.send(anna, "PATCH", &path, &to(shared)).await.status,
        200
    );
    assert_eq!(
        group.get(bert, &path).await.json()["project"]["id"],
        json!(shared)
    );
    // nobody moves a job to where they cannot put one
    let carls = group
        .project(&group.carl, Visibility::Private, None)
        .await
        .id;
    group
        .send(anna, "PATCH", &path, &to(carls))
        .await
        .problem(404, "not-found");

    let project = format!("/v1/projects/{shared}");
    let change = async |by: &Somebody, body: Value| {
        group.send(by, "PATCH", &project, &body.to_string()).await
    };
    let private = change(anna, json!({ "visibility": "private" })).await;
    assert_eq!(
        private.problem(422, "invalid-request")["violations"][0]["pointer"],
        "/visibility"
    );
    let archived = change(bert, json!({ "archived": true, "name": "Old" })).await;
    assert_eq!(archived.json()["name"], "Old");
    assert!(
        listed(&group, anna, "").await.is_empty(),
        "archived ones are not in the way"
    );
    assert_eq!(
        listed(&group, anna, &format!("?project={shared}")).await,
        [id]
    );
    let late = group
        .send(
            anna,
            "POST",
            &format!("/v1/jobs?project={shared}"),
            example(),
        )
        .await;
    late.problem(403, "not-allowed");
    change(bert, json!({ "archived": false })).await;
    let to_bert = || json!({ "person": bert.id, "visibility": "private" });
    // a group's project leaves the group by an administrator
    change(bert, to_bert()).await.problem(403, "not-allowed");
    let handed = change(&group.ada, to_bert()).await;
    assert_eq!(handed.json()["person"]["name"], "Bert");
    // whose job it is sees it, wherever it is
    assert_eq!(group.get(anna, &path).await.status, 200);
    group
        .get(&group.gina, &path)
        .await
        .problem(404, "not-found");
    let foreign = change(&group.carl, json!({ "name": "x" })).await;
    foreign.problem(404, "not-found");
}

#[tokio::test]
async fn a_group_has_a_name_of_its_own_and_members_that_come_and_go() {
    let group = Group::open().await;
    let body = json!({ "name": "PAPER" }).to_string();
    let twice = group.send(&group.ada, "POST", "/v1/groups", &body).await;
    assert_eq!(
        twice.problem(422, "invalid-request")["violations"][0]["pointer"],
        "/name"
    );
    let shared = group
        .project(&group.anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let id = group.submit(&group.anna, shared).await;
    let path = format!("/v1/jobs/{id}");
    let member = format!("/v1/groups/{}/members/{}", group.paper, group.carl.id);
    group
        .get(&group.carl, &path)
        .await
        .problem(404, "not-found");
    assert_eq!(group.send(&group.ada, "PUT", &member, "").await.status, 204);
    assert_eq!(group.get(&group.carl, &path).await.status, 200);
    assert_eq!(
        group.send(&group.ada, "DELETE", &member, "").await.status,
        204
    );
    group
        .get(&group.carl, &path)
        .await
        .problem(404, "not-found");
    let foreign = json!({ "name": "x", "visibility": "group", "group": group.paper }).to_string();
    let refused = group
        .send(&group.carl, "POST", "/v1/projects", &foreign)
        .await;
    assert_eq!(
        refused.problem(422, "invalid-request")["violations"][0]["pointer"],
        "/group"
    );
}

#[tokio::test]
async fn a_key_and_a_reference_show_nothing_of_others() {
    let group = Group::open().await;
    let (anna, carl) = (&group.anna, &group.carl);
    let submit = async |by: &Somebody| {
        let (name, value) = &by.known_by;
        let headers = [
            (*name, &**value),
            ("origin", "http://localhost"),
            JSON,
            ("idempotency-key", "monday"),
        ];
        group
            .lab
            .send(request("POST", "/v1/jobs", &headers, example()))
            .await
    };
    let (hers, his) = (submit(anna).await, submit(carl).await);
    assert_ne!(id_of(&hers.json()), id_of(&his.json()));
    assert_eq!(id_of(&submit(anna).await.json()), id_of(&hers.json()));

    // a calibration names jobs whose results it is fitted to: a foreign one is as one that is missing
    let mut refusals = Vec::new();
    for id in [id_of(&hers.json()), Uuid::from_u128(404)] {
        let examples = loadframe_api::JobKind::Calibrate.examples();
        let mut body: Value = serde_json::from_str(examples[0].body).expect("JSON");
        body["spec"]["measured"] = json!({ "job_id": id });
        let answer = group
            .send(carl, "POST", "/v1/jobs?dry_run=true", &body.to_string())
            .await;
        refusals.push(answer.text().replace(&id.to_string(), "ID"));
    }
    assert_eq!(refusals[0], refusals[1]);
}

#[tokio::test]
async fn a_link_shows_one_job_until_it_ends_and_counts_who_comes() {
    let lab = Lab::open().await;
    let id = lab.finished(&[("curve.csv", b"a\n1\n")]).await;
    let group = Group::of(lab).await;
    let ada = &group.ada;
    let make = async |body: Value| {
        group
            .send(ada, "POST", "/v1/shares", &body.to_string())
            .await
    };
    let made = make(json!({ "job": id, "files": true, "days": 2 })).await;
    assert_eq!(made.status, 201, "{made:?}");
    let path = made.json()["path"].as_str().expect("a path").to_owned();
    let (page, secret) = path.split_once('#').expect("a secret");
    assert_eq!(page, "/shared");
    let bearer = format!("Bearer {secret}");
    let read = async |path: &str| {
        group
            .lab
            .get_with(path, &[("authorization", &bearer)])
            .await
    };
    let me = read("/v1/me").await.json();
    assert_eq!(
        (me["kind"].as_str(), me["files"].as_bool()),
        (Some("share"), Some(true))
    );
    assert_eq!(me["job"], json!(id));
    for what in [
        "",
        "/curve",
        "/outcome",
        "/files",
        "/files/curve.csv",
        "/archive.zip",
        "/log",
    ] {
        assert_eq!(
            read(&format!("/v1/jobs/{id}{what}")).await.status,
            200,
            "{what}"
        );
    }
    assert_eq!(ids(&read("/v1/jobs").await.json()), [id]);
    let listed = group.get(ada, &format!("/v1/shares?job={id}")).await.json();
    assert_eq!(
        listed["items"][0]["uses"], 1,
        "an address counts once an hour"
    );
    assert!(!listed.to_string().contains(secret));

    let share = format!("/v1/shares/{}", id_of(&made.json()));
    group
        .send(&group.carl, "DELETE", &share, "")
        .await
        .problem(404, "not-found");
    assert_eq!(group.send(ada, "DELETE", &share, "").await.status, 204);
    read(&format!("/v1/jobs/{id}"))
        .await
        .problem(401, "sign-in-needed");

    // it ends with its job
    let (link, _) = group.link(ada, to_job(id, false)).await;
    assert_eq!(
        group.get(&link, &format!("/v1/jobs/{id}")).await.status,
        200
    );
    assert_eq!(
        group
            .send(ada, "DELETE", &format!("/v1/jobs/{id}"), "")
            .await
            .status,
        204
    );
    group
        .get(&link, &format!("/v1/jobs/{id}"))
        .await
        .problem(401, "sign-in-needed");
    make(json!({ "job": id })).await.problem(404, "not-found");
    for body in [json!({}), json!({ "job": id, "project": id })] {
        make(body).await.problem(422, "invalid-request");
    }
}

#[tokio::test]
async fn a_link_to_a_project_shows_its_jobs() {
    let group = Group::open().await;
    let anna = &group.anna;
    let project = group.project(anna, Visibility::Private, None).await.id;
    let (inside, outside) = (
        group.submit(anna, project).await,
        id_of(&group.send(anna, "POST", "/v1/jobs", example()).await.json()),
    );
    let shown = NewShare {
        job: None,
        project: Some(project),
        comparison: None,
        files: false,
        days: 1,
    };
    let (link, _) = group.link(anna, shown).await;
    assert_eq!(listed(&group, &link, "").await, [inside]);
    group
        .get(&link, &format!("/v1/jobs/{outside}"))
        .await
        .problem(404, "not-found");
    let me = group.get(&link, "/v1/me").await.json();
    assert_eq!(me["project"]["id"], json!(project));
}

#[tokio::test]
async fn the_log_tells_who_did_what_and_only_grows() {
    let group = Group::open().await;
    let (ada, anna) = (&group.ada, &group.anna);
    let answer = group.send(anna, "POST", "/v1/jobs", example()).await;
    let id = id_of(&answer.json());
    let submitted_by = answer.header("x-request-id").to_owned();
    let path = format!("/v1/jobs/{id}");
    group
        .send(anna, "PATCH", &path, r#"{"name": "=cmd()"}"#)
        .await;
    group
        .send(anna, "POST", &format!("{path}/cancel"), "")
        .await;
    group.send(anna, "DELETE", &path, "").await;
    let log = group
        .get(ada, &format!("/v1/audit?object={id}"))
        .await
        .json();
    let lines = log["items"].as_array().expect("lines");
    let actions: Vec<_> = lines.iter().map(|line| line["action"].as_str()).collect();
    let expected = [
        "job.deleted",
        "job.cancelled",
        "job.changed",
        "job.submitted",
    ];
    assert_eq!(actions, expected.map(Some));
    let first = &lines[3];
    assert_eq!(
        (first["who"].as_str(), first["person"].clone()),
        (Some("Anna"), json!(anna.id))
    );
    assert_eq!(first["request"].as_str(), Some(&*submitted_by));
    assert_eq!(first["address"], "192.0.2.1");
    assert!(first["credential"].is_string());

    let csv = group.get(ada, "/v1/audit.csv").await;
    assert!(csv.header("content-type").starts_with("text/csv"));
    let text = csv.text();
    assert!(text.starts_with("number,at,who,"));
    assert!(text.contains("\"'=cmd()\""), "no cell is a formula");
    let all = group.get(ada, "/v1/audit?limit=1000").await.json();
    let count = all["items"].as_array().map(Vec::len);
    assert_eq!(Some(text.lines().count() - 1), count);
    // pages hold every line once
    let mut numbers = Vec::new();
    let mut cursor = String::new();
    loop {
        let page = group
            .get(ada, &format!("/v1/audit?limit=3{cursor}"))
            .await
            .json();
        let items = page["items"].as_array().expect("lines").clone();
        numbers.extend(items.iter().filter_map(|line| line["number"].as_u64()));
        match page["next"].as_str() {
            Some(next) => cursor = format!("&cursor={next}"),
            None => break,
        }
    }
    assert_eq!(Some(numbers.len()), count);
    assert!(numbers.is_sorted_by(|a, b| a > b));
}
