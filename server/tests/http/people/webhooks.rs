//! Webhooks, told over real sockets.
//!
//! One file, long as it is: all of it listens with one receiver.
use std::sync::{Arc, Mutex};

use axum::Router;
use axum::http::{HeaderMap, StatusCode};
use axum::routing::post;
use hmac::{Hmac, KeyInit, Mac};
use ipnet::IpNet;
use loadframe_api::Timestamp;
use loadframe_api::people::{PersonChanges, Visibility};
use loadframe_server::store::UserAction;
use loadframe_server::telling::{Ways, tell};
use loadframe_server::webhooks::{Addresses, SIGNATURE};
use serde_json::{Value, json};
use sha2::Sha256;
use tokio::net::TcpListener;
use uuid::Uuid;

use super::group::{Group, Somebody, to_job};
use crate::support::{Lab, example};

const MINUTE: i64 = 60_000;

/// What was taken, and how the next one is answered.
#[derive(Clone, Default)]
struct Receiver {
    taken: Arc<Mutex<Vec<(String, String)>>>,
    answer: Arc<Mutex<Option<StatusCode>>>,
}

impl Receiver {
    async fn open() -> (Self, String) {
        let receiver = Self::default();
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("an address");
        let address = listener.local_addr().expect("an address");
        let own = receiver.clone();
        let take = async move |headers: HeaderMap, body: String| {
            let signature = headers[SIGNATURE].to_str().expect("text").to_owned();
            own.taken.lock().expect("taken").push((signature, body));
            let status = own
                .answer
                .lock()
                .expect("an answer")
                .unwrap_or(StatusCode::NO_CONTENT);
            (status, [("location", "/elsewhere")])
        };
        let router = Router::new().route("/hook", post(take));
        tokio::spawn(async move { axum::serve(listener, router).await });
        (receiver, format!("http://{address}/hook"))
    }

    fn answers(&self, status: Option<StatusCode>) {
        *self.answer.lock().expect("an answer") = status;
    }

    /// Bodies that came since the last time, their signatures checked.
    fn take(&self, secret: &str) -> Vec<Value> {
        let taken = std::mem::take(&mut *self.taken.lock().expect("taken"));
        let check = |(signature, body): (String, String)| {
            let (moment, digits) = signature.split_once(",v1=").expect("two parts");
            let seconds = moment.strip_prefix("t=").expect("a moment");
            let mut mac = Hmac::<Sha256>::new_from_slice(secret.as_bytes()).expect("a key");
            mac.update(format!("{seconds}.{body}").as_bytes());
            let right: String = mac
                .finalize()
                .into_bytes()
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect();
            assert_eq!(digits, right);
            serde_json::from_str(&body).expect("JSON")
        };
        taken.into_iter().map(check).collect()
    }
}

fn here() -> Vec<IpNet> {
    vec!["127.0.0.0/8".parse().expect("a network")]
}

async fn group() -> Group {
    Group::of(Lab::with(|config| config.webhook_networks = here()).await).await
}

/// Makes a webhook; its secret.
async fn made(
    group: &Group,
    by: &Somebody,
    url: &str,
    events: Value,
    project: Option<Uuid>,
) -> (Uuid, String) {
    let mut body = json!({ "url": url, "events": events });
    if let Some(project) = project {
        body["project"] = json!(project);
    }
    let answer = group
        .send(by, "POST", "/v1/webhooks", &body.to_string())
        .await;
    assert_eq!(answer.status, 201, "{answer:?}");
    let made = answer.json();
    (
        super::group::id_of(&made),
        made["secret"].as_str().expect("a secret").to_owned(),
    )
}

/// Tells everything that is due so many minutes from now.
async fn told(group: &Group, minutes: i64) -> usize {
    let now = Timestamp(Timestamp::now().as_millis() + minutes * MINUTE);
    let ways = Ways {
        addresses: Addresses::new(here()),
        mailer: None,
    };
    tell(&group.lab.store, &ways, now)
        .await
        .expect("the store answers")
}

async fn end(group: &Group, by: &Somebody, project: Uuid) -> Uuid {
    let id = group.submit(by, project).await;
    group
        .lab
        .store
        .request(id, UserAction::Cancel)
        .await
        .expect("cancelled");
    id
}

#[tokio::test]
async fn what_happens_is_told_signed_and_together() {
    let group = group().await;
    let (anna, bert) = (&group.anna, &group.bert);
    let (receiver, url) = Receiver::open().await;
    let (_, secret) = made(
        &group,
        anna,
        &url,
        json!(["ended", "shared", "ended"]),
        None,
    )
    .await;
    assert!(secret.starts_with("lfw_"));
    let project = group.project(anna, Visibility::Private, None).await.id;
    let berts = group.project(bert, Visibility::Private, None).await.id;
    let first = end(&group, anna, project).await;
    let second = end(&group, anna, project).await;
    end(&group, bert, berts).await;
    group.link(anna, to_job(first, true)).await;
    // what ends in the next seconds comes along
    assert_eq!(told(&group, 0).await, 0);
    assert_eq!(told(&group, 1).await, 1);
    let messages = receiver.take(&secret);
    assert_eq!(messages.len(), 1);
    let events = messages[0]["events"].as_array().expect("events").clone();
    let about: Vec<_> = events
        .iter()
        .map(|of| (of["event"].clone(), of["about"]["job"].clone()))
        .collect();
    assert_eq!(
        about,
        [
            (json!("ended"), json!(first)),
            (json!("ended"), json!(second)),
            (json!("shared"), json!(first))
        ]
    );
    assert_eq!(events[0]["about"]["outcome"], "cancelled");
    assert_eq!(events[2]["about"]["files"], 1);
    // and only once where it was taken
    assert_eq!(told(&group, 2).await, 0);
    let listed = group.get(anna, "/v1/webhooks").await.json();
    assert!(
        listed["items"][0]["told_at"].is_string() && listed["items"][0]["waiting"] == 0,
        "{listed}"
    );
    assert!(!listed.to_string().contains(&secret));
}

#[tokio::test]
async fn what_was_not_taken_is_told_again_ever_later() {
    let group = group().await;
    let anna = &group.anna;
    let (receiver, url) = Receiver::open().await;
    let (id, secret) = made(&group, anna, &url, json!(["ended"]), None).await;
    let project = group.project(anna, Visibility::Private, None).await.id;
    end(&group, anna, project).await;
    let listed = async || group.get(anna, "/v1/webhooks").await.json()["items"][0].clone();
    for (status, said) in [(500, "500"), (302, "302")] {
        receiver.answers(StatusCode::from_u16(status).ok());
        assert_eq!(told(&group, if status == 500 { 1 } else { 2 }).await, 0);
        assert!(
            listed().await["last_error"]
                .as_str()
                .expect("an error")
                .contains(said)
        );
    }
    let view = listed().await;
    assert_eq!(
        (&view["failures"], &view["waiting"]),
        (&json!(2), &json!(1))
    );
    let numbers: Vec<Value> = receiver
        .take(&secret)
        .iter()
        .map(|of| of["events"][0]["number"].clone())
        .collect();
    assert_eq!(
        (numbers.len(), &numbers[0]),
        (2, &numbers[1]),
        "the same number, and no redirect followed"
    );
    receiver.answers(None);
    // not before its wait is over
    assert_eq!(told(&group, 2).await, 0);
    assert!(receiver.take(&secret).is_empty());
    assert_eq!(told(&group, 3).await, 1);
    assert_eq!(receiver.take(&secret).len(), 1);
    assert_eq!(listed().await["failures"], 0);
    // after a day it is given up, and said
    receiver.answers(Some(StatusCode::GONE));
    end(&group, anna, project).await;
    told(&group, 25 * 60).await;
    let view = listed().await;
    assert_eq!(view["waiting"], 0);
    assert!(
        view["last_error"]
            .as_str()
            .expect("an error")
            .contains("1 events of more than a day ago"),
        "{view}"
    );
    let path = format!("/v1/webhooks/{id}");
    group
        .send(&group.bert, "DELETE", &path, "")
        .await
        .problem(404, "not-found");
    assert_eq!(group.send(anna, "DELETE", &path, "").await.status, 204);
    group
        .send(anna, "DELETE", &path, "")
        .await
        .problem(404, "not-found");
}

#[tokio::test]
async fn nobody_is_told_of_what_they_do_not_hold() {
    let group = group().await;
    let (receiver, url) = Receiver::open().await;
    let groups = group
        .project(&group.anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let (_, secret) = made(&group, &group.bert, &url, json!(["ended"]), Some(groups)).await;
    let body = json!({ "url": url, "events": ["ended"], "project": groups }).to_string();
    group
        .send(&group.carl, "POST", "/v1/webhooks", &body)
        .await
        .problem(404, "not-found");
    group
        .send(&group.gina, "POST", "/v1/webhooks", &body)
        .await
        .problem(403, "not-allowed");
    end(&group, &group.anna, groups).await;
    assert_eq!(told(&group, 1).await, 1);
    assert_eq!(receiver.take(&secret).len(), 1);
    // from the day he is out of the group
    group
        .lab
        .store
        .set_member(group.paper, group.bert.id, false)
        .await
        .expect("out");
    end(&group, &group.anna, groups).await;
    assert_eq!(told(&group, 1).await, 0);
    group
        .lab
        .store
        .set_member(group.paper, group.bert.id, true)
        .await
        .expect("in");
    assert_eq!(told(&group, 1).await, 1);
    let changes = PersonChanges {
        left: Some(true),
        ..PersonChanges::default()
    };
    group
        .lab
        .store
        .change_person(group.bert.id, changes)
        .await
        .expect("left");
    end(&group, &group.anna, groups).await;
    assert_eq!(told(&group, 1).await, 0);
}

#[tokio::test]
async fn a_private_address_is_refused_in_a_sentence() {
    let group = Group::open().await;
    for (url, said) in [
        ("http://127.0.0.1:9/", "is a private address"),
        ("http://localhost/", "is a private address"),
        ("http://[::ffff:10.0.0.1]/", "is a private address"),
        ("ftp://example.org/", "no address of http or https"),
        (
            "http://user:pass@example.org/",
            "without a name and password",
        ),
        ("http://no.such.host.invalid/", "cannot be found"),
    ] {
        let body = json!({ "url": url, "events": ["ended"] }).to_string();
        let problem = group
            .send(&group.anna, "POST", "/v1/webhooks", &body)
            .await
            .problem(422, "invalid-request");
        assert_eq!(problem["violations"][0]["pointer"], "/url");
        let detail = problem["violations"][0]["detail"]
            .as_str()
            .expect("a detail");
        assert!(detail.contains(said), "{url}: {detail}");
    }
    // one that was fine when it was made is looked at again each time
    let (receiver, url) = Receiver::open().await;
    let house = self::group().await;
    made(&house, &house.anna, &url, json!(["ended"]), None).await;
    let project = house
        .project(&house.anna, Visibility::Private, None)
        .await
        .id;
    end(&house, &house.anna, project).await;
    let now = Timestamp(Timestamp::now().as_millis() + MINUTE);
    assert_eq!(
        tell(&house.lab.store, &Ways::default(), now)
            .await
            .expect("told"),
        0
    );
    assert!(receiver.taken.lock().expect("taken").is_empty());
    let listed = house.get(&house.anna, "/v1/webhooks").await.json();
    let error = listed["items"][0]["last_error"]
        .as_str()
        .expect("an error")
        .to_owned();
    assert!(error.contains("private address"), "{error}");
}

#[tokio::test]
async fn files_near_a_limit_are_told_once_at_each_step() {
    let group = group().await;
    let (anna, store) = (&group.anna, &group.lab.store);
    let (receiver, url) = Receiver::open().await;
    let (_, secret) = made(&group, anna, &url, json!(["quota"]), None).await;
    let project = group.project(anna, Visibility::Private, None).await.id;
    group.submit(anna, project).await;
    let lease = group.lab.claim().await;
    // 1000 bytes: a file of 850 is below nine tenths, one of 60 more above, one of 100 more beyond
    let limits = json!({ "disk_gb": 1e-6 }).to_string();
    let path = format!("/v1/people/{}/limits", anna.id);
    let set = group.send(&group.ada, "PUT", &path, &limits).await;
    assert_eq!(set.status, 200, "{set:?}");
    let upload = async |name: &str, count: usize| {
        let bytes = vec![b'a'; count];
        let sha256 = loadframe_api::sha256_hex(&bytes);
        let key = crate::support::key(&lease);
        let stored = store.upload(key, name, &sha256, bytes.as_slice()).await;
        stored.expect("uploaded");
    };
    upload("a.csv", 850).await;
    assert_eq!(told(&group, 1).await, 0);
    upload("b.csv", 60).await;
    upload("c.csv", 10).await;
    assert_eq!(told(&group, 1).await, 1);
    let events = receiver.take(&secret)[0]["events"]
        .as_array()
        .expect("events")
        .clone();
    assert_eq!(events.len(), 1, "{events:?}");
    assert_eq!(events[0]["event"], "quota");
    assert_eq!(
        events[0]["about"],
        json!({ "person": "Anna", "used_gb": 9.1e-7, "limit_gb": 1e-6 })
    );
    upload("d.csv", 100).await;
    upload("e.csv", 100).await;
    assert_eq!(told(&group, 2).await, 1);
    let events = receiver.take(&secret)[0]["events"]
        .as_array()
        .expect("events")
        .clone();
    assert_eq!(
        (events.len(), &events[0]["about"]["used_gb"]),
        (1, &json!(1.02e-6))
    );
}

#[tokio::test]
async fn queued_core_hours_near_a_limit_are_told_once() {
    let group = group().await;
    let anna = &group.anna;
    let (receiver, url) = Receiver::open().await;
    let (_, secret) = made(&group, anna, &url, json!(["quota"]), None).await;
    let project = group.project(anna, Visibility::Private, None).await.id;
    let dry = group
        .send(anna, "POST", "/v1/jobs?dry_run=true", example())
        .await;
    let one = dry.json()["estimate"]["wall_s"].as_f64().expect("seconds") / 3600.0;
    // two are within nine tenths and the whole, a third is beyond
    let limits = json!({ "queued_core_h": 2.1 * one }).to_string();
    let path = format!("/v1/people/{}/limits", anna.id);
    let set = group.send(&group.ada, "PUT", &path, &limits).await;
    assert_eq!(set.status, 200, "{set:?}");
    group.submit(anna, project).await;
    assert_eq!(told(&group, 1).await, 0);
    group.submit(anna, project).await;
    let path = format!("/v1/jobs?project={project}");
    let refused = group.send(anna, "POST", &path, example()).await;
    refused.problem(422, "invalid-job");
    assert_eq!(told(&group, 1).await, 1);
    let events = receiver.take(&secret)[0]["events"].clone();
    assert_eq!(events.as_array().map(Vec::len), Some(1), "{events}");
    let about = &events[0]["about"];
    assert_eq!(about["person"], "Anna");
    let number = |name: &str| about[name].as_f64().expect("a number");
    let part = number("used_core_h") / number("limit_core_h");
    assert!((part - 2.0 / 2.1).abs() < 1e-3, "{about}");
}

/// What the guide tells a receiver to check, at the moment `now` [s since 1970].
fn is_genuine(secret: &str, signature: &str, body: &str, now: i64) -> bool {
    let Some((moment, digits)) = signature.split_once(",v1=") else {
        return false;
    };
    let seconds = moment.strip_prefix("t=").unwrap_or_default();
    let mut mac = Hmac::<Sha256>::new_from_slice(secret.as_bytes()).expect("a key");
    mac.update(format!("{seconds}.{body}").as_bytes());
    let right = mac.finalize().into_bytes();
    let right: String = right.iter().map(|byte| format!("{byte:02x}")).collect();
    let age = seconds.parse().map(|seconds: i64| (now - seconds).abs());
    digits == right && age.is_ok_and(|age| age < 300)
}

/// A message that somebody has caught is good for five minutes, and one that the server tries again much later
/// is signed anew.
#[tokio::test]
async fn a_message_caught_on_its_way_is_told_by_its_age_and_one_tried_again_is_not() {
    let group = group().await;
    let (receiver, url) = Receiver::open().await;
    let (_, secret) = made(&group, &group.anna, &url, json!(["ended"]), None).await;
    let project = group
        .project(&group.anna, Visibility::Private, None)
        .await
        .id;
    end(&group, &group.anna, project).await;
    let start = Timestamp::now().as_millis() / 1000;
    receiver.answers(Some(StatusCode::SERVICE_UNAVAILABLE));
    assert_eq!(told(&group, 1).await, 0);
    receiver.answers(None);
    assert_eq!(told(&group, 20).await, 1);
    let taken = std::mem::take(&mut *receiver.taken.lock().expect("taken"));
    let [(caught, body), (again, same)] = &taken[..] else {
        panic!("two messages: {taken:?}");
    };
    let (minute, twentieth) = (start + 60, start + 20 * 60);
    assert!(is_genuine(&secret, caught, body, minute));
    assert!(is_genuine(&secret, caught, body, minute + 4 * 60));
    assert!(!is_genuine(&secret, caught, body, minute + 6 * 60));
    assert!(is_genuine(&secret, again, same, twentieth));
    // with another moment, body or secret it is nobody's
    let (_, digits) = caught.split_once(",v1=").expect("two parts");
    let renewed = format!("t={twentieth},v1={digits}");
    assert!(!is_genuine(&secret, &renewed, body, twentieth));
    assert!(!is_genuine(
        &secret,
        caught,
        &body.replace("ended", "endet"),
        minute
    ));
    assert!(!is_genuine("lfw_other", caught, body, minute));
    // the same event, by its number
    let number = |body: &String| {
        let message: Value = serde_json::from_str(body).expect("JSON");
        message["events"][0]["number"].clone()
    };
    assert_eq!(number(body), number(same));
}
