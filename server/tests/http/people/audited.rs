//! Every request that changes something, by the page of a person who is signed in: refused where another page
//! sends it, and one line in the audit log where this one does. A route without a row fails.
use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use uuid::Uuid;

use super::group::{Group, PASSWORD, Somebody};
use crate::support::{Answer, JSON, example, request};

/// Who does it, the operation and its request, the action that the log calls it and what it says more about it,
/// and the body, one after the other. `<jobs>` stands for the id of what was made last at `/v1/jobs`, `<anna>` for
/// hers, `<secret>` for the one of the last invitation.
const DEEDS: &str = r#"
anna   | create_project    | POST /v1/projects                          | project.made        | a project | {"name": "a project", "visibility": "private"}
anna   | submit_job        | POST /v1/jobs?project=<projects>           | job.submitted       | <example name> | <example>
anna   | change_job        | PATCH /v1/jobs/<jobs>                      | job.changed         | name      | {"name": "another name"}
anna   | change_job        | PATCH /v1/jobs/<jobs>                      | job.moved           | to project <projects>, tags | {"project": "<projects>", "tags": ["moved"]}
anna   | pause_job         | POST /v1/jobs/<jobs>/pause                 | job.paused          |           |
anna   | resume_job        | POST /v1/jobs/<jobs>/resume                | job.resumed         |           |
anna   | cancel_job        | POST /v1/jobs/<jobs>/cancel                | job.cancelled       |           |
anna   | retry_job         | POST /v1/jobs/<jobs>/retry                 | job.retried         |           |
anna   | create_comparison | POST /v1/comparisons                       | comparison.made     | a comparison | {"name": "a comparison", "jobs": ["<jobs>"], "project": "<projects>"}
anna   | change_comparison | PATCH /v1/comparisons/<comparisons>        | comparison.changed  | another name | {"name": "another name"}
anna   | delete_comparison | DELETE /v1/comparisons/<comparisons>       | comparison.deleted  | another name |
anna   | create_share      | POST /v1/shares                            | share.made          | link <shares> to a job, without files | {"job": "<jobs>", "files": false, "days": 1}
anna   | revoke_share      | DELETE /v1/shares/<shares>                 | share.revoked       | link <shares> |
anna   | create_webhook    | POST /v1/webhooks                          | webhook.made        | 8.8.8.8   | {"url": "http://8.8.8.8/hook", "events": ["ended"]}
anna   | remove_webhook    | DELETE /v1/webhooks/<webhooks>             | webhook.removed     |           |
anna   | create_token      | POST /v1/tokens                            | token.made          | a script: read | {"name": "a script", "scope": "read"}
anna   | revoke_token      | DELETE /v1/tokens/<tokens>                 | token.revoked       | a script  |
anna   | delete_job        | DELETE /v1/jobs/<jobs>                     | job.deleted         | another name |
anna   | restore_deleted   | POST /v1/trash/<jobs>/restore              | job.restored        | another name |
anna   | delete_job        | DELETE /v1/jobs/<jobs>                     | job.deleted         | another name |
anna   | erase_deleted     | DELETE /v1/trash/<jobs>                    | job.erased          | another name |
anna   | change_project    | PATCH /v1/projects/<projects>              | project.changed     | another name of Anna: private | {"name": "another name"}
anna   | set_retention     | PUT /v1/projects/<projects>/retention      | retention.set       | snapshots 10 days, curves for ever | {"snapshots_days": 10}
anna   | undo_retention    | POST /v1/projects/<projects>/retention/undo | retention.undone   | 0 files brought back |
anna   | delete_project    | DELETE /v1/projects/<projects>             | project.deleted     | another name |
anna   | change_password   | PUT /v1/me/password                        | password.changed    | Anna      | {"current": "<password>", "new": "another password"}
ada    | create_group      | POST /v1/groups                            | group.made          | Board     | {"name": "Board"}
ada    | add_member        | PUT /v1/groups/<groups>/members/<carl>     | group.joined        | Carl in Board |
ada    | remove_member     | DELETE /v1/groups/<groups>/members/<carl>  | group.left          | Carl not in Board |
ada    | set_limits        | PUT /v1/people/<carl>/limits               | person.limited      | Carl: running 2, queued no limit, files no limit, priority above 0 no | {"running": 2}
ada    | change_person     | PATCH /v1/people/<bert>                    | person.changed      | Bert: member, has left | {"left": true}
ada    | hand_over         | POST /v1/people/<bert>/hand-over           | person.handed_over  | Bert to Anna: 0 jobs | {"to": "<anna>"}
ada    | invite            | POST /v1/invitations                       | invitation.made     | guest     | {"role": "guest"}
ada    | revoke_invitation | DELETE /v1/invitations/<invitations>       | invitation.revoked  |           |
ada    | invite            | POST /v1/invitations                       | invitation.made     | guest     | {"role": "guest"}
nobody | accept_invitation | POST /v1/invitations/accept                | invitation.accepted | Dora: guest | {"secret": "<secret>", "name": "Dora", "password": "<password>"}
nobody | sign_in           | POST /v1/sessions                          | session.opened      |           | {"name": "Dora", "password": "<password>"}
carl   | end_session       | DELETE /v1/sessions/current                | session.closed      |           |
"#;

/// What writes nothing that is anybody's.
const CHANGES_NOTHING: [&str; 3] = ["preview_job", "read_measured_curve", "begin_sign_in"];
/// What a server without e-mail does not do: `mails` has a server of that.
const OF_MAIL: [&str; 3] = ["create_mail", "verify_mail", "remove_mail"];
/// The way of a worker's requests: a lease is its own proof, and the attempt's record says who had it.
const OF_WORKERS: &str = "/v1/worker/";

/// A row of [`DEEDS`], its stand-ins replaced but for those of `detail`, which may name what it makes.
struct Deed {
    id: String,
    method: String,
    path: String,
    action: String,
    detail: String,
    body: String,
}

/// A group in which much is done, and what came of it, by stand-in.
struct Deeds {
    group: Group,
    made: BTreeMap<String, String>,
}

impl Deeds {
    fn put_in(&self, text: &str) -> String {
        let made = self.made.iter();
        made.fold(text.to_owned(), |text, (name, value)| {
            text.replace(&format!("<{name}>"), value)
        })
    }

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

    /// Does it once from other pages, and once from the server's own, where it leaves one line.
    async fn does(&mut self, by: Option<&Somebody>, deed: &Deed) {
        let Deed { id, path, .. } = deed;
        let answer = match by {
            Some(by) => {
                self.is_refused_elsewhere(by, deed).await;
                self.group.send(by, &deed.method, path, &deed.body).await
            }
            None => {
                let headers = [
                    ("origin", "http://localhost:8400"),
                    ("host", "localhost:8400"),
                    JSON,
                ];
                let sent = request(&deed.method, path, &headers, &deed.body);
                self.group.lab.send(sent).await
            }
        };
        assert!((200..300).contains(&answer.status), "{id}: {answer:?}");
        let lines = self.lines(&answer).await;
        assert_eq!(lines.len(), 1, "{id}: {lines:?}");
        let line = &lines[0];
        assert_eq!(line["action"], deed.action, "{id}");
        let made = serde_json::from_slice(&answer.body).unwrap_or_default();
        self.keep(path, &made);
        assert_eq!(line["detail"], self.put_in(&deed.detail), "{id}");
        if let Some(by) = by {
            assert_eq!(line["who"], by.name, "{id}");
            assert!(line["credential"].is_string(), "{id}: {line}");
        }
    }

    async fn is_refused_elsewhere(&self, by: &Somebody, deed: &Deed) {
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
            let sent = request(&deed.method, &deed.path, &headers, &deed.body);
            let foreign = self.group.lab.send(sent).await;
            foreign.problem(403, "foreign-origin");
            assert_eq!(self.newest_line().await, before, "{} {page:?}", deed.id);
        }
    }

    /// Keeps what an answer says was made at this path.
    fn keep(&mut self, path: &str, answer: &Value) {
        let place = path
            .split('?')
            .next()
            .and_then(|path| path.rsplit('/').next());
        if let (Some(place), Some(id)) = (place, answer["id"].as_str()) {
            self.made.insert(place.to_owned(), id.to_owned());
        }
        let link = answer["path"]
            .as_str()
            .and_then(|path| path.split_once('#'));
        if let Some((_, secret)) = link {
            self.made.insert("secret".to_owned(), secret.to_owned());
        }
    }
}

#[tokio::test]
async fn every_change_is_this_pages_own_and_has_one_line_in_the_log() {
    let group = Group::open().await;
    let people = [&group.ada, &group.anna, &group.bert, &group.carl];
    let people = people.map(|person| (person.name.to_lowercase(), person.clone()));
    let people = BTreeMap::from(people);
    let submission: Value = serde_json::from_str(example()).expect("JSON");
    let name = submission["name"].as_str().expect("a name");
    let given = [
        ("example", example()),
        ("example name", name),
        ("password", PASSWORD),
    ];
    let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
    let ids = people
        .iter()
        .map(|(name, by)| (name.clone(), by.id.to_string()));
    let mut deeds = Deeds {
        made: given.into_iter().chain(ids).collect(),
        group,
    };
    let mut done = BTreeSet::new();
    for row in DEEDS.trim().lines() {
        let cells: Vec<&str> = row.splitn(6, '|').map(str::trim).collect();
        let [who, id, call, action, detail, body] = cells[..] else {
            panic!("six cells are a row: {row}");
        };
        let (method, path) = call.split_once(' ').expect("a method and a path");
        let deed = Deed {
            id: id.to_owned(),
            method: method.to_owned(),
            path: deeds.put_in(path),
            action: action.to_owned(),
            detail: detail.to_owned(),
            body: deeds.put_in(body),
        };
        let by = people.get(who);
        assert!(by.is_some() || who == "nobody", "{row}");
        deeds.does(by, &deed).await;
        done.insert(id);
    }

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
            if !is_exempt && !done.contains(id) {
                missing.push(id.to_owned());
            }
        }
    }
    assert!(missing.is_empty(), "do here {missing:?}");
    let before = deeds.newest_line().await;
    for path in reads.iter().filter(|path| !path.contains("/events")) {
        deeds.group.get(&deeds.group.ada, path).await;
    }
    assert_eq!(deeds.newest_line().await, before);
}
