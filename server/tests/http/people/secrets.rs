//! That no secret is written down: every kind of secret is used, then the log at its most talkative, every
//! file of the data folder and every value of every table of the database are searched for each.
use std::cell::Cell;
use std::io::Write;
use std::sync::{Arc, Mutex};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use loadframe_api::people::{Scope, Visibility};
use loadframe_server::store::people::Actor;
use memchr::memmem;
use serde_json::json;
use tracing_subscriber::filter::dynamic_filter_fn;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::layer::{Layer, SubscriberExt};

use super::everything::{bytes_of_files, values_of_tables};
use super::group::{Group, sign_in, to_job};
use super::issuer::{CLIENT, CLIENT_SECRET};
use super::single_sign_on::House;
use crate::support::{JSON, request};

const ORIGIN: &str = "http://localhost:8400";

thread_local! {
    /// Whether this thread, on which the whole test runs, is the one whose log is kept.
    static IS_KEPT: Cell<bool> = const { Cell::new(false) };
}

/// A log that is kept.
#[derive(Clone, Default)]
struct Kept(Arc<Mutex<Vec<u8>>>);

impl Write for Kept {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("a log").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl<'a> MakeWriter<'a> for Kept {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

fn holds(bytes: &[u8], text: &str) -> bool {
    memmem::find(bytes, text.as_bytes()).is_some()
}

#[tokio::test]
async fn neither_log_nor_data_hold_a_secret() {
    let log = Kept::default();
    IS_KEPT.set(true);
    let layer = tracing_subscriber::fmt::layer()
        .with_writer(log.clone())
        .with_ansi(false)
        .with_filter(dynamic_filter_fn(|_, _| IS_KEPT.get()));
    // for the whole process: what other tests have met before without a log would be heard of no more
    let subscriber = tracing_subscriber::registry().with(layer);
    tracing::subscriber::set_global_default(subscriber).expect("the only one");
    let house = House::open(json!([{ "everybody": true, "role": "member" }])).await;
    let Group { lab, anna, .. } = &house.group;
    let mut secrets: Vec<(&str, String)> = Vec::new();

    // passwords, right and wrong, one in the place of a name's
    let password = "marked-password-of-anna-71c2";
    let acting = lab.store.acting(Actor::shell());
    acting
        .set_password(anna.id, password, None)
        .await
        .expect("set");
    assert_eq!(sign_in(lab, ORIGIN, "Anna", password).await.status, 204);
    let wrong = "marked-wrong-password-83ab";
    sign_in(lab, ORIGIN, "Anna", wrong)
        .await
        .problem(403, "wrong-password");
    let short = "marked-x1";
    let session = acting
        .open_session(anna.id, false, "a test")
        .await
        .expect("a session");
    let cookie = format!("loadframe={}", session.secret);
    let headers = [
        ("cookie", cookie.as_str()),
        ("origin", ORIGIN),
        ("host", "localhost:8400"),
        JSON,
    ];
    let body = json!({ "current": password, "new": short }).to_string();
    lab.send(request("PUT", "/v1/me/password", &headers, &body))
        .await
        .problem(422, "invalid-request");
    secrets.extend([
        ("password", password.to_owned()),
        ("wrong password", wrong.to_owned()),
        ("short password", short.to_owned()),
        ("session", session.secret.clone()),
    ]);

    // tokens, in force and made up; links and invitations
    let token = house.group.token(anna, Scope::Submit).await.0.known_by.1;
    let token = token.trim_start_matches("Bearer ").to_owned();
    let project = house
        .group
        .project(anna, Visibility::Private, None)
        .await
        .id;
    let bearer = format!("Bearer {token}");
    let submitted = request(
        "POST",
        &format!("/v1/jobs?project={project}"),
        &[("authorization", &bearer), JSON],
        crate::support::example(),
    );
    let submitted = lab.send(submitted).await;
    assert_eq!(submitted.status, 201, "{submitted:?}");
    let job = super::group::id_of(&submitted.json());
    let made_up = "lf_marked-token-that-was-never-made";
    let unknown = [("authorization", &*format!("Bearer {made_up}"))];
    lab.get_with("/v1/jobs", &unknown)
        .await
        .problem(401, "sign-in-needed");
    let link = house.group.link(anna, to_job(job, true)).await.0.known_by;
    assert_eq!(
        lab.get_with(&format!("/v1/jobs/{job}"), &[(link.0, &link.1)])
            .await
            .status,
        200
    );
    let invited = house
        .group
        .send(
            &house.group.ada,
            "POST",
            "/v1/invitations",
            "{\"role\": \"guest\"}",
        )
        .await;
    let path = invited.json()["path"].as_str().expect("a path").to_owned();
    let invitation = path.rsplit('#').next().expect("a secret").to_owned();
    let body = json!({ "secret": invitation, "name": "Dora", "password": password }).to_string();
    let accepted = request("POST", "/v1/invitations/accept", &headers[1..], &body);
    assert_eq!(lab.send(accepted).await.status, 201);
    secrets.extend([
        ("token", token),
        ("unknown token", made_up.to_owned()),
        ("link", link.1.trim_start_matches("Bearer ").to_owned()),
        ("invitation", invitation),
    ]);

    // single sign-on: what is its own, what the provider gave, what the browser kept
    let (address, sealed) = house.begin(None).await;
    let query = house.issuer.agree(&address);
    let back = house.come_back(&query, &sealed).await;
    assert_eq!(back.header("location"), "/");
    let cookies = back
        .headers
        .get_all("set-cookie")
        .iter()
        .filter_map(|value| value.to_str().ok());
    let session = cookies
        .filter_map(|text| text.strip_prefix("loadframe="))
        .next()
        .expect("a session");
    let basic = STANDARD.encode(format!("{CLIENT}:{CLIENT_SECRET}"));
    secrets.extend([
        ("code", query["code"].clone()),
        ("state", query["state"].clone()),
        (
            "sealed cookie",
            sealed.split_once('=').expect("a cookie").1.to_owned(),
        ),
        ("client's secret", CLIENT_SECRET.to_owned()),
        ("client's header", basic),
        ("access token", "marked-access-token".to_owned()),
        (
            "session of single sign-on",
            session.split(';').next().expect("a secret").to_owned(),
        ),
    ]);

    // a webhook, whose secret follows from a file that is none of the database's
    let url = "http://8.8.8.8/marked-hook";
    let body = json!({ "url": url, "events": ["ended"] }).to_string();
    let hook = house.group.send(anna, "POST", "/v1/webhooks", &body).await;
    // setting the password has ended the session that Anna began with
    hook.problem(401, "sign-in-needed");
    let hook = lab
        .send(request("POST", "/v1/webhooks", &headers, &body))
        .await;
    assert_eq!(hook.status, 201, "{hook:?}");
    secrets.push((
        "webhook's secret",
        hook.json()["secret"].as_str().expect("a secret").to_owned(),
    ));

    let folder = &lab.store.options().data;
    let files = bytes_of_files(folder);
    let tables = values_of_tables(folder).await;
    let log = log.0.lock().expect("a log").clone();
    // all are really looked at
    assert!(
        holds(&tables, "Anna") && holds(&tables, url),
        "the tables were not read"
    );
    assert!(!files.is_empty(), "the data folder was not read");
    let is_kept = holds(&log, "/v1/sign-in/provider") && holds(&log, "TRACE");
    assert!(
        is_kept,
        "the log was not kept: {}",
        String::from_utf8_lossy(&log)
    );
    let found: Vec<&str> = secrets
        .iter()
        .flat_map(|(what, secret)| {
            assert!(secret.len() > 8, "{what}");
            [(&files, *what), (&tables, *what), (&log, *what)]
                .into_iter()
                .filter(|(bytes, _)| holds(bytes, secret))
                .map(|(_, what)| what)
        })
        .collect();
    assert!(found.is_empty(), "written down: {found:?}");
}
