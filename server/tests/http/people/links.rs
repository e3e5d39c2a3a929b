//! How long share links last, and who finds them and takes them back.
use std::collections::HashSet;

use futures_util::future::join_all;
use loadframe_api::people::{NewShare, Visibility};
use serde_json::json;
use uuid::Uuid;

use super::group::{Group, Somebody, id_of, ids, to_job};
use crate::support::example;

fn to_project(project: Uuid) -> NewShare {
    NewShare {
        job: None,
        project: Some(project),
        comparison: None,
        files: true,
        days: 365,
    }
}

async fn reads(group: &Group, link: &Somebody, job: Uuid) -> bool {
    let answer = group.get(link, &format!("/v1/jobs/{job}")).await;
    if answer.status != 200 {
        answer.problem(401, "sign-in-needed");
    }
    answer.status == 200
}

/// Whether somebody finds the link in their list.
async fn finds(group: &Group, by: &Somebody, query: &str, link: Uuid) -> bool {
    let page = group.get(by, &format!("/v1/shares{query}")).await.json();
    ids(&page).contains(&link)
}

/// Takes the link back; the status that is answered.
async fn revoked(group: &Group, by: &Somebody, link: Uuid) -> u16 {
    let path = format!("/v1/shares/{link}");
    group.send(by, "DELETE", &path, "").await.status
}

#[tokio::test]
async fn a_link_ends_with_the_right_of_who_made_it_and_is_the_next_ones_to_take_back() {
    let group = Group::open().await;
    let (anna, bert, carl) = (&group.anna, &group.bert, &group.carl);
    let project = group.project(anna, Visibility::Private, None).await.id;
    let before = group.submit(anna, project).await;
    let (link, id) = group.link(anna, to_project(project)).await;
    let (to_one, one) = group.link(anna, to_job(before, true)).await;
    assert!(reads(&group, &link, before).await);
    assert!(!finds(&group, carl, "", id).await);
    assert_eq!(revoked(&group, carl, id).await, 404);

    let to_carl = json!({ "person": carl.id }).to_string();
    let path = format!("/v1/projects/{project}");
    let handed = group.send(anna, "PATCH", &path, &to_carl).await;
    assert_eq!(handed.status, 200, "{handed:?}");
    let private = group.submit(carl, project).await;
    for job in [before, private] {
        assert!(!reads(&group, &link, job).await);
    }
    group
        .get(&link, "/v1/jobs")
        .await
        .problem(401, "sign-in-needed");
    // her job stays hers to show, wherever it is
    assert!(reads(&group, &to_one, before).await);
    for link in [id, one] {
        assert!(finds(&group, carl, "", link).await);
        assert!(finds(&group, anna, "", link).await);
        assert!(!finds(&group, bert, "", link).await);
        assert_eq!(revoked(&group, bert, link).await, 404);
        assert_eq!(revoked(&group, carl, link).await, 204);
    }
    assert!(!reads(&group, &to_one, before).await);
}

#[tokio::test]
async fn a_link_of_a_group_ends_when_its_maker_works_there_no_more() {
    let group = Group::open().await;
    let (ada, anna, bert, carl) = (&group.ada, &group.anna, &group.bert, &group.carl);
    let shared = group
        .project(anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let job = group.submit(anna, shared).await;
    let own = id_of(&group.send(bert, "POST", "/v1/jobs", example()).await.json());
    let new = json!({ "name": "both", "jobs": [own, job] }).to_string();
    let both = id_of(
        &group
            .send(bert, "POST", "/v1/comparisons", &new)
            .await
            .json(),
    );
    let to_both = NewShare {
        project: None,
        comparison: Some(both),
        ..to_project(shared)
    };
    let mut links = Vec::new();
    for shown in [to_project(shared), to_job(job, false), to_both] {
        links.push(group.link(bert, shown).await);
    }
    let (to_own, _) = group.link(bert, to_job(own, false)).await;
    for (link, _) in &links {
        assert!(reads(&group, link, job).await);
    }
    // as a guest of the group he reads and shares no more
    let role = async |role: &str| {
        let path = format!("/v1/people/{}", bert.id);
        let body = json!({ "role": role }).to_string();
        let answer = group.send(ada, "PATCH", &path, &body).await;
        assert_eq!(answer.status, 200, "{answer:?}");
    };
    role("guest").await;
    for (link, _) in &links {
        assert!(!reads(&group, link, job).await);
    }
    assert!(!reads(&group, &to_own, own).await);
    role("member").await;
    assert!(reads(&group, &to_own, own).await);

    let member = format!("/v1/groups/{}/members/{}", group.paper, bert.id);
    let out = group.send(ada, "DELETE", &member, "").await;
    assert_eq!(out.status, 204);
    for (link, _) in &links {
        assert!(!reads(&group, link, job).await);
    }
    assert!(reads(&group, &to_own, own).await);
    // the comparison is still his; the project and its job are the group's
    let [(_, of_project), (_, of_job), (_, of_both)] = links.as_slice() else {
        panic!("three links");
    };
    assert!(finds(&group, anna, &format!("?job={job}"), *of_job).await);
    assert!(!finds(&group, carl, &format!("?job={job}"), *of_job).await);
    for (link, of_anna) in [(of_project, 204), (of_job, 204), (of_both, 404)] {
        assert_eq!(finds(&group, anna, "", *link).await, of_anna == 204);
        assert_eq!(revoked(&group, &group.gina, *link).await, 404);
        assert_eq!(revoked(&group, anna, *link).await, of_anna);
    }
    assert_eq!(revoked(&group, bert, *of_both).await, 204);
}

#[tokio::test]
async fn links_of_others_are_not_in_the_way_of_ones_own() {
    const MANY: usize = 1000;
    let group = Group::open().await;
    let (anna, carl) = (&group.anna, &group.carl);
    let [hers, his] = [
        id_of(&group.send(anna, "POST", "/v1/jobs", example()).await.json()),
        id_of(&group.send(carl, "POST", "/v1/jobs", example()).await.json()),
    ];
    let (_, link) = group.link(anna, to_job(hers, false)).await;
    let store = &group.lab.store;
    let made = (0..MANY).map(|_| store.create_share(carl.id, to_job(his, false)));
    let made = join_all(made).await;
    assert!(made.iter().all(Result::is_ok));
    let listed = group.get(anna, "/v1/shares").await.json();
    assert_eq!((ids(&listed), &listed["next"]), (vec![link], &json!(null)));

    // all of them, in pages, the newest first; an administrator's hold hers too
    for (by, count) in [(carl, MANY), (&group.ada, MANY + 1)] {
        let (mut seen, mut cursor) = (Vec::new(), String::new());
        loop {
            let path = format!("/v1/shares?limit=400{cursor}");
            let page = group.get(by, &path).await.json();
            seen.extend(ids(&page));
            match page["next"].as_str() {
                Some(next) => cursor = format!("&cursor={next}"),
                None => break,
            }
        }
        let different: HashSet<&Uuid> = seen.iter().collect();
        assert_eq!((seen.len(), different.len()), (count, count));
        assert_eq!(seen.contains(&link), by.id != carl.id);
    }
    let refused = group.get(carl, "/v1/shares?cursor=of-tomorrow").await;
    refused.problem(422, "invalid-request");
}
