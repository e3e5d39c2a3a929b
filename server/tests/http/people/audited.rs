//! Every request that changes something, by the page of a person who is signed in: refused where another page
//! sends it, and one line in the audit log where this one does. A route without a row fails.
//!
//! One file, long as it is: what one does is what the next is done to.
use std::collections::BTreeSet;

use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, PASSWORD, Somebody, id_of};
use crate::support::{Answer, JSON, example, request};

/// What writes nothing that is anybody's.
const CHANGES_NOTHING: [&str; 3] = ["preview_job", "read_measured_curve", "begin_sign_in"];
/// What a server without e-mail does not do: `mails` has a server of that.
const OF_MAIL: [&str; 3] = ["create_mail", "verify_mail", "remove_mail"];
/// The way of a worker's requests: a lease is its own proof, and the attempt's record says who had it.
const OF_WORKERS: &str = "/v1/worker/";

/// A group in which much is done, and what of it was.
struct Deeds {
    group: Group,
    done: BTreeSet<&'static str>,
}

impl Deeds {
    /// Lines of the audit log that a request has left.
    async fn lines(&self, answer: &Answer) -> Vec<Value> {
        let log = self.group.get(&self.group.ada, "/v1/audit?limit=20").await;
        let lines = log.json()["items"].as_array().expect("lines").clone();
        let sent = answer.header("x-request-id").to_owned();
        assert!(!sent.is_empty(), "{answer:?}");
        lines
            .into_iter()
            .filter(|line| line["request"] == sent)
            .collect()
    }

    /// The number of the newest line.
    async fn newest_line(&self) -> Value {
        let log = self.group.get(&self.group.ada, "/v1/audit?limit=1").await;
        log.json()["items"][0]["number"].clone()
    }

    async fn leaves_one_line(&self, id: &str, answer: &Answer, action: &str) -> Value {
        assert!((200..300).contains(&answer.status), "{id}: {answer:?}");
        let lines = self.lines(answer).await;
        assert_eq!(lines.len(), 1, "{id}: {lines:?}");
        assert_eq!(lines[0]["action"], action, "{id}");
        lines[0].clone()
    }

    /// Does it once from another page, and once from the server's own; the answer's body.
    async fn does(
        &mut self,
        by: &Somebody,
        id: &'static str,
        (method, path): (&str, &str),
        body: &Value,
        action: &str,
    ) -> Value {
        let text = match body {
            Value::Null => String::new(),
            body => body.to_string(),
        };
        let (cookie, session) = &by.known_by;
        assert_eq!(*cookie, "cookie");
        let before = self.newest_line().await;
        for page in [
            None,
            Some(("origin", "http://evil.example")),
            Some(("sec-fetch-site", "cross-site")),
            Some(("sec-fetch-site", "same-site")),
        ] {
            let mut headers = vec![(*cookie, session.as_str()), JSON];
            headers.extend(page);
            let foreign = self
                .group
                .lab
                .send(request(method, path, &headers, &text))
                .await;
            foreign.problem(403, "foreign-origin");
            assert_eq!(self.newest_line().await, before, "{id} {page:?}");
        }
        let answer = self.group.send(by, method, path, &text).await;
        let line = self.leaves_one_line(id, &answer, action).await;
        assert_eq!(line["who"], by.name, "{id}");
        assert!(line["credential"].is_string(), "{id}: {line}");
        self.done.insert(id);
        serde_json::from_slice(&answer.body).unwrap_or_default()
    }

    /// The same of who is nobody yet.
    async fn does_unknown(&mut self, id: &'static str, path: &str, body: &Value, action: &str) {
        let headers = [
            ("origin", "http://localhost:8400"),
            ("host", "localhost:8400"),
            JSON,
        ];
        let sent = request("POST", path, &headers, &body.to_string());
        let answer = self.group.lab.send(sent).await;
        self.leaves_one_line(id, &answer, action).await;
        self.done.insert(id);
    }
}

#[tokio::test]
async fn every_change_is_this_pages_own_and_has_one_line_in_the_log() {
    let group = Group::open().await;
    let (ada, anna) = (group.ada.clone(), group.anna.clone());
    let (bert, carl) = (group.bert.clone(), group.carl.clone());
    let mut deeds = Deeds {
        group,
        done: BTreeSet::new(),
    };
    let nothing = Value::Null;

    let new = json!({ "name": "a project", "visibility": "private" });
    let project = deeds.does(
        &anna,
        "create_project",
        ("POST", "/v1/projects"),
        &new,
        "project.made",
    );
    let project = id_of(&project.await);
    let at_project = format!("/v1/projects/{project}");
    let submission: Value = serde_json::from_str(example()).expect("JSON");
    let path = format!("/v1/jobs?project={project}");
    let job = deeds.does(
        &anna,
        "submit_job",
        ("POST", &path),
        &submission,
        "job.submitted",
    );
    let job = id_of(&job.await);
    let at_job = format!("/v1/jobs/{job}");
    let change = json!({ "name": "another name" });
    deeds
        .does(
            &anna,
            "change_job",
            ("PATCH", &at_job),
            &change,
            "job.changed",
        )
        .await;
    for (id, verb, action) in [
        ("pause_job", "pause", "job.paused"),
        ("resume_job", "resume", "job.resumed"),
        ("cancel_job", "cancel", "job.cancelled"),
        ("retry_job", "retry", "job.retried"),
    ] {
        let path = format!("{at_job}/{verb}");
        deeds
            .does(&anna, id, ("POST", &path), &nothing, action)
            .await;
    }

    // what is made, and ended again
    let share = json!({ "job": job, "files": false, "days": 1 });
    let comparison = json!({ "name": "a comparison", "jobs": [job], "project": project });
    let webhook = json!({ "url": "http://8.8.8.8/hook", "events": ["ended"] });
    let token = json!({ "name": "a script", "scope": "read" });
    let made = deeds.does(
        &anna,
        "create_comparison",
        ("POST", "/v1/comparisons"),
        &comparison,
        "comparison.made",
    );
    let path = format!("/v1/comparisons/{}", id_of(&made.await));
    deeds
        .does(
            &anna,
            "change_comparison",
            ("PATCH", &path),
            &change,
            "comparison.changed",
        )
        .await;
    deeds
        .does(
            &anna,
            "delete_comparison",
            ("DELETE", &path),
            &nothing,
            "comparison.deleted",
        )
        .await;
    for (make, end, place, new, made, ended) in [
        (
            "create_share",
            "revoke_share",
            "shares",
            share,
            "share.made",
            "share.revoked",
        ),
        (
            "create_webhook",
            "remove_webhook",
            "webhooks",
            webhook,
            "webhook.made",
            "webhook.removed",
        ),
        (
            "create_token",
            "revoke_token",
            "tokens",
            token,
            "token.made",
            "token.revoked",
        ),
    ] {
        let path = format!("/v1/{place}");
        let of = deeds.does(&anna, make, ("POST", &path), &new, made).await;
        let path = format!("{path}/{}", id_of(&of));
        deeds
            .does(&anna, end, ("DELETE", &path), &nothing, ended)
            .await;
    }

    // what is deleted, and comes back
    let in_trash = format!("/v1/trash/{job}");
    deeds
        .does(
            &anna,
            "delete_job",
            ("DELETE", &at_job),
            &nothing,
            "job.deleted",
        )
        .await;
    let path = format!("{in_trash}/restore");
    deeds
        .does(
            &anna,
            "restore_deleted",
            ("POST", &path),
            &nothing,
            "job.restored",
        )
        .await;
    deeds
        .does(
            &anna,
            "delete_job",
            ("DELETE", &at_job),
            &nothing,
            "job.deleted",
        )
        .await;
    deeds
        .does(
            &anna,
            "erase_deleted",
            ("DELETE", &in_trash),
            &nothing,
            "job.erased",
        )
        .await;

    deeds
        .does(
            &anna,
            "change_project",
            ("PATCH", &at_project),
            &change,
            "project.changed",
        )
        .await;
    let path = format!("{at_project}/retention");
    let rule = json!({ "snapshots_days": 10 });
    deeds
        .does(
            &anna,
            "set_retention",
            ("PUT", &path),
            &rule,
            "retention.set",
        )
        .await;
    let path = format!("{path}/undo");
    deeds
        .does(
            &anna,
            "undo_retention",
            ("POST", &path),
            &nothing,
            "retention.undone",
        )
        .await;
    deeds
        .does(
            &anna,
            "delete_project",
            ("DELETE", &at_project),
            &nothing,
            "project.deleted",
        )
        .await;

    // people
    let password = json!({ "current": PASSWORD, "new": "another password" });
    deeds
        .does(
            &anna,
            "change_password",
            ("PUT", "/v1/me/password"),
            &password,
            "password.changed",
        )
        .await;
    let team = json!({ "name": "Board" });
    let team = deeds
        .does(
            &ada,
            "create_group",
            ("POST", "/v1/groups"),
            &team,
            "group.made",
        )
        .await;
    let member = format!("/v1/groups/{}/members/{}", id_of(&team), carl.id);
    deeds
        .does(
            &ada,
            "add_member",
            ("PUT", &member),
            &nothing,
            "group.joined",
        )
        .await;
    deeds
        .does(
            &ada,
            "remove_member",
            ("DELETE", &member),
            &nothing,
            "group.left",
        )
        .await;
    let limits = json!({ "running": 2 });
    let path = format!("/v1/people/{}/limits", carl.id);
    deeds
        .does(
            &ada,
            "set_limits",
            ("PUT", &path),
            &limits,
            "person.limited",
        )
        .await;
    let path = format!("/v1/people/{}", bert.id);
    let left = json!({ "left": true });
    deeds
        .does(
            &ada,
            "change_person",
            ("PATCH", &path),
            &left,
            "person.changed",
        )
        .await;
    let path = format!("{path}/hand-over");
    let to = json!({ "to": anna.id });
    deeds
        .does(
            &ada,
            "hand_over",
            ("POST", &path),
            &to,
            "person.handed_over",
        )
        .await;
    let role = json!({ "role": "guest" });
    let invited = deeds
        .does(
            &ada,
            "invite",
            ("POST", "/v1/invitations"),
            &role,
            "invitation.made",
        )
        .await;
    let path = format!("/v1/invitations/{}", id_of(&invited));
    deeds
        .does(
            &ada,
            "revoke_invitation",
            ("DELETE", &path),
            &nothing,
            "invitation.revoked",
        )
        .await;
    let invited = deeds
        .does(
            &ada,
            "invite",
            ("POST", "/v1/invitations"),
            &role,
            "invitation.made",
        )
        .await;
    let secret = invited["path"]
        .as_str()
        .and_then(|path| path.rsplit('#').next())
        .expect("a secret");
    let accepted = json!({ "secret": secret, "name": "Dora", "password": PASSWORD });
    deeds
        .does_unknown(
            "accept_invitation",
            "/v1/invitations/accept",
            &accepted,
            "invitation.accepted",
        )
        .await;
    let sign_in = json!({ "name": "Dora", "password": PASSWORD });
    deeds
        .does_unknown("sign_in", "/v1/sessions", &sign_in, "session.opened")
        .await;
    let current = ("DELETE", "/v1/sessions/current");
    deeds
        .does(&carl, "end_session", current, &nothing, "session.closed")
        .await;

    // nothing is missing, and what reads writes nothing
    let document = deeds.group.lab.get("/openapi.json").await.json();
    let mut missing = Vec::new();
    let mut reads = Vec::new();
    for (path, item) in document["paths"].as_object().expect("paths") {
        for (method, operation) in item.as_object().expect("an item") {
            let id = operation["operationId"].as_str().expect("an id");
            if method == "get" {
                reads.push(path.replace("{id}", &Uuid::from_u128(404).to_string()));
                continue;
            }
            let is_exempt = CHANGES_NOTHING.contains(&id)
                || OF_MAIL.contains(&id)
                || path.starts_with(OF_WORKERS);
            if !is_exempt && !deeds.done.contains(id) {
                missing.push(id.to_owned());
            }
        }
    }
    assert!(missing.is_empty(), "do here {missing:?}");
    let before = deeds.newest_line().await;
    for path in reads.iter().filter(|path| !path.contains("/events")) {
        deeds.group.get(&ada, path).await;
    }
    assert_eq!(deeds.newest_line().await, before);
}
