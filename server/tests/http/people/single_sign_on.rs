//! Single sign-on by a provider.
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use axum::extract::ConnectInfo;
use loadframe_api::people::{NewInvitation, PersonChanges, Role};
use loadframe_server::single_sign_on::{Settings, SingleSignOn};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::group::{Group, PASSWORD, Somebody, sign_in};
use super::issuer::{CLIENT, CLIENT_SECRET, Issuer, Signing};
use crate::support::{Answer, Lab, request};

const ORIGIN: &str = "http://localhost:8400";
const HOST: (&str, &str) = ("host", "localhost:8400");

static CAME: AtomicU32 = AtomicU32::new(0);

/// A group's server beside an issuer.
pub(super) struct House {
    pub(super) group: Group,
    pub(super) issuer: Issuer,
    _secret: TempDir,
}

/// A server with these settings of single sign-on.
pub(super) fn lab_with(settings: Value) -> impl Future<Output = Lab> {
    let settings: Settings = serde_json::from_value(settings).expect("settings");
    let sign_on = Arc::new(SingleSignOn::new(settings).expect("good settings"));
    Lab::with(|config| config.single_sign_on = Some(sign_on))
}

impl House {
    pub(super) async fn open(admit: Value) -> Self {
        let issuer = Issuer::open().await;
        let folder = TempDir::new().expect("a folder");
        let file = folder.path().join("secret");
        std::fs::write(&file, format!("{CLIENT_SECRET}\n")).expect("a secret");
        let settings = json!({
            "provider": { "name": "University", "issuer": issuer.address, "client_id": CLIENT,
                "client_secret_file": file, "address": ORIGIN },
            "admit": admit,
        });
        Self {
            group: Group::of(lab_with(settings).await).await,
            issuer,
            _secret: folder,
        }
    }

    /// Begins as the page does: where the browser goes, and its cookie.
    pub(super) async fn begin(&self, by: Option<&Somebody>) -> (String, String) {
        let mut headers = vec![("origin", ORIGIN), HOST];
        headers.extend(by.map(|of| (of.known_by.0, &*of.known_by.1)));
        let answer = request("POST", "/v1/sign-in/provider", &headers, "");
        let answer = self.group.lab.send(answer).await;
        assert_eq!(answer.status, 200, "{answer:?}");
        let cookie = answer.header("set-cookie").to_owned();
        assert!(
            cookie.ends_with("; Path=/; HttpOnly; SameSite=Lax; Max-Age=600"),
            "{cookie}"
        );
        let cookie = cookie.split(';').next().unwrap_or("").to_owned();
        let address = answer.json()["address"]
            .as_str()
            .expect("an address")
            .to_owned();
        (address, cookie)
    }

    /// Comes back with a query and a cookie.
    pub(super) async fn come_back(&self, query: &BTreeMap<String, String>, cookie: &str) -> Answer {
        let query: String = url::form_urlencoded::Serializer::new(String::new())
            .extend_pairs(query)
            .finish();
        let path = format!("/v1/sign-in/provider?{query}");
        let headers = [("cookie", cookie), HOST, ("sec-fetch-site", "cross-site")];
        let mut request = request("GET", &path, &headers, "");
        // from another address each time: one with many failures waits
        let number = CAME.fetch_add(1, Ordering::Relaxed).to_be_bytes();
        let peer = SocketAddr::from(([10, 9, number[2], number[3]], 40_000));
        request.extensions_mut().insert(ConnectInfo(peer));
        let answer = self.group.lab.send(request).await;
        assert_eq!(answer.status, 303, "{answer:?}");
        answer
    }

    async fn sign_on(&self, by: Option<&Somebody>) -> Answer {
        let (address, cookie) = self.begin(by).await;
        let query = self.issuer.agree(&address);
        self.come_back(&query, &cookie).await
    }

    /// Signs on as who the issuer says with these claims; the name of the account.
    async fn name_of(&self, claims: Value) -> Result<String, String> {
        self.issuer.word().claims = claims;
        let answer = self.sign_on(None).await;
        match session_of(&answer) {
            Some(cookie) => {
                let me = self
                    .group
                    .lab
                    .get_with("/v1/me", &[("cookie", &cookie)])
                    .await
                    .json();
                Ok(me["person"]["name"].as_str().expect("a name").to_owned())
            }
            None => Err(answer.header("location").to_owned()),
        }
    }

    async fn invite(&self, email: &str, role: Role) {
        let new = NewInvitation {
            role,
            groups: vec![self.group.paper],
            days: 1,
            email: Some(email.to_owned()),
        };
        self.group
            .lab
            .store
            .invite(new)
            .await
            .expect("an invitation");
    }
}

/// The cookie of a session in an answer.
fn session_of(answer: &Answer) -> Option<String> {
    let cookies = answer.headers.get_all("set-cookie").iter();
    let mut cookies = cookies.filter_map(|value| value.to_str().ok()?.split(';').next());
    let found = cookies.find(|cookie| cookie.starts_with("loadframe=") && cookie.len() > 20);
    found.map(str::to_owned)
}

fn anna() -> Value {
    json!({ "sub": "anna-1", "name": "Anna Weber", "email": "anna@example.org", "email_verified": true })
}

#[tokio::test]
async fn who_may_come_in_is_invited_or_fits_a_rule() {
    let admit = json!([
        { "group": "heads", "role": "administrator" },
        { "email_domain": "example.org", "role": "guest", "joins": ["Paper", "not there"] },
    ]);
    let house = House::open(admit).await;
    let lab = &house.group.lab;
    assert_eq!(
        lab.get("/v1/sign-in").await.json(),
        json!({ "accounts": true, "provider": "University" })
    );
    let role = async |name: &str| {
        let people = house.group.get(&house.group.ada, "/v1/people").await.json();
        let mut people = people["items"]
            .as_array()
            .expect("people")
            .clone()
            .into_iter();
        people.find(|of| of["name"] == name).expect("a person")["role"].clone()
    };
    // by the domain of a verified address, into a group that is there
    assert_eq!(house.name_of(anna()).await.as_deref(), Ok("Anna Weber"));
    assert_eq!(role("Anna Weber").await, "guest");
    let groups = house.group.get(&house.group.ada, "/v1/groups").await.json();
    let members = groups["items"][0]["members"].to_string();
    assert!(members.contains("Anna Weber"), "{members}");
    // the same person again, whatever the name is now
    let mut renamed = anna();
    renamed["name"] = json!("Anna Maier");
    assert_eq!(house.name_of(renamed).await.as_deref(), Ok("Anna Weber"));
    // an invitation is one person's, and goes before the rules
    house.invite(" Berta@Example.org ", Role::Member).await;
    let berta = json!({ "sub": "2", "name": "Anna Weber", "email": "berta@example.org", "email_verified": true });
    assert_eq!(
        house.name_of(berta.clone()).await.as_deref(),
        Ok("berta@example.org")
    );
    assert_eq!(role("berta@example.org").await, "member");
    // a group that the issuer tells of on being asked
    house.issuer.word().more = json!({ "groups": ["heads"] });
    let head = json!({ "sub": "3", "name": "ANNA WEBER" });
    assert_eq!(house.name_of(head).await.as_deref(), Ok("ANNA WEBER 2"));
    assert_eq!(role("ANNA WEBER 2").await, "administrator");
    house.issuer.word().more = json!({});
    // everybody else stays outside, whatever address they claim
    for (subject, email, is_verified) in [
        ("4", json!("eve@evil.example"), json!(true)),
        ("5", json!("eve@example.org"), json!(false)),
        ("6", json!("eve@example.org"), json!(null)),
        ("7", json!(null), json!(null)),
    ] {
        let claims =
            json!({ "sub": subject, "name": "Eve", "email": email, "email_verified": is_verified });
        let refused = house.name_of(claims).await;
        assert_eq!(
            refused,
            Err("/sign-in?refused=not_admitted".to_owned()),
            "{subject}"
        );
    }
    // who has left stays away, though the provider knows them
    let people = lab.store.people().await.expect("people");
    let left = people
        .iter()
        .find(|of| of.name == "berta@example.org")
        .expect("Berta");
    let changes = PersonChanges {
        left: Some(true),
        ..PersonChanges::default()
    };
    lab.store
        .change_person(left.id, changes)
        .await
        .expect("changed");
    assert_eq!(
        house.name_of(berta).await,
        Err("/sign-in?refused=not_admitted".to_owned())
    );
    // and nobody has a password that they did not choose
    for password in ["", " ", PASSWORD] {
        let answer = sign_in(lab, ORIGIN, "Anna Weber", password).await;
        assert!([403, 422].contains(&answer.status), "{answer:?}");
    }
}

#[tokio::test]
async fn a_token_with_a_fault_is_refused() {
    let house = House::open(json!([{ "everybody": true, "role": "member" }])).await;
    let refused = Err("/sign-in?refused=provider".to_owned());
    assert_eq!(house.name_of(anna()).await.as_deref(), Ok("Anna Weber"));
    for (claim, value) in [
        ("iss", json!("https://evil.example")),
        ("aud", json!("another client")),
        ("aud", json!([])),
        ("exp", json!(1_000_000_000)),
        ("nonce", json!("of another sign-in")),
        ("nonce", json!(null)),
        ("exp", json!(null)),
        ("iss", json!(null)),
        ("sub", json!(null)),
    ] {
        let mut claims = anna();
        claims[claim] = value.clone();
        assert_eq!(house.name_of(claims).await, refused, "{claim} {value}");
    }
    for signing in [Signing::Other, Signing::None, Signing::Secret] {
        house.issuer.word().signing = signing;
        assert_eq!(house.name_of(anna()).await, refused, "{signing:?}");
    }
    house.issuer.word().signing = Signing::Published;
    assert_eq!(house.name_of(anna()).await.as_deref(), Ok("Anna Weber"));
}

#[tokio::test]
async fn a_key_that_was_changed_is_fetched_once() {
    let house = House::open(json!([{ "everybody": true, "role": "member" }])).await;
    house.name_of(anna()).await.expect("signed in");
    assert_eq!(house.issuer.word().asked_for_keys, 1);
    house.issuer.change_key();
    tokio::time::sleep(Duration::from_millis(1100)).await;
    house.name_of(anna()).await.expect("signed in");
    house.name_of(anna()).await.expect("signed in");
    assert_eq!(house.issuer.word().asked_for_keys, 2);
}

#[tokio::test]
async fn an_answer_belongs_to_one_browser_and_one_question() {
    let house = House::open(json!([{ "everybody": true, "role": "member" }])).await;
    house.issuer.word().claims = anna();
    let (address, cookie) = house.begin(None).await;
    let query = house.issuer.agree(&address);
    let (_, others) = house.begin(None).await;
    let place = async |query: &BTreeMap<String, String>, cookie: &str| {
        let answer = house.come_back(query, cookie).await;
        assert_eq!(session_of(&answer), None);
        answer.header("location").to_owned()
    };
    let with = |name: &str, value: &str| {
        let mut query = query.clone();
        query.insert(name.to_owned(), value.to_owned());
        query
    };
    let without = |name: &str| {
        let mut query = query.clone();
        query.remove(name);
        query
    };
    assert_eq!(place(&query, "").await, "/sign-in?refused=ended");
    assert_eq!(place(&query, &others).await, "/sign-in?refused=ended");
    assert_eq!(
        place(&query, &format!("{cookie}x")).await,
        "/sign-in?refused=ended"
    );
    assert_eq!(
        place(&with("state", "x"), &cookie).await,
        "/sign-in?refused=ended"
    );
    assert_eq!(
        place(&without("state"), &cookie).await,
        "/sign-in?refused=ended"
    );
    assert_eq!(
        place(&without("code"), &cookie).await,
        "/sign-in?refused=denied"
    );
    assert_eq!(
        place(&with("iss", "https://evil.example"), &cookie).await,
        "/sign-in?refused=provider"
    );
    // the right one, once
    let right = house
        .come_back(&with("iss", &house.issuer.address), &cookie)
        .await;
    assert_eq!(right.header("location"), "/");
    assert!(session_of(&right).is_some());
    assert_eq!(place(&query, &cookie).await, "/sign-in?refused=provider");
}

#[tokio::test]
async fn who_is_signed_in_gives_an_identity_to_their_account() {
    let house = House::open(json!([])).await;
    let group = &house.group;
    assert_eq!(
        house.name_of(anna()).await,
        Err("/sign-in?refused=not_admitted".to_owned())
    );
    let linked = house.sign_on(Some(&group.bert)).await;
    assert_eq!(linked.header("location"), "/account");
    assert_eq!(house.name_of(anna()).await.as_deref(), Ok("Bert"));
    // it is Bert's now, and nobody else's
    let taken = house.sign_on(Some(&group.carl)).await;
    assert_eq!(taken.header("location"), "/sign-in?refused=taken");
    let audit = group.get(&group.ada, "/v1/audit").await.text();
    assert!(audit.contains("person.linked") && audit.contains("session.opened"));
}

#[tokio::test]
async fn single_sign_on_begins_on_the_servers_own_page_only() {
    let house = House::open(json!([])).await;
    let lab = &house.group.lab;
    let path = "/v1/sign-in/provider";
    let foreign = [("origin", "https://evil.example"), HOST];
    lab.send(request("POST", path, &foreign, ""))
        .await
        .problem(403, "foreign-origin");
    lab.send(request("POST", path, &[HOST], ""))
        .await
        .problem(403, "foreign-origin");
    let sole = Lab::open().await;
    sole.send(request("POST", path, &[("origin", ORIGIN), HOST], ""))
        .await
        .problem(409, "conflict");
    let group = Group::open().await;
    let answer = request("POST", path, &[("origin", ORIGIN), HOST], "");
    group.lab.send(answer).await.problem(404, "not-found");
}

#[tokio::test]
async fn guessing_answers_is_slowed_down() {
    let house = House::open(json!([])).await;
    let headers = [HOST];
    let path = "/v1/sign-in/provider?code=x&state=y";
    for _ in 0..10 {
        assert_eq!(house.group.lab.get_with(path, &headers).await.status, 303);
    }
    let slow = house.group.lab.get_with(path, &headers).await;
    slow.problem(429, "too-many-guesses");
    assert!(
        slow.header("retry-after")
            .parse::<u32>()
            .is_ok_and(|wait| wait <= 61)
    );
}
