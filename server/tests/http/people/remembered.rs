//! Callers and projects are remembered between requests, and not a request longer than they hold: whatever
//! process changes them, beside this one on the same database.
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use loadframe_api::Timestamp;
use loadframe_api::people::{NewToken, PersonChanges, ProjectChanges, Scope, Visibility};
use loadframe_server::store::{Clock, Store, StoreOptions};
use uuid::Uuid;

use super::group::{Group, ids, to_job};
use crate::support::{Lab, request};

/// Another process on the same database.
async fn beside(group: &Group) -> Store {
    let known = group.lab.store.options();
    let options = StoreOptions {
        database: known.database.clone(),
        ..StoreOptions::new(&known.data)
    };
    Store::open_beside(options).await.expect("a store beside")
}

#[tokio::test]
async fn what_another_process_revokes_ends_with_the_next_request() {
    let group = Group::open().await;
    let other = beside(&group).await;
    let shared = group
        .project(&group.anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    let job = group.submit(&group.anna, shared).await;
    let path = format!("/v1/jobs/{job}");
    let (token, id) = group.token(&group.bert, Scope::Read).await;
    let (link, link_id) = group.link(&group.anna, to_job(job, false)).await;
    for by in [&token, &group.bert, &link] {
        // remembered by the second one
        for _ in 0..2 {
            assert_eq!(group.get(by, &path).await.status, 200);
        }
    }
    assert_eq!(ids(&group.get(&token, "/v1/jobs").await.json()), [job]);

    other.revoke_token(id, None).await.expect("revoked");
    group
        .get(&token, &path)
        .await
        .problem(401, "sign-in-needed");
    let revoked = other.revoke_share(group.anna.id, false, link_id).await;
    revoked.expect("revoked");
    group.get(&link, &path).await.problem(401, "sign-in-needed");

    // who is in no group any more sees its jobs no more, in the next list already
    let listed = async || ids(&group.get(&group.bert, "/v1/jobs").await.json());
    assert_eq!(listed().await, [job]);
    let removed = other.set_member(group.paper, group.bert.id, false).await;
    removed.expect("removed");
    assert_eq!(listed().await, Vec::<Uuid>::new());
    group
        .get(&group.bert, &path)
        .await
        .problem(404, "not-found");

    // and whose account has ended is nobody
    let leaves = PersonChanges {
        role: None,
        left: Some(true),
    };
    assert_eq!(group.get(&group.carl, "/v1/me").await.status, 200);
    let left = other.change_person(group.carl.id, leaves).await;
    left.expect("left");
    group
        .get(&group.carl, "/v1/me")
        .await
        .problem(401, "sign-in-needed");
}

#[tokio::test]
async fn what_another_process_renames_has_its_new_name_in_the_next_list() {
    let group = Group::open().await;
    let other = beside(&group).await;
    let shared = group
        .project(&group.anna, Visibility::Group, Some(group.paper))
        .await
        .id;
    group.submit(&group.anna, shared).await;
    let (token, _) = group.token(&group.bert, Scope::Read).await;
    let names = async |path: &str| {
        let list = group.get(&token, path).await.json();
        ["owner", "project"].map(|of| list["items"][0][of]["name"].clone())
    };
    for number in 0..3 {
        let name = format!("called {number}");
        let changes = ProjectChanges {
            name: Some(name.clone()),
            ..ProjectChanges::default()
        };
        let renamed = other.change_project(shared, changes).await;
        renamed.expect("renamed");
        // remembered by the second of each
        for path in ["/v1/jobs", "/v1/jobs", "/v1/jobs?sort=/spec/seed"] {
            assert_eq!(names(path).await, ["Anna", &name], "{path}");
        }
    }
}

#[tokio::test]
async fn a_token_ends_at_its_moment_and_its_use_is_written_down_each_minute() {
    const DAY: i64 = 24 * 3_600_000;
    let now = Arc::new(AtomicI64::new(Timestamp::now().as_millis()));
    let clock = Clock::Told(Arc::clone(&now));
    let lab = Lab::with(|config| config.store.clock = clock).await;
    let group = Group::of(lab).await;
    let new = NewToken {
        name: "for a day".to_owned(),
        scope: Scope::Read,
        days: Some(1),
    };
    let made = group.lab.store.create_token(Some(group.anna.id), new).await;
    let made = made.expect("a token");
    let bearer = format!("Bearer {}", made.secret);
    let asks = async || {
        let headers = [("authorization", &*bearer)];
        let sent = request("GET", "/v1/me", &headers, "");
        group.lab.send(sent).await.status
    };
    // it is written down beside the request
    let is_used_at = async |moment: i64| {
        for _ in 0..1000 {
            let tokens = group.lab.store.tokens(Some(group.anna.id)).await;
            let tokens = tokens.expect("tokens");
            let used = tokens.iter().find(|token| token.id == made.id);
            if used.and_then(|token| token.last_used_at) == Some(Timestamp(moment)) {
                return true;
            }
            tokio::time::sleep(std::time::Duration::from_millis(5)).await;
        }
        false
    };
    let first = now.load(Ordering::SeqCst);
    assert_eq!((asks().await, is_used_at(first).await), (200, true));
    let later = first + 61_000;
    now.store(later, Ordering::SeqCst);
    assert_eq!((asks().await, is_used_at(later).await), (200, true));
    // within the minute that is remembered
    now.store(first + DAY - 1, Ordering::SeqCst);
    assert_eq!(asks().await, 200);
    now.store(first + DAY, Ordering::SeqCst);
    assert_eq!(asks().await, 401);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_count_that_many_requests_read_together_is_no_older_than_any_of_them() {
    const READERS: usize = 16;
    const CHANGES: usize = 40;
    let group = Group::open().await;
    let other = beside(&group).await;
    let known = Arc::<AtomicI64>::default();
    let count = |version: u64| i64::try_from(version).expect("a count");
    let mut readers = tokio::task::JoinSet::new();
    for _ in 0..READERS {
        let (store, known) = (group.lab.store.clone(), Arc::clone(&known));
        readers.spawn(async move {
            let mut read = 0;
            while known.load(Ordering::SeqCst) >= 0 {
                let before = known.load(Ordering::SeqCst);
                let version = store.access_version().await.expect("a count");
                assert!(count(version) >= before, "{version} after {before}");
                read += 1;
            }
            read
        });
    }
    // another process changes access, and tells each change that has been made
    for number in 0..CHANGES {
        let is_member = number % 2 == 0;
        let changed = other.set_member(group.paper, group.carl.id, is_member);
        changed.await.expect("changed");
        let version = other.access_version().await.expect("a count");
        assert!(count(version) > known.swap(count(version), Ordering::SeqCst));
    }
    known.store(-1, Ordering::SeqCst);
    while let Some(read) = readers.join_next().await {
        assert!(read.expect("no reader fails") > 0);
    }
}
