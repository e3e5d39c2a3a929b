//! Invitations, signing in, roles, tokens.
use loadframe_api::people::{Role, Scope};
use serde_json::{Value, json};
use uuid::Uuid;

use super::group::{Group, PASSWORD, cookie_of, id_of, ids, sign_in};
use crate::support::{JSON, Lab, example, request};

const ORIGIN: &str = "http://localhost:8400";

#[tokio::test]
async fn nothing_of_one_person_is_lost_when_a_server_becomes_a_groups() {
    let lab = Lab::open().await;
    assert_eq!(lab.get("/v1/me").await.json()["kind"], "sole");
    let keyed = [JSON, ("idempotency-key", "monday")];
    let named = request("POST", "/v1/jobs", &keyed, example());
    let (first, second) = (id_of(&lab.send(named).await.json()), lab.submit().await);
    let group = Group::of(lab).await;
    // a submission that is repeated across it makes no second job, and is nobody else's
    for (by, is_hers) in [(&group.ada, true), (&group.anna, false)] {
        let (name, value) = &by.known_by;
        let headers = [
            (*name, &**value),
            ("origin", "http://localhost"),
            keyed[0],
            keyed[1],
        ];
        let repeated = request("POST", "/v1/jobs", &headers, example());
        let repeated = group.lab.send(repeated).await;
        assert_eq!(repeated.status, 201, "{repeated:?}");
        assert_eq!(id_of(&repeated.json()) == first, is_hers);
    }
    let mine = group.get(&group.ada, "/v1/jobs?whose=mine").await.json();
    assert_eq!(ids(&mine), [second, first]);
    assert_eq!(mine["items"][0]["project"]["name"], "Jobs of Ada");
    // and from now on this machine's own browser is nobody until it signs in
    group
        .lab
        .get("/v1/jobs")
        .await
        .problem(401, "sign-in-needed");
    assert_eq!(group.lab.get("/healthz").await.status, 200);
    let again = group
        .lab
        .store
        .create_first_administrator("Eve", PASSWORD)
        .await;
    assert!(again.is_err());
}

#[tokio::test]
async fn who_is_invited_opens_an_account_once() {
    let group = Group::open().await;
    let invite = async |body: Value| {
        let body = body.to_string();
        group
            .send(&group.ada, "POST", "/v1/invitations", &body)
            .await
    };
    let made = invite(json!({ "role": "member", "groups": [group.paper] })).await;
    assert_eq!(made.status, 201);
    let path = made.json()["path"].as_str().expect("a path").to_owned();
    let (page, secret) = path
        .split_once('#')
        .expect("the secret is no server's to see");
    assert_eq!(page, "/invitation");
    let accept = async |name: &str, password: &str| {
        let body = json!({ "secret": secret, "name": name, "password": password });
        let headers = [("origin", ORIGIN), ("host", "localhost:8400"), JSON];
        let path = "/v1/invitations/accept";
        group
            .lab
            .send(request("POST", path, &headers, &body.to_string()))
            .await
    };
    let pointer = |problem: Value| problem["violations"][0]["pointer"].clone();
    let short = accept("Dora", "short")
        .await
        .problem(422, "invalid-request");
    assert_eq!(pointer(short), "/password");
    let taken = accept("anna", PASSWORD)
        .await
        .problem(422, "invalid-request");
    assert_eq!(pointer(taken), "/name");
    let unseen = accept("An\u{200b}na", PASSWORD)
        .await
        .problem(422, "invalid-request");
    assert_eq!(pointer(unseen), "/name");
    let dora = accept(" Dora ", PASSWORD).await;
    assert_eq!(
        (dora.status, dora.json()["name"].as_str()),
        (201, Some("Dora"))
    );
    let again = accept("Eve", PASSWORD)
        .await
        .problem(422, "invalid-request");
    assert_eq!(pointer(again), "/secret");

    let signed_in = sign_in(&group.lab, ORIGIN, "DORA", PASSWORD).await;
    assert_eq!(signed_in.status, 204, "{signed_in:?}");
    let cookie = cookie_of(&signed_in.headers);
    let me = group
        .lab
        .get_with("/v1/me", &[("cookie", &cookie)])
        .await
        .json();
    assert_eq!(me["person"]["name"], "Dora");
    assert_eq!(me["groups"][0]["name"], "Paper");

    let wrong = invite(json!({ "role": "member", "groups": [Uuid::from_u128(1)] })).await;
    assert_eq!(pointer(wrong.problem(422, "invalid-request")), "/groups/0");
    let old = invite(json!({ "role": "king", "days": 0 }))
        .await
        .problem(422, "invalid-request");
    assert_eq!(old["violations"].as_array().map(Vec::len), Some(2));
    // one that was taken back
    let made = invite(json!({ "role": "guest" })).await.json();
    let path = format!("/v1/invitations/{}", id_of(&made));
    assert_eq!(
        group.send(&group.ada, "DELETE", &path, "").await.status,
        204
    );
    let listed = group.get(&group.ada, "/v1/invitations").await.json();
    assert!(listed["items"][0]["revoked_at"].is_string());
}

#[tokio::test]
async fn signing_in_gives_a_cookie_for_this_host_alone() {
    let group = Group::open().await;
    let plain = sign_in(&group.lab, ORIGIN, "Anna", PASSWORD).await;
    let cookie = plain.header("set-cookie").to_owned();
    assert!(cookie.starts_with("loadframe="), "{cookie}");
    for word in ["HttpOnly", "SameSite=Strict", "Path=/"] {
        assert!(cookie.contains(word), "{cookie}");
    }
    assert!(!cookie.contains("Secure"));
    // a cookie alone changes nothing: the request has to come from this server's own page
    let cookie = cookie_of(&plain.headers);
    let send = async |headers: &[(&str, &str)]| {
        let mut all = vec![("cookie", &*cookie), JSON];
        all.extend(headers);
        group
            .lab
            .send(request("POST", "/v1/jobs", &all, example()))
            .await
    };
    send(&[]).await.problem(403, "foreign-origin");
    send(&[("origin", "http://localhost:9")])
        .await
        .problem(403, "foreign-origin");
    assert_eq!(send(&[("origin", "http://localhost")]).await.status, 201);
    assert_eq!(send(&[("sec-fetch-site", "same-origin")]).await.status, 201);

    let headers = [("cookie", &*cookie), ("origin", "http://localhost")];
    let out = group
        .lab
        .send(request("DELETE", "/v1/sessions/current", &headers, ""))
        .await;
    assert_eq!(out.status, 204);
    let asked = group.lab.get_with("/v1/me", &[("cookie", &cookie)]).await;
    asked.problem(401, "sign-in-needed");
}

#[tokio::test]
async fn over_a_network_passwords_travel_by_https_only() {
    let lab = Lab::with(|config| config.listen = "192.0.2.7:8400".to_owned()).await;
    let group = Group::of(lab).await;
    let clear = sign_in(&group.lab, "http://lab.example", "Anna", PASSWORD).await;
    clear.problem(403, "in-the-clear");
    let signed_in = sign_in(&group.lab, "https://lab.example", "Anna", PASSWORD).await;
    let cookie = signed_in.header("set-cookie").to_owned();
    assert!(
        cookie.starts_with("__Host-loadframe=") && cookie.contains("; Secure;"),
        "{cookie}"
    );
    let secure = cookie_of(&signed_in.headers);
    assert_eq!(
        group
            .lab
            .get_with("/v1/me", &[("cookie", &secure)])
            .await
            .status,
        200
    );
    // a session that travels by TLS is not taken from a cookie that need not
    let moved = secure.replace("__Host-", "");
    let asked = group.lab.get_with("/v1/me", &[("cookie", &moved)]).await;
    asked.problem(401, "sign-in-needed");

    let lab = Lab::with(|config| {
        config.listen = "192.0.2.7:8400".to_owned();
        config.plain_sign_in = true;
    });
    let group = Group::of(lab.await).await;
    let clear = sign_in(&group.lab, "http://lab.example", "Anna", PASSWORD).await;
    assert_eq!(clear.status, 204);
}

#[tokio::test]
async fn guessing_tells_nothing_and_is_slowed_down() {
    let group = Group::open().await;
    let guess =
        async |name: &str, password: &str| sign_in(&group.lab, ORIGIN, name, password).await;
    let wrong = guess("Anna", "not the password")
        .await
        .problem(403, "wrong-password");
    let unknown = guess("Nobody", "not the password")
        .await
        .problem(403, "wrong-password");
    assert_eq!(wrong, unknown);
    for _ in 0..9 {
        let answer = guess("Nobody", "not the password").await;
        assert!([403, 429].contains(&answer.status));
    }
    // even the right password waits, or a guess would be told from it
    let slowed = guess("Anna", PASSWORD).await;
    slowed.problem(429, "too-many-guesses");
    let wait = slowed.header("retry-after").parse::<u32>();
    assert!(wait.is_ok_and(|seconds| seconds <= 61));
}

#[tokio::test]
async fn who_leaves_leaves_everything_to_somebody() {
    let group = Group::open().await;
    let (ada, anna) = (&group.ada, &group.anna);
    let answer = group.send(anna, "POST", "/v1/jobs", example()).await;
    let id = id_of(&answer.json());
    let (token, _) = group.token(anna, Scope::Read).await;
    let person = |id: Uuid, what: &str| format!("/v1/people/{id}{what}");
    let left = json!({ "left": true }).to_string();
    let leaves = group.send(ada, "PATCH", &person(anna.id, ""), &left).await;
    assert!(leaves.json()["left_at"].is_string());
    group
        .get(anna, "/v1/jobs")
        .await
        .problem(401, "sign-in-needed");
    group
        .get(&token, "/v1/jobs")
        .await
        .problem(401, "sign-in-needed");
    let refused = sign_in(&group.lab, ORIGIN, "Anna", PASSWORD).await;
    refused.problem(403, "wrong-password");

    let to_guest = json!({ "to": group.gina.id }).to_string();
    let refused = group
        .send(ada, "POST", &person(anna.id, "/hand-over"), &to_guest)
        .await;
    assert_eq!(
        refused.problem(422, "invalid-request")["violations"][0]["pointer"],
        "/to"
    );
    let to_carl = json!({ "to": group.carl.id }).to_string();
    let handed = group
        .send(ada, "POST", &person(anna.id, "/hand-over"), &to_carl)
        .await;
    assert_eq!(handed.status, 204);
    let job = group
        .get(&group.carl, &format!("/v1/jobs/{id}"))
        .await
        .json();
    assert_eq!(job["owner"]["name"], "Carl");
    // and back again, the account as it was but for its sessions
    let back = json!({ "left": false }).to_string();
    group.send(ada, "PATCH", &person(anna.id, ""), &back).await;
    assert_eq!(
        sign_in(&group.lab, ORIGIN, "Anna", PASSWORD).await.status,
        204
    );
}

#[tokio::test]
async fn the_last_administrator_stays() {
    let group = Group::open().await;
    let path = format!("/v1/people/{}", group.ada.id);
    for change in [json!({ "left": true }), json!({ "role": "member" })] {
        let refused = group
            .send(&group.ada, "PATCH", &path, &change.to_string())
            .await;
        let problem = refused.problem(409, "conflict");
        assert!(
            problem["detail"]
                .as_str()
                .is_some_and(|text| text.contains("last administrator"))
        );
    }
    let role = json!({ "role": Role::Administrator }).to_string();
    let bert = format!("/v1/people/{}", group.bert.id);
    assert_eq!(
        group.send(&group.ada, "PATCH", &bert, &role).await.status,
        200
    );
    let member = json!({ "role": "member" }).to_string();
    assert_eq!(
        group.send(&group.ada, "PATCH", &path, &member).await.status,
        200
    );
    group
        .get(&group.ada, "/v1/audit")
        .await
        .problem(403, "not-allowed");
}

#[tokio::test]
async fn a_password_is_changed_by_who_knows_it() {
    let group = Group::open().await;
    let change = async |current: &str, new: &str| {
        let body = json!({ "current": current, "new": new }).to_string();
        group
            .send(&group.anna, "PUT", "/v1/me/password", &body)
            .await
    };
    change("not the password", "another password")
        .await
        .problem(403, "wrong-password");
    change(PASSWORD, "short")
        .await
        .problem(422, "invalid-request");
    let elsewhere = sign_in(&group.lab, ORIGIN, "Anna", PASSWORD).await;
    let elsewhere = cookie_of(&elsewhere.headers);
    assert_eq!(change(PASSWORD, "another password").await.status, 204);
    // the session that did it goes on, others have ended
    assert_eq!(group.get(&group.anna, "/v1/me").await.status, 200);
    let other = group
        .lab
        .get_with("/v1/me", &[("cookie", &elsewhere)])
        .await;
    other.problem(401, "sign-in-needed");
    let signed_in = sign_in(&group.lab, ORIGIN, "Anna", "another password").await;
    assert_eq!(signed_in.status, 204);
}

#[tokio::test]
async fn tokens_are_made_and_ended_by_their_owner() {
    let group = Group::open().await;
    let make = async |by, body: Value| {
        group
            .send(by, "POST", "/v1/tokens", &body.to_string())
            .await
    };
    let made = make(
        &group.anna,
        json!({ "name": "script", "scope": "read", "days": 1 }),
    )
    .await;
    assert_eq!(made.status, 201);
    let made = made.json();
    let bearer = format!("Bearer {}", made["secret"].as_str().expect("a secret"));
    let ask = async || {
        group
            .lab
            .get_with("/v1/me", &[("authorization", &bearer)])
            .await
    };
    assert_eq!(ask().await.json()["scope"], "read");
    let path = format!("/v1/tokens/{}", id_of(&made));
    group
        .send(&group.bert, "DELETE", &path, "")
        .await
        .problem(404, "not-found");
    assert_eq!(
        ids(&group.get(&group.bert, "/v1/tokens").await.json()),
        Vec::<Uuid>::new()
    );
    let listed = group.get(&group.anna, "/v1/tokens").await;
    assert!(
        !listed
            .text()
            .contains(made["secret"].as_str().expect("a secret"))
    );
    assert_eq!(
        group.send(&group.anna, "DELETE", &path, "").await.status,
        204
    );
    ask().await.problem(401, "sign-in-needed");

    // a worker sees the spec of every job it claims
    let worker = || json!({ "name": "machine", "scope": "worker" });
    make(&group.anna, worker())
        .await
        .problem(403, "not-allowed");
    assert_eq!(make(&group.ada, worker()).await.status, 201);
    let everything = make(&group.ada, json!({ "name": "x", "scope": "everything" })).await;
    everything.problem(422, "invalid-request");
}

#[tokio::test]
async fn a_name_that_nobody_has_takes_as_long_as_a_wrong_password() {
    /// Medians of these are compared.
    const GUESSES: u8 = 3;
    /// Without the comparison against nobody's password it would be a hundredth.
    const ALIKE: f64 = 3.0;
    let group = Group::open().await;
    let median = async |name: &str| {
        let mut times = Vec::new();
        for number in 0..GUESSES {
            let body = json!({ "name": name, "password": format!("not the password {number}") });
            let headers = [("origin", ORIGIN), ("host", "localhost:8400"), JSON];
            let request = request("POST", "/v1/sessions", &headers, &body.to_string());
            let begin = std::time::Instant::now();
            let answer = group.lab.send(request).await;
            times.push(begin.elapsed().as_secs_f64());
            answer.problem(403, "wrong-password");
        }
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    // the first one makes nobody's password
    median("Nobody").await;
    let (known, unknown) = (median("Anna").await, median("Somebody else").await);
    let ratio = known / unknown;
    assert!(
        (1.0 / ALIKE..ALIKE).contains(&ratio),
        "{known} s and {unknown} s"
    );
}
