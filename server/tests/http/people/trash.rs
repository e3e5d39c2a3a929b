//! What was deleted: unreachable, counted, brought back whole, and gone when its time is over.
//!
//! One file, long as it is: every way in and out of the trash is held against the same faces of a job.
use std::time::Duration;

use loadframe_api::Timestamp;
use loadframe_api::people::{NewShare, Role, Visibility};
use loadframe_api::worker::ReleaseReason;
use loadframe_server::store::{StoreError, trash::TrashSight};
use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, Somebody, id_of, ids, to_job};
use crate::support::{Lab, request};

const DAY: i64 = 24 * 3_600_000;

fn in_days(days: i64) -> Timestamp {
    Timestamp(Timestamp::now().as_millis() + days * DAY)
}

const FILES: [(&str, &[u8]); 3] = [
    ("curve.csv", b"strain,force_n\n0,1\n"),
    ("snapshots/0001.vtp", b"points"),
    ("log.jsonl", b"{}\n"),
];

/// A job that has ended, with files.
async fn finished(group: &Group, by: &Somebody, project: Uuid) -> Uuid {
    let id = group.submit(by, project).await;
    group.lab.finish(id, &FILES).await;
    id
}

/// Everything that can be read of a job, as it answers now.
async fn faces(group: &Group, by: &Somebody, job: Uuid) -> Vec<(String, u16, Value)> {
    let mut faces = Vec::new();
    for path in [
        "",
        "/curve",
        "/curve.csv",
        "/outcome",
        "/files",
        "/files/curve.csv",
        "/archive.zip",
        "/log",
        "/events",
    ] {
        let path = format!("/v1/jobs/{job}{path}");
        if path.ends_with("/events") {
            let (name, value) = &by.known_by;
            let response = group
                .lab
                .begin(request("GET", &path, &[(*name, &**value)], ""))
                .await;
            faces.push((path, response.status().as_u16(), Value::Null));
            continue;
        }
        let answer = group.get(by, &path).await;
        let body = serde_json::from_slice(&answer.body).unwrap_or_default();
        faces.push((path, answer.status, body));
    }
    faces
}

async fn trashed(group: &Group, by: &Somebody) -> Vec<Value> {
    let page = group.get(by, "/v1/trash").await.json();
    page["items"].as_array().expect("items").clone()
}

#[tokio::test]
async fn a_deleted_job_is_nowhere_and_comes_back_whole() {
    let group = Group::open().await;
    let (anna, bert) = (&group.anna, &group.bert);
    let shared = group
        .project(anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let older = finished(&group, anna, shared).await;
    let job = finished(&group, anna, shared).await;
    let newer = group.submit(anna, shared).await;
    let link = group.link(anna, to_job(job, true)).await.0;
    let body = json!({ "name": "both", "jobs": [job, older] }).to_string();
    let comparison = id_of(
        &group
            .send(anna, "POST", "/v1/comparisons", &body)
            .await
            .json(),
    );
    let before = faces(&group, anna, job).await;
    assert!(
        before.iter().all(|(_, status, _)| *status == 200),
        "{before:?}"
    );
    let used = group.get(anna, "/v1/me/limits").await.json();

    // a member of the group may delete what is the group's; its owner gets it back
    let path = format!("/v1/jobs/{job}");
    assert_eq!(group.send(bert, "DELETE", &path, "").await.status, 204);
    for by in [anna, bert, &group.ada] {
        for (path, status, body) in faces(&group, by, job).await {
            assert_eq!(status, 404, "{path} by {}: {body}", by.name);
        }
    }
    for path in ["", "/files", "/files/curve.csv"] {
        let answer = group.get(&link, &format!("/v1/jobs/{job}{path}")).await;
        assert_eq!(answer.status, 401, "a link to nothing: {answer:?}");
    }
    for query in ["", "?status=finished", "?q=fabric", &format!("?q={job}")] {
        let page = group
            .get(&group.ada, &format!("/v1/jobs{query}"))
            .await
            .json();
        assert!(!ids(&page).contains(&job), "{query}");
    }
    let path = format!("/v1/differences?comparison={comparison}");
    let compared = group.get(anna, &path).await.json();
    assert_eq!(ids(&json!({ "items": compared["jobs"] })), [older]);
    assert_eq!(compared["missing"], json!([job]));
    let after = group.get(anna, "/v1/me/limits").await.json();
    let disk_gb = |limits: &Value| limits["used"]["disk_gb"].clone();
    assert!(disk_gb(&used).as_f64() > Some(0.0), "{used}");
    assert_eq!(
        disk_gb(&after),
        disk_gb(&used),
        "what lies in the trash is used"
    );
    let stored = group.get(&group.ada, "/v1/storage").await.json();
    let kinds = stored["items"].as_array().expect("items");
    let trash = kinds
        .iter()
        .find(|of| of["kind"] == "trash")
        .expect("a line");
    assert_eq!((&trash["files"], kinds.len()), (&json!(4), 5), "{stored}");

    let entry = trashed(&group, anna).await.remove(0);
    assert_eq!(entry["id"], json!(job));
    assert_eq!(
        (&entry["what"], &entry["deleted_by"]),
        (&json!("job"), &json!("Bert"))
    );
    assert_eq!((&entry["files"], &entry["jobs"]), (&json!(4), &json!(1)));
    assert!(trashed(&group, bert).await.is_empty());
    assert_eq!(trashed(&group, &group.ada).await.len(), 1);

    let restore = format!("/v1/trash/{job}/restore");
    let denied = group.send(bert, "POST", &restore, "").await;
    denied.problem(404, "not-found");
    assert_eq!(group.send(anna, "POST", &restore, "").await.status, 204);
    let mut back = faces(&group, anna, job).await;
    // the moment of its last change is the one at which it came back
    back[0].2["updated_at"] = before[0].2["updated_at"].clone();
    assert_eq!(back, before);
    assert!(
        faces(&group, &link, job)
            .await
            .iter()
            .all(|(_, status, _)| *status == 200)
    );
    let page = group.get(anna, "/v1/jobs").await.json();
    assert_eq!(ids(&page), [newer, job, older], "at its old place");
    let after = group.get(anna, "/v1/me/limits").await.json();
    assert_eq!(disk_gb(&after), disk_gb(&used));
    assert!(trashed(&group, anna).await.is_empty());
    group
        .send(anna, "POST", &restore, "")
        .await
        .problem(404, "not-found");
}

#[tokio::test]
async fn what_is_in_the_trash_goes_when_its_time_is_over_or_for_good_at_once() {
    let lab =
        Lab::with(|config| config.store.trash = std::time::Duration::from_secs(3 * 86_400)).await;
    let group = Group::of(lab).await;
    let (anna, store) = (&group.anna, &group.lab.store);
    let project = group.project(anna, Visibility::Private, None).await.id;
    let mut jobs = Vec::new();
    for _ in 0..3 {
        jobs.push(finished(&group, anna, project).await);
    }
    let stored = async || store.counts().await.expect("counts").file_bytes;
    let full = stored().await;
    for job in &jobs[..2] {
        let path = format!("/v1/jobs/{job}");
        assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    }
    store.settled_files().await;
    assert_eq!(stored().await, full);
    // for good at once, from the list and from the trash
    let at_once = format!("/v1/jobs/{}?for_good=true", jobs[2]);
    assert_eq!(group.send(anna, "DELETE", &at_once, "").await.status, 204);
    let path = format!("/v1/trash/{}", jobs[1]);
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    assert_eq!(trashed(&group, anna).await.len(), 1);
    let gone_at = trashed(&group, anna).await[0]["gone_at"].clone();
    assert!(
        gone_at.as_str().expect("a moment") > in_days(2).to_string().as_str(),
        "{gone_at}"
    );

    assert_eq!(store.empty_trash(in_days(2)).await.expect("nothing yet"), 0);
    let listed = store
        .trash(TrashSight::Everything, None, 10, in_days(4))
        .await;
    assert!(listed.expect("a page").items.is_empty(), "its time is over");
    assert_eq!(store.empty_trash(in_days(4)).await.expect("emptied"), 1);
    store.settled_files().await;
    assert_eq!(stored().await, 0);
    assert_eq!(
        group.get(anna, "/v1/me/limits").await.json()["used"]["disk_gb"],
        json!(0.0)
    );
    let restore = format!("/v1/trash/{}/restore", jobs[0]);
    group
        .send(anna, "POST", &restore, "")
        .await
        .problem(404, "not-found");
}

#[tokio::test]
async fn a_project_goes_and_comes_back_with_its_jobs() {
    let group = Group::open().await;
    let (anna, carl) = (&group.anna, &group.carl);
    let project = group.project(anna, Visibility::Everyone, None).await.id;
    let alone = finished(&group, anna, project).await;
    let kept = finished(&group, anna, project).await;
    let waiting = group.submit(anna, project).await;
    let of_project = NewShare {
        job: None,
        project: Some(project),
        ..to_job(kept, true)
    };
    let link = group.link(anna, of_project).await.0;
    // one that was deleted by itself stays deleted when the project comes back
    let path = format!("/v1/jobs/{alone}");
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);

    let path = format!("/v1/projects/{project}");
    group
        .send(carl, "DELETE", &path, "")
        .await
        .problem(403, "not-allowed");
    let lease = group.lab.claim().await;
    assert_eq!(lease.job_id, waiting);
    group
        .send(anna, "DELETE", &path, "")
        .await
        .problem(409, "conflict");
    group
        .send(anna, "POST", &format!("/v1/jobs/{waiting}/pause"), "")
        .await;
    let key = crate::support::key(&lease);
    let released = group.lab.store.release(key, ReleaseReason::Paused).await;
    released.expect("given back");
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    for by in [anna, carl, &group.ada] {
        for job in [waiting, kept] {
            group
                .get(by, &format!("/v1/jobs/{job}"))
                .await
                .problem(404, "not-found");
        }
        assert!(
            !group
                .get(by, "/v1/projects")
                .await
                .text()
                .contains(&project.to_string())
        );
        group
            .send(by, "PATCH", &path, "{}")
            .await
            .problem(404, "not-found");
    }
    assert_eq!(group.get(&link, "/v1/me").await.status, 401);
    let submitted = group
        .send(
            anna,
            "POST",
            &format!("/v1/jobs?project={project}"),
            crate::support::example(),
        )
        .await;
    submitted.problem(404, "not-found");

    let entries = trashed(&group, anna).await;
    let words: Vec<_> = entries
        .iter()
        .map(|of| (of["what"].clone(), of["jobs"].clone()))
        .collect();
    assert_eq!(
        words,
        [(json!("project"), json!(2)), (json!("job"), json!(1))]
    );
    let restore = |id: Uuid| format!("/v1/trash/{id}/restore");
    let early = group
        .send(anna, "POST", &restore(alone), "")
        .await
        .problem(409, "conflict");
    assert!(
        early["detail"]
            .as_str()
            .expect("a sentence")
            .contains("project"),
        "{early}"
    );
    group
        .send(carl, "POST", &restore(project), "")
        .await
        .problem(404, "not-found");
    assert_eq!(
        group.send(anna, "POST", &restore(project), "").await.status,
        204
    );
    let page = group
        .get(carl, &format!("/v1/jobs?project={project}"))
        .await
        .json();
    assert_eq!(ids(&page), [waiting, kept]);
    assert_eq!(group.get(&link, "/v1/me").await.status, 200);
    assert_eq!(
        group.send(anna, "POST", &restore(alone), "").await.status,
        204
    );
    assert_eq!(
        group
            .get(carl, &format!("/v1/jobs/{alone}/files/curve.csv"))
            .await
            .status,
        200
    );
}

#[tokio::test]
async fn a_job_that_waited_waits_again_and_is_computed() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}");
    assert_eq!(
        lab.send(request("DELETE", &path, &[], "")).await.status,
        204
    );
    assert_eq!(lab.store.counts().await.expect("counts").queued, 0);
    let restored = lab.post(&format!("/v1/trash/{id}/restore"), "").await;
    assert_eq!(restored.status, 204, "{restored:?}");
    assert_eq!(lab.get(&path).await.json()["position"], json!(1));
    lab.finish(id, &FILES).await;
    // attempts of others since then have taken no number of its own
    assert_eq!(
        lab.send(request("DELETE", &path, &[], "")).await.status,
        204
    );
    let other = lab.finished(&FILES).await;
    let restored = lab.post(&format!("/v1/trash/{id}/restore"), "").await;
    assert_eq!(restored.status, 204, "{restored:?}");
    for job in [id, other] {
        let curve = lab.get(&format!("/v1/jobs/{job}/files/curve.csv")).await;
        assert_eq!(curve.text(), "strain,force_n\n0,1\n");
    }
}

#[tokio::test]
async fn files_that_a_rule_removed_are_in_the_trash_and_what_is_there_is_handed_over() {
    let group = Group::open().await;
    let (anna, bert, store) = (&group.anna, &group.bert, &group.lab.store);
    let project = group.project(anna, Visibility::Private, None).await.id;
    let job = finished(&group, anna, project).await;
    let gone = finished(&group, anna, project).await;
    let body = json!({ "snapshots_days": 1 }).to_string();
    let path = format!("/v1/projects/{project}/retention");
    assert_eq!(group.send(anna, "PUT", &path, &body).await.status, 200);
    assert_eq!(store.retain(in_days(8)).await.expect("removed"), (2, 0));
    let file = format!("/v1/jobs/{job}/files/snapshots/0001.vtp");
    group.get(anna, &file).await.problem(404, "not-found");
    let path = format!("/v1/jobs/{gone}");
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    let page = store
        .trash(TrashSight::Of(anna.id), None, 10, in_days(9))
        .await;
    let page = page.expect("a page").items;
    let of_rule = page
        .iter()
        .find(|of| of.id == project)
        .expect("files of the project");
    assert_eq!((of_rule.files, of_rule.jobs, of_rule.bytes), (1, 1, 6));
    let erased = group
        .send(anna, "DELETE", &format!("/v1/trash/{project}"), "")
        .await;
    erased.problem(409, "conflict");
    let restore = format!("/v1/trash/{project}/restore");
    assert_eq!(group.send(anna, "POST", &restore, "").await.status, 204);
    assert_eq!(group.get(anna, &file).await.text(), "points");

    // who leaves hands over what lies in the trash, too
    store
        .hand_over(anna.id, bert.id)
        .await
        .expect("handed over");
    assert!(trashed(&group, anna).await.is_empty());
    let restore = format!("/v1/trash/{gone}/restore");
    group
        .send(anna, "POST", &restore, "")
        .await
        .problem(404, "not-found");
    assert_eq!(group.send(bert, "POST", &restore, "").await.status, 204);
    let owner = group.get(bert, &format!("/v1/jobs/{gone}")).await.json()["owner"].clone();
    assert_eq!(owner["name"], json!("Bert"));
    let people = store.people().await.expect("people");
    assert!(people.iter().any(|of| of.role == Role::Administrator));
}

#[tokio::test]
async fn the_trash_comes_in_pages() {
    let lab = Lab::open().await;
    let mut jobs = Vec::new();
    for _ in 0..5 {
        let id = lab.submit().await;
        lab.store.discard(id).await.expect("deleted");
        jobs.insert(0, id);
    }
    let mut seen = Vec::new();
    let mut cursor = String::new();
    loop {
        let page = lab.get(&format!("/v1/trash?limit=2{cursor}")).await.json();
        seen.extend(ids(&page));
        match page["next"].as_str() {
            Some(next) => cursor = format!("&cursor={next}"),
            None => break,
        }
    }
    seen.sort_unstable();
    jobs.sort_unstable();
    assert_eq!(seen, jobs);
    lab.get("/v1/trash?cursor=nonsense")
        .await
        .problem(422, "invalid-request");
}

#[tokio::test]
async fn of_restoring_and_removing_for_good_at_once_one_is_done() {
    let group = Group::open().await;
    let anna = &group.anna;
    for _ in 0..10 {
        let project = group.project(anna, Visibility::Everyone, None).await.id;
        let job = group.submit(anna, project).await;
        let path = format!("/v1/projects/{project}");
        assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
        let (restore, erase) = (
            format!("/v1/trash/{project}/restore"),
            format!("/v1/trash/{project}"),
        );
        let (restored, erased) = tokio::join!(
            group.send(anna, "POST", &restore, ""),
            group.send(anna, "DELETE", &erase, ""),
        );
        let mut statuses = [restored.status, erased.status];
        let is_back = restored.status == 204;
        statuses.sort_unstable();
        assert_eq!(statuses, [204, 404], "{restored:?} {erased:?}");
        let expected = if is_back { 200 } else { 404 };
        let answer = group.get(anna, &format!("/v1/jobs/{job}")).await;
        assert_eq!(answer.status, expected, "{is_back}");
        let known = group.get(anna, "/v1/projects").await.json().to_string();
        assert_eq!(known.contains(&project.to_string()), is_back);
    }
}

#[tokio::test]
async fn a_project_that_is_being_removed_for_good_is_not_brought_back_in_part() {
    let group = Group::open().await;
    let anna = &group.anna;
    // more than go in two changes, between which it is asked back
    for pause in [0, 1, 3, 6, 10, 15, 20] {
        let project = group.project(anna, Visibility::Private, None).await.id;
        for _ in 0..120 {
            group.submit(anna, project).await;
        }
        let path = format!("/v1/projects/{project}");
        assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
        let restore = async {
            tokio::time::sleep(Duration::from_millis(pause)).await;
            group.lab.store.bring_back(project).await
        };
        let (erased, restored) = tokio::join!(group.lab.store.erase(project), restore);
        let path = format!("/v1/jobs?project={project}&limit=200");
        let jobs = ids(&group.get(anna, &path).await.json()).len();
        match (erased, restored) {
            (Ok(()), Err(StoreError::NotFound(_))) => assert_eq!(jobs, 0, "after {pause} ms"),
            (Err(StoreError::NotFound(_)), Ok(())) => assert_eq!(jobs, 120, "after {pause} ms"),
            both => panic!("after {pause} ms: {both:?}"),
        }
        assert_eq!(trashed(&group, anna).await.len(), 0, "after {pause} ms");
    }
}

#[tokio::test]
async fn a_project_that_is_deleted_meanwhile_takes_no_jobs() {
    let group = Group::open().await;
    let anna = &group.anna;
    let home = group.project(anna, Visibility::Private, None).await.id;
    for _ in 0..10 {
        let project = group.project(anna, Visibility::Everyone, None).await.id;
        let job = group.submit(anna, home).await;
        let body = json!({ "project": project }).to_string();
        let (of_job, of_project) = (format!("/v1/jobs/{job}"), format!("/v1/projects/{project}"));
        let (moved, deleted) = tokio::join!(
            group.send(anna, "PATCH", &of_job, &body),
            group.send(anna, "DELETE", &of_project, ""),
        );
        assert_eq!(deleted.status, 204, "{deleted:?}");
        let answer = group.get(anna, &of_job).await;
        // what was moved before went along, perhaps before the answer was read
        if answer.status == 200 {
            assert_eq!(moved.status, 404, "{moved:?}");
            assert_eq!(answer.json()["project"]["id"], json!(home));
        } else {
            assert_eq!(answer.status, 404, "{answer:?}");
        }
    }
}

#[tokio::test]
async fn a_job_whose_project_is_gone_comes_back_to_its_owners_own() {
    let group = Group::open().await;
    let anna = &group.anna;
    let own = id_of(
        &group
            .send(anna, "POST", "/v1/jobs", crate::support::example())
            .await
            .json(),
    );
    let own = group.get(anna, &format!("/v1/jobs/{own}")).await.json()["project"].clone();
    let project = group.project(anna, Visibility::Everyone, None).await.id;
    let job = group.submit(anna, project).await;
    for path in [format!("/v1/jobs/{job}"), format!("/v1/projects/{project}")] {
        assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    }
    let restore = format!("/v1/trash/{job}/restore");
    // the project can be brought back, so it should
    assert_eq!(group.send(anna, "POST", &restore, "").await.status, 409);
    let erase = format!("/v1/trash/{project}");
    assert_eq!(group.send(anna, "DELETE", &erase, "").await.status, 204);
    assert_eq!(group.send(anna, "POST", &restore, "").await.status, 204);
    let back = group.get(anna, &format!("/v1/jobs/{job}")).await.json();
    assert_eq!(back["project"], own);
}

#[tokio::test]
async fn a_project_of_which_a_job_is_taken_meanwhile_keeps_all_its_jobs() {
    let group = Group::open().await;
    let anna = &group.anna;
    let project = group.project(anna, Visibility::Private, None).await.id;
    // more than go in two changes, of which a worker takes one in between
    let mut jobs = Vec::new();
    for _ in 0..120 {
        jobs.push(group.submit(anna, project).await);
    }
    let mut lease = None;
    for pause in 1..20 {
        let claim = async {
            // not before the first of them are on their way
            for _ in 0..pause {
                tokio::task::yield_now().await;
            }
            group.lab.claim().await
        };
        let (discarded, taken) = tokio::join!(group.lab.store.discard_project(project), claim);
        assert!(
            matches!(&discarded, Err(StoreError::Conflict(why)) if why.contains("running")),
            "{discarded:?}"
        );
        if jobs.iter().position(|job| *job == taken.job_id) >= Some(50) {
            lease = Some(taken);
            break;
        }
        let key = crate::support::key(&taken);
        let released = group.lab.store.release(key, ReleaseReason::Shutdown).await;
        released.expect("given back");
    }
    let lease = lease.expect("a claim after the first jobs went");
    assert_eq!(trashed(&group, anna).await.len(), 0);
    let path = format!("/v1/jobs?project={project}&limit=200");
    let mut kept = ids(&group.get(anna, &path).await.json());
    kept.sort_unstable();
    assert_eq!(kept, jobs);
    // and goes whole when none is running
    let key = crate::support::key(&lease);
    let released = group.lab.store.release(key, ReleaseReason::Shutdown).await;
    released.expect("given back");
    let path = format!("/v1/projects/{project}");
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    assert_eq!(trashed(&group, anna).await[0]["jobs"], json!(120));
}
