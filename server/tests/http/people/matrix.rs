//! Every documented route, asked by everybody, about every kind of object: as written here. A route
//! without a row fails.
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicU32, Ordering};

use axum::extract::ConnectInfo;
use loadframe_api::people::{Scope, Visibility};
use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, Somebody, to_job};
use crate::support::{Answer, JSON, Lab, example, request};

/// What a route does, and so who may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    /// Holds nothing of the users'.
    Public,
    /// For who is nobody yet.
    BeforeSignIn,
    Introduce,
    /// Reads what belongs to nobody, or a list that holds what one sees.
    ReadLab,
    ReadJob,
    ReadFiles,
    ChangeJob,
    /// Makes something of one's own.
    Make,
    ChangeProject,
    DeleteProject,
    /// Brings back what was deleted, or removes it for good.
    Restore,
    ReadComparison,
    ChangeComparison,
    ReadWorkers,
    ReadMetrics,
    ManageOwn,
    ReadPeople,
    Administer,
    Work,
}

/// The class of every operation, by its id.
#[rustfmt::skip]
const ROUTES: &[(Class, &[&str])] = &[
    (Class::Public, &["check_alive", "check_ready", "read_version", "read_openapi"]),
    (Class::BeforeSignIn, &["sign_in", "accept_invitation", "read_sign_in",
        "begin_sign_in", "end_sign_in"]),
    (Class::Introduce, &["read_me"]),
    (Class::ReadLab, &["list_jobs", "follow_jobs", "list_kinds", "read_kind", "read_kind_schema",
        "list_examples", "list_projects", "read_my_limits", "read_differences", "read_curves",
        "read_curves_csv", "read_measured_curve", "list_comparisons", "list_trash", "list_fields"]),
    (Class::ReadJob, &["read_job", "read_curve", "read_curve_json", "read_curve_csv", "read_outcome",
        "follow_job", "read_waiting"]),
    (Class::ReadFiles, &["list_files", "download_file", "download_archive", "read_log"]),
    (Class::ChangeJob, &["change_job", "delete_job", "cancel_job", "pause_job", "resume_job",
        "retry_job"]),
    (Class::Make, &["submit_job", "preview_job", "create_project", "create_share",
        "create_comparison"]),
    (Class::ChangeProject, &["change_project", "read_retention", "set_retention",
        "undo_retention"]),
    (Class::DeleteProject, &["delete_project"]),
    (Class::Restore, &["restore_deleted", "erase_deleted"]),
    (Class::ReadComparison, &["read_comparison"]),
    (Class::ChangeComparison, &["change_comparison", "delete_comparison"]),
    (Class::ReadWorkers, &["list_workers", "list_allocations"]),
    (Class::ReadMetrics, &["read_metrics"]),
    (Class::ManageOwn, &["list_sessions", "end_session", "change_password", "list_tokens",
        "create_token", "revoke_token", "list_shares", "revoke_share", "read_storage",
        "list_webhooks", "create_webhook", "remove_webhook",
        "list_mails", "create_mail", "verify_mail", "remove_mail"]),
    (Class::ReadPeople, &["list_people", "list_groups"]),
    (Class::Administer, &["change_person", "set_limits", "hand_over", "invite", "list_invitations",
        "revoke_invitation", "create_group", "add_member", "remove_member",
        "read_audit", "export_audit"]),
    (Class::Work, &["claim", "heartbeat", "progress", "complete", "fail", "fault", "release", "upload",
        "uploaded_part", "begin_direct", "end_direct",
        "checkpoint", "save_checkpoint", "read_backlog", "report_allocations"]),
];

/// Who asks, in the order of the rows below.
const CALLERS: [&str; 12] = [
    "nobody",
    "guest",
    "anna",
    "bert",
    "carl",
    "administrator",
    "read token",
    "submit token",
    "worker token",
    "link",
    "link with files",
    "revoked token",
];

/// What each caller gets of Anna's private job, one in the group's project, one in her project for
/// everyone, and one that is missing. `+` it is done, `-` refused (403), `0` answered as missing (404),
/// `!` asked who it is (401). The tokens are Anna's, the links lead to her private job.
fn expected(class: Class) -> Option<[&'static str; 12]> {
    Some(match class {
        Class::ReadJob => [
            "!!!!", "0++0", "+++0", "0++0", "00+0", "+++0", "+++0", "+++0", "----", "+000", "+000",
            "!!!!",
        ],
        Class::ReadFiles => [
            "!!!!", "0++0", "+++0", "0++0", "00+0", "+++0", "+++0", "+++0", "----", "----", "+000",
            "!!!!",
        ],
        Class::ChangeJob => [
            "!!!!", "----", "+++0", "0+-0", "00-0", "+++0", "----", "+++0", "----", "----", "----",
            "!!!!",
        ],
        // comparisons in the projects of these jobs; the links lead to a job
        Class::ReadComparison => [
            "!!!!", "0++0", "+++0", "0++0", "00+0", "+++0", "+++0", "+++0", "----", "0000", "0000",
            "!!!!",
        ],
        // the projects of these jobs, and the comparisons in them
        Class::ChangeProject | Class::ChangeComparison => [
            "!!!!", "----", "+++0", "0+-0", "00-0", "+++0", "----", "+++0", "----", "----", "----",
            "!!!!",
        ],
        Class::DeleteProject => [
            "!!!!", "----", "+-+0", "0--0", "00-0", "+++0", "----", "+-+0", "----", "----", "----",
            "!!!!",
        ],
        // these jobs, deleted: their owner's and the administrators', whoever saw them before; a link to what is
        // deleted is none
        Class::Restore => [
            "!!!!", "----", "+++0", "0000", "0000", "+++0", "----", "+++0", "----", "!!!!", "!!!!",
            "!!!!",
        ],
        _ => return None,
    })
}

/// The same for routes that are about no such object.
fn expected_of_lab(class: Class) -> Option<&'static str> {
    Some(match class {
        Class::Public => "++++++++++++",
        Class::BeforeSignIn => "++++++++++++",
        Class::Introduce => "!++++++++++!",
        Class::ReadLab => "!+++++++-++!",
        Class::Make => "!-++++-+---!",
        Class::ReadWorkers => "!-++++++---!",
        Class::ReadMetrics => "!----+-----!",
        Class::ManageOwn => "!+++++-----!",
        Class::ReadPeople => "!-++++++---!",
        Class::Administer => "!----+-----!",
        Class::Work => "!-------+--!",
        _ => return None,
    })
}

static ASKED: AtomicU32 = AtomicU32::new(0);

#[derive(Debug)]
struct Operation {
    id: String,
    method: String,
    path: String,
    has_body: bool,
}

async fn operations(lab: &Lab) -> Vec<Operation> {
    let document = lab.get("/openapi.json").await.json();
    let mut operations = Vec::new();
    for (path, item) in document["paths"].as_object().expect("paths") {
        for (method, operation) in item.as_object().expect("an item") {
            operations.push(Operation {
                id: operation["operationId"].as_str().expect("an id").to_owned(),
                method: method.to_uppercase(),
                path: path.clone(),
                has_body: operation.get("requestBody").is_some(),
            });
        }
    }
    operations
}

fn class_of(id: &str) -> Option<Class> {
    let mut rows = ROUTES.iter();
    let row = rows.find(|(_, operations)| operations.contains(&id));
    row.map(|(class, _)| *class)
}

#[tokio::test]
async fn every_route_has_a_row_and_every_row_a_route() {
    let lab = Lab::open().await;
    let operations = operations(&lab).await;
    let without: Vec<&str> = operations
        .iter()
        .map(|operation| operation.id.as_str())
        .filter(|id| class_of(id).is_none())
        .collect();
    assert!(without.is_empty(), "say in ROUTES who may ask {without:?}");
    for id in ROUTES.iter().flat_map(|(_, operations)| *operations) {
        assert!(operations.iter().any(|of| of.id == *id), "{id} is no route");
    }
}

/// Ids of a job, of its project, and of a comparison in that project.
type Object = [Uuid; 3];

struct World {
    group: Group,
    callers: Vec<Option<Somebody>>,
}

impl World {
    async fn open() -> Self {
        let group = Group::open().await;
        // the links lead to a job of their own: what they show must not end with the tests of others
        let read = group.token(&group.anna, Scope::Read).await.0;
        let submit = group.token(&group.anna, Scope::Submit).await.0;
        let worker = group.token(&group.anna, Scope::Worker).await.0;
        let (revoked, id) = group.token(&group.anna, Scope::Submit).await;
        group
            .lab
            .store
            .revoke_token(id, None)
            .await
            .expect("revoked");
        let callers = vec![
            None,
            Some(group.gina.clone()),
            Some(group.anna.clone()),
            Some(group.bert.clone()),
            Some(group.carl.clone()),
            Some(group.ada.clone()),
            Some(read),
            Some(submit),
            Some(worker),
            None,
            None,
            Some(revoked),
        ];
        Self { group, callers }
    }

    /// Fresh jobs, and links to the private one.
    async fn objects(&mut self) -> [Object; 4] {
        let group = &self.group;
        let anna = &group.anna;
        let private = group.project(anna, Visibility::Private, None).await.id;
        let groups = group
            .project(anna, Visibility::Group, Some(group.paper))
            .await
            .id;
        let everyones = group.project(anna, Visibility::Everyone, None).await.id;
        let mut objects = [[Uuid::from_u128(404); 3]; 4];
        for (place, project) in [private, groups, everyones].into_iter().enumerate() {
            let job = group.submit(anna, project).await;
            let body = json!({ "name": "a", "jobs": [job], "project": project }).to_string();
            let made = group.send(anna, "POST", "/v1/comparisons", &body).await;
            objects[place] = [job, project, super::group::id_of(&made.json())];
        }
        let link = group.link(anna, to_job(objects[0][0], false)).await.0;
        let with_files = group.link(anna, to_job(objects[0][0], true)).await.0;
        self.callers[9] = Some(link);
        self.callers[10] = Some(with_files);
        objects
    }

    async fn ask(&self, operation: &Operation, caller: usize, id: Uuid) -> Answer {
        // what is changed stays as it was for the next one: bodies are empty objects or nonsense
        let path = operation.path.replace("{kind}", "nonwoven_tensile");
        let path = path
            .replace("{name}", "curve.csv")
            .replace("{id}", &id.to_string());
        let path = path.replace("{person}", &Uuid::from_u128(405).to_string());
        let mut headers = vec![("origin", "http://localhost")];
        let known_by = self.callers[caller].as_ref().map(|of| of.known_by.clone());
        if let Some((name, value)) = &known_by {
            headers.push((name, value));
        }
        let lease = Uuid::from_u128(1).to_string();
        headers.push(("loadframe-lease-token", &lease));
        if operation.has_body {
            headers.push(JSON);
        }
        let body = if operation.has_body { "{}" } else { "" };
        let mut request = request(&operation.method, &path, &headers, body);
        // from another address each time: an address that sends wrong tokens is slowed down
        let number = ASKED.fetch_add(1, Ordering::Relaxed).to_be_bytes();
        let peer = SocketAddr::from(([10, 0, number[2], number[3]], 40_000));
        request.extensions_mut().insert(ConnectInfo(peer));
        if operation.id.starts_with("follow") {
            // a stream has no end
            let response = self.group.lab.begin(request).await;
            return match response.status().as_u16() {
                200 => Answer {
                    status: 200,
                    headers: response.headers().clone(),
                    body: axum::body::Bytes::new(),
                },
                _ => self.group.lab.read(response).await,
            };
        }
        self.group.lab.send(request).await
    }
}

/// How an answer looks from outside.
fn sign(answer: &Answer, missing: &str) -> char {
    let problem: Value = serde_json::from_slice(&answer.body).unwrap_or_default();
    match (answer.status, problem["type"].as_str().unwrap_or("")) {
        (401, _) => '!',
        (403, "/problems/not-allowed") => '-',
        // that a job has no such file is no secret to who may read it
        (404, _) if problem["detail"] == missing => '0',
        _ => '+',
    }
}

#[tokio::test]
async fn everybody_gets_of_every_object_what_is_written() {
    let mut world = World::open().await;
    let mut wrong = Vec::new();
    let mut asked = 0;
    let mut objects = world.objects().await;
    for operation in operations(&world.group.lab).await {
        let class = class_of(&operation.id).expect("a row");
        let Some(rows) = expected(class) else {
            continue;
        };
        let changes = matches!(
            class,
            Class::ChangeJob
                | Class::ChangeProject
                | Class::ChangeComparison
                | Class::DeleteProject
                | Class::Restore
        );
        for (caller, row) in rows.into_iter().enumerate() {
            // what was changed by the one before is no longer what it was
            if changes && caller > 0 && rows[caller - 1].contains('+') {
                objects = world.objects().await;
            }
            if class == Class::Restore {
                for [job, ..] in &objects[..3] {
                    // deleted already where nobody brought it back
                    let _ = world.group.lab.store.discard(*job).await;
                }
            }
            let mut got = String::new();
            let mut missing = BTreeMap::new();
            for [job, project, comparison] in objects {
                let (what, id) = match class {
                    Class::ChangeProject | Class::DeleteProject => ("project", project),
                    Class::Restore => ("deleted job or project", job),
                    Class::ReadComparison | Class::ChangeComparison => ("comparison", comparison),
                    _ => ("job", job),
                };
                let answer = world.ask(&operation, caller, id).await;
                let sign = sign(&answer, &format!("there is no {what} {id}"));
                got.push(sign);
                if sign == '0' {
                    let text = answer.text().replace(&id.to_string(), "ID");
                    missing.insert(text, answer.status);
                }
                asked += 1;
            }
            if got != row {
                wrong.push(format!(
                    "{} by {}: {got}, not {row}",
                    operation.id, CALLERS[caller]
                ));
            }
            // a foreign one is answered exactly as one that does not exist
            assert!(missing.len() <= 1, "{} {missing:?}", operation.id);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(asked > 800, "{asked}");
}

#[tokio::test]
async fn everybody_may_do_in_the_lab_what_is_written() {
    let mut world = World::open().await;
    world.objects().await;
    let mut wrong = Vec::new();
    for operation in operations(&world.group.lab).await {
        let class = class_of(&operation.id).expect("a row");
        let Some(row) = expected_of_lab(class) else {
            continue;
        };
        let mut got = String::new();
        for caller in 0..CALLERS.len() {
            let answer = world.ask(&operation, caller, Uuid::from_u128(404)).await;
            got.push(sign(&answer, ""));
        }
        if got != row {
            wrong.push(format!("{}: {got}, not {row}", operation.id));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[tokio::test]
async fn what_belongs_to_the_server_cannot_be_written_by_a_submission_or_a_change() {
    let group = Group::open().await;
    let anna = &group.anna;
    let id = {
        let answer = group.send(anna, "POST", "/v1/jobs", example()).await;
        super::group::id_of(&answer.json())
    };
    let body: Value = serde_json::from_str(example()).expect("JSON");
    for field in [
        "owner", "attempt", "attempts", "status", "outcome", "role", "lease", "cost", "person",
    ] {
        let mut submission = body.clone();
        submission[field] = json!(group.bert.id);
        let answer = group
            .send(anna, "POST", "/v1/jobs", &submission.to_string())
            .await;
        answer.problem(422, "invalid-job");
        let change = json!({ field: group.bert.id }).to_string();
        let answer = group
            .send(anna, "PATCH", &format!("/v1/jobs/{id}"), &change)
            .await;
        assert_eq!(answer.status, 422, "{field}: {answer:?}");
    }
    let job = group.get(anna, &format!("/v1/jobs/{id}")).await.json();
    assert_eq!(job["owner"], json!(super::group::named(anna)));
}
