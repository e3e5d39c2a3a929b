//! E-mail, handed over to a server of SMTP of a few lines, which can be at fault. To a real one, over TLS and
//! with a password, it goes in `tests/mail`.
use std::sync::{Arc, Mutex};

use loadframe_api::Timestamp;
use loadframe_api::people::Visibility;
use loadframe_server::mail::{MailSettings, Mailer};
use loadframe_server::store::UserAction;
use loadframe_server::telling::{Ways, tell};
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream};
use uuid::Uuid;

use super::group::{Group, Somebody, id_of};
use crate::support::{JSON, Lab, request};

const MINUTE: i64 = 60_000;

/// How the server of SMTP takes what comes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Mood {
    #[default]
    Takes,
    /// There is no such mailbox.
    Refuses,
    /// Hangs up in the middle of the message.
    HangsUp,
    /// Is no server of SMTP.
    Babbles,
}

/// A server of SMTP (RFC 5321) that keeps what it takes.
#[derive(Clone, Default)]
struct Postbox {
    taken: Arc<Mutex<Vec<String>>>,
    mood: Arc<Mutex<Mood>>,
}

impl Postbox {
    async fn open() -> (Self, u16) {
        let postbox = Self::default();
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("an address");
        let port = listener.local_addr().expect("an address").port();
        let own = postbox.clone();
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                let postbox = own.clone();
                // who hangs up ends in an error here
                tokio::spawn(async move { postbox.talk(stream).await });
            }
        });
        (postbox, port)
    }

    async fn talk(self, stream: TcpStream) -> std::io::Result<()> {
        let mood = *self.mood.lock().expect("a mood");
        let (read, mut write) = stream.into_split();
        let mut lines = BufReader::new(read).lines();
        if mood == Mood::Babbles {
            return write.write_all(b"HTTP/1.1 400 Bad Request\r\n\r\n").await;
        }
        write.write_all(b"220 here ESMTP\r\n").await?;
        let mut message: Option<String> = None;
        while let Some(line) = lines.next_line().await? {
            let answer = match (&mut message, line.as_str()) {
                (Some(text), ".") => {
                    // long lines are broken after "=" (RFC 2045)
                    let whole = std::mem::take(text).replace("=\n", "");
                    self.taken.lock().expect("taken").push(whole);
                    message = None;
                    "250 taken"
                }
                (Some(text), line) => {
                    text.push_str(line.strip_prefix('.').unwrap_or(line));
                    text.push('\n');
                    continue;
                }
                (None, line) => match line.get(..4).unwrap_or("").to_uppercase().as_str() {
                    "RCPT" if mood == Mood::Refuses => "550 no such mailbox",
                    "DATA" if mood == Mood::HangsUp => return Ok(()),
                    "DATA" => {
                        message = Some(String::new());
                        "354 go on"
                    }
                    "QUIT" => "221 bye",
                    _ => "250 fine",
                },
            };
            write.write_all(format!("{answer}\r\n").as_bytes()).await?;
        }
        Ok(())
    }

    fn is(&self, mood: Mood) {
        *self.mood.lock().expect("a mood") = mood;
    }

    fn take(&self) -> Vec<String> {
        std::mem::take(&mut *self.taken.lock().expect("taken"))
    }
}

fn mailer(port: u16) -> Mailer {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("mail.json");
    let settings = json!({ "server": format!("127.0.0.1:{port}"), "security": "none",
        "from": "Loadframe <lab@example.org>", "address": "https://lab.example.org" });
    std::fs::write(&path, settings.to_string()).expect("written");
    Mailer::new(&MailSettings::read(&path).expect("settings")).expect("a mailer")
}

/// A group's server that sends e-mail there.
async fn group(port: u16) -> Group {
    Group::of(Lab::with(|config| config.mailer = Some(Arc::new(mailer(port)))).await).await
}

/// Hands over everything that is due so many minutes from now.
async fn told(group: &Group, minutes: i64) -> usize {
    let now = Timestamp(Timestamp::now().as_millis() + minutes * MINUTE);
    let ways = Ways {
        mailer: group.lab.state.ways().mailer.clone(),
        ..Ways::default()
    };
    tell(&group.lab.store, &ways, now)
        .await
        .expect("the store answers")
}

async fn asked(group: &Group, by: &Somebody, address: &str, events: Value) -> Value {
    let body = json!({ "address": address, "events": events }).to_string();
    let answer = group.send(by, "POST", "/v1/mails", &body).await;
    assert_eq!(answer.status, 201, "{answer:?}");
    answer.json()
}

/// The secret of the link in an e-mail.
fn secret_in(message: &str) -> String {
    let (_, link) = message
        .split_once("https://lab.example.org/mail#")
        .expect("a link");
    link.lines().next().expect("a line").trim().to_owned()
}

async fn verify(group: &Group, by: &Somebody, secret: &str) -> u16 {
    let body = json!({ "secret": secret }).to_string();
    group
        .send(by, "POST", "/v1/mails/verify", &body)
        .await
        .status
}

async fn end(group: &Group, by: &Somebody, project: Uuid) -> Uuid {
    let id = group.submit(by, project).await;
    let ended = group.lab.store.request(id, UserAction::Cancel).await;
    ended.expect("cancelled");
    id
}

#[tokio::test]
async fn nothing_is_sent_before_the_address_is_verified_and_then_together() {
    let (postbox, port) = Postbox::open().await;
    let group = group(port).await;
    let (anna, bert) = (&group.anna, &group.bert);
    let project = group.project(anna, Visibility::Private, None).await.id;
    asked(&group, anna, "anna@example.org", json!(["ended", "failed"])).await;
    end(&group, anna, project).await;
    assert_eq!(told(&group, 0).await, 1, "the link is sent at once");
    let first = postbox.take();
    assert_eq!(first.len(), 1);
    assert!(first[0].contains("To: anna@example.org"), "{}", first[0]);
    assert!(
        first[0].contains("Subject: loadframe: confirm this address"),
        "{}",
        first[0]
    );
    assert!(
        first[0].contains("Auto-Submitted: auto-generated"),
        "{}",
        first[0]
    );
    assert_eq!(
        told(&group, 60).await,
        0,
        "what happened before is told to nobody"
    );
    let secret = secret_in(&first[0]);
    // what was sent for Anna is no use to Bert, and a part of it none to anybody
    assert_eq!(verify(&group, bert, &secret).await, 404);
    assert_eq!(verify(&group, anna, &secret[..secret.len() - 2]).await, 404);
    assert_eq!(verify(&group, anna, &secret).await, 204);
    let listed = group.get(anna, "/v1/mails").await.json();
    assert_eq!(listed["items"][0]["is_verified"], true, "{listed}");
    assert_eq!(listed["items"][0]["events"], json!(["ended", "failed"]));
    assert!(!listed.to_string().contains(&secret));

    for _ in 0..30 {
        end(&group, anna, project).await;
    }
    assert_eq!(told(&group, 0).await, 0, "more may end in the next minute");
    assert_eq!(told(&group, 2).await, 1);
    let digest = postbox.take().remove(0);
    assert!(
        digest.contains("Subject: loadframe: 30 cancelled"),
        "{digest}"
    );
    assert_eq!(
        digest.matches("https://lab.example.org/jobs/").count(),
        20,
        "{digest}"
    );
    // the next one not before five minutes later
    end(&group, anna, project).await;
    assert_eq!(told(&group, 4).await, 0);
    assert_eq!(told(&group, 8).await, 1);
    assert!(postbox.take()[0].contains("was cancelled"));

    let id = id_of(&listed["items"][0]);
    let removed = group
        .send(bert, "DELETE", &format!("/v1/mails/{id}"), "")
        .await;
    removed.problem(404, "not-found");
    let removed = group
        .send(anna, "DELETE", &format!("/v1/mails/{id}"), "")
        .await;
    assert_eq!(removed.status, 204);
    end(&group, anna, project).await;
    assert_eq!(told(&group, 30).await, 0);
    assert_eq!(
        verify(&group, anna, &secret).await,
        404,
        "its link is over with it"
    );
}

#[tokio::test]
async fn what_the_server_does_not_take_is_tried_again_and_told_why() {
    let (postbox, port) = Postbox::open().await;
    let group = group(port).await;
    let anna = &group.anna;
    asked(&group, anna, "anna@example.org", json!(["ended"])).await;
    let error = async || {
        let listed = group.get(anna, "/v1/mails").await.json();
        let mail = listed["items"][0].clone();
        (
            mail["failures"].clone(),
            mail["last_error"].as_str().unwrap_or("").to_owned(),
        )
    };
    for (minutes, mood, failures, words) in [
        (0, Mood::Refuses, 1, "no such mailbox"),
        (1, Mood::HangsUp, 2, "mail server did not take it"),
        (2, Mood::Babbles, 3, "mail server did not take it"),
    ] {
        postbox.is(mood);
        assert_eq!(told(&group, minutes).await, 0, "{mood:?}");
        let (count, text) = error().await;
        assert_eq!(count, json!(failures), "{mood:?} {text}");
        assert!(text.contains(words), "{mood:?}: {text}");
    }
    assert!(postbox.take().is_empty());
    postbox.is(Mood::Takes);
    assert_eq!(told(&group, 2).await, 0, "it waits longer after each");
    assert_eq!(told(&group, 5).await, 1);
    assert_eq!(postbox.take().len(), 1);
    assert_eq!(error().await, (json!(0), String::new()));
}

#[tokio::test]
async fn what_cannot_be_an_address_or_is_one_too_many_is_refused() {
    let (_, port) = Postbox::open().await;
    let group = group(port).await;
    let anna = &group.anna;
    let ask = async |address: &str| {
        let body = json!({ "address": address, "events": ["ended"] }).to_string();
        group.send(anna, "POST", "/v1/mails", &body).await
    };
    for wrong in [
        "anna",
        "anna@",
        "@example.org",
        "a b@example.org",
        "anna@localhost",
        "a@b.org\r\nBcc: c@d.org",
    ] {
        let problem = ask(wrong).await.problem(422, "invalid-request");
        assert_eq!(
            problem["violations"][0]["pointer"], "/address",
            "{wrong}: {problem}"
        );
    }
    for number in 0..10 {
        assert_eq!(ask(&format!("a{number}@example.org")).await.status, 201);
    }
    let problem = ask("b@example.org").await.problem(422, "invalid-request");
    assert_eq!(problem["violations"][0]["code"], "too_many", "{problem}");
    let none = Group::open().await;
    let body = json!({ "address": "a@example.org", "events": ["ended"] }).to_string();
    let answer = none.send(&none.anna, "POST", "/v1/mails", &body).await;
    let problem = answer.problem(409, "conflict");
    assert!(
        problem["detail"]
            .as_str()
            .expect("a sentence")
            .contains("--mail"),
        "{problem}"
    );
}

/// The rows of `audited` that need a server which sends e-mail.
#[tokio::test]
async fn each_change_of_an_address_is_this_pages_own_and_has_one_line_in_the_log() {
    let (postbox, port) = Postbox::open().await;
    let group = group(port).await;
    let (ada, anna) = (&group.ada, &group.anna);
    let log = async || {
        let log = group.get(ada, "/v1/audit?limit=1000").await.json();
        log["items"].as_array().expect("lines").clone()
    };
    let mut id = String::new();
    for (method, action) in [
        ("POST", "mail.made"),
        ("VERIFY", "mail.verified"),
        ("DELETE", "mail.removed"),
    ] {
        let (method, path, body) = match method {
            "POST" => {
                let body = json!({ "address": "anna@example.org", "events": ["ended"] });
                (method, "/v1/mails".to_owned(), body.to_string())
            }
            "VERIFY" => {
                assert_eq!(told(&group, 0).await, 1);
                let secret = secret_in(&postbox.take()[0]);
                let body = json!({ "secret": secret }).to_string();
                ("POST", "/v1/mails/verify".to_owned(), body)
            }
            _ => (method, format!("/v1/mails/{id}"), String::new()),
        };
        let before = log().await.len();
        let (cookie, session) = &anna.known_by;
        for page in [
            None,
            Some(("origin", "http://evil.example")),
            Some(("sec-fetch-site", "cross-site")),
        ] {
            let mut headers = vec![(*cookie, session.as_str()), JSON];
            headers.extend(page);
            let foreign = request(method, &path, &headers, &body);
            let foreign = group.lab.send(foreign).await;
            foreign.problem(403, "foreign-origin");
        }
        assert_eq!(log().await.len(), before, "{action}");
        let answer = group.send(anna, method, &path, &body).await;
        assert!((200..300).contains(&answer.status), "{action}: {answer:?}");
        if action == "mail.made" {
            id = id_of(&answer.json()).to_string();
        }
        let lines = log().await;
        assert_eq!(lines.len(), before + 1, "{action}");
        let line = &lines[0];
        assert_eq!(
            (&line["action"], &line["who"], &line["object"]),
            (&json!(action), &json!("Anna"), &json!(id)),
            "{line}"
        );
        assert_eq!(line["request"], answer.header("x-request-id"));
        assert!(line["credential"].is_string(), "{line}");
        // the host of an address is told, never whose it is
        assert!(!line.to_string().contains("anna@"), "{line}");
    }
}
