//! Comparisons among people: who sees which of the jobs, and links.
use loadframe_api::people::{NewShare, Visibility};
use serde_json::json;
use uuid::Uuid;

use super::group::{Group, id_of, ids};
use crate::support::Lab;

#[tokio::test]
async fn a_foreign_job_is_missing_like_one_that_does_not_exist() {
    let group = Group::open().await;
    let project = group
        .project(&group.anna, Visibility::Private, None)
        .await
        .id;
    let annas = group.submit(&group.anna, project).await;
    let absent = Uuid::from_u128(404);
    for path in ["/v1/curves", "/v1/differences"] {
        let answer = group
            .get(&group.bert, &format!("{path}?jobs={annas},{absent}"))
            .await
            .json();
        assert_eq!(answer["missing"], json!([annas, absent]), "{path}");
        let answer = group
            .get(&group.bert, &format!("{path}?project={project}"))
            .await
            .json();
        let list = if path == "/v1/curves" {
            "without"
        } else {
            "jobs"
        };
        assert_eq!(answer[list], json!([]));
    }
    let body = json!({ "name": "a", "jobs": [annas] }).to_string();
    let refused = group
        .send(&group.bert, "POST", "/v1/comparisons", &body)
        .await;
    let refused = refused.problem(422, "invalid-request");
    let body = json!({ "name": "a", "jobs": [absent] }).to_string();
    let unknown = group
        .send(&group.bert, "POST", "/v1/comparisons", &body)
        .await;
    let unknown = unknown.problem(422, "invalid-request");
    assert_eq!(
        refused["violations"][0]["detail"],
        unknown["violations"][0]["detail"]
    );
}

#[tokio::test]
async fn a_comparison_shows_others_only_the_jobs_that_they_see() {
    let group = Group::open().await;
    let anna = &group.anna;
    let private = group.project(anna, Visibility::Private, None).await.id;
    let shared = group.project(anna, Visibility::Group, None).await.id;
    let [hidden, seen] = [
        group.submit(anna, private).await,
        group.submit(anna, shared).await,
    ];
    let body = json!({ "name": "a", "jobs": [hidden, seen], "project": shared }).to_string();
    let made = group
        .send(anna, "POST", "/v1/comparisons", &body)
        .await
        .json();
    let id = id_of(&made);
    let read = group
        .get(&group.bert, &format!("/v1/comparisons/{id}"))
        .await
        .json();
    assert_eq!(read["jobs"], json!([seen]));
    let differences = group
        .get(&group.bert, &format!("/v1/differences?comparison={id}"))
        .await
        .json();
    assert_eq!(differences["missing"], json!([hidden]));
    assert_eq!(
        ids(&group.get(&group.bert, "/v1/comparisons").await.json()),
        [id]
    );
    assert_eq!(
        ids(&group.get(&group.carl, "/v1/comparisons").await.json()),
        Vec::<Uuid>::new()
    );
}

#[tokio::test]
async fn a_link_shows_a_comparison_with_its_jobs_and_nothing_else() {
    let group = Group::open().await;
    let anna = &group.anna;
    let project = group.project(anna, Visibility::Private, None).await.id;
    let [one, other, outside] = [
        group.submit(anna, project).await,
        group.submit(anna, project).await,
        group.submit(anna, project).await,
    ];
    let body = json!({ "name": "a", "jobs": [one, other] }).to_string();
    let id = id_of(
        &group
            .send(anna, "POST", "/v1/comparisons", &body)
            .await
            .json(),
    );
    let shown = NewShare {
        job: None,
        project: None,
        comparison: Some(id),
        files: false,
        days: 1,
    };
    let (stranger, share) = group.link(anna, shown).await;
    let me = group.get(&stranger, "/v1/me").await.json();
    assert_eq!(me["comparison"], json!(id));
    let read = group
        .get(&stranger, &format!("/v1/comparisons/{id}"))
        .await
        .json();
    assert_eq!(read["jobs"], json!([one, other]));
    let mut listed = ids(&group.get(&stranger, "/v1/jobs").await.json());
    listed.sort();
    assert_eq!(listed, [one, other]);
    assert_eq!(
        ids(&group.get(&stranger, "/v1/jobs?tag=none").await.json()),
        Vec::<Uuid>::new()
    );
    assert_eq!(
        group
            .get(&stranger, &format!("/v1/jobs/{one}"))
            .await
            .status,
        200
    );
    assert_eq!(
        group
            .get(&stranger, &format!("/v1/jobs/{outside}"))
            .await
            .status,
        404
    );
    assert_eq!(
        group
            .get(&stranger, &format!("/v1/jobs/{one}/files"))
            .await
            .status,
        403
    );
    let answer = group
        .get(&stranger, &format!("/v1/curves?jobs={one},{outside}"))
        .await
        .json();
    assert_eq!(answer["missing"], json!([outside]));
    let path = format!("/v1/comparisons/{id}");
    assert_eq!(group.send(&stranger, "DELETE", &path, "").await.status, 403);

    let links = group
        .get(anna, &format!("/v1/shares?comparison={id}"))
        .await
        .json();
    assert_eq!(ids(&links), [share]);
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    assert_eq!(
        group.get(&stranger, "/v1/me").await.status,
        401,
        "it ends with its comparison"
    );
}

#[tokio::test]
async fn only_jobs_that_one_may_change_are_shared_by_a_comparison() {
    let group = Group::open().await;
    let shared = group.project(&group.anna, Visibility::Group, None).await.id;
    let annas = group.submit(&group.anna, shared).await;
    let own = group
        .project(&group.bert, Visibility::Private, None)
        .await
        .id;
    let berts = group.submit(&group.bert, own).await;
    let body = json!({ "name": "a", "jobs": [annas, berts] }).to_string();
    let made = group
        .send(&group.bert, "POST", "/v1/comparisons", &body)
        .await;
    let body = json!({ "comparison": id_of(&made.json()) }).to_string();
    let refused = group.send(&group.bert, "POST", "/v1/shares", &body).await;
    let refused = refused.problem(403, "not-allowed");
    let detail = refused["detail"].as_str().unwrap_or("");
    assert!(detail.starts_with("1 of the 2 jobs"), "{detail}");
    let carls = group.send(&group.carl, "POST", "/v1/shares", &body).await;
    assert_eq!(carls.status, 404);
}

#[tokio::test]
async fn comparisons_of_one_person_become_the_first_administrators() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let body = json!({ "name": "a", "jobs": [id] }).to_string();
    let kept = id_of(&lab.post("/v1/comparisons", &body).await.json());
    let group = Group::of(lab).await;
    let read = group
        .get(&group.ada, &format!("/v1/comparisons/{kept}"))
        .await
        .json();
    assert_eq!(read["owner"]["id"], json!(group.ada.id));
    let hidden = group
        .get(&group.anna, &format!("/v1/comparisons/{kept}"))
        .await;
    assert_eq!(hidden.status, 404);
}
