//! Access tokens.
use std::os::unix::fs::PermissionsExt;

use loadframe_api::people::{NewToken, Scope};
use loadframe_api::{Violation, sha256_hex};
use loadframe_server::access::{Caller, Identity};
use loadframe_server::store::StoreError;
use memchr::memmem;
use uuid::Uuid;

use crate::lab::{LONG, Lab, is_missing};

fn token(scope: Scope) -> NewToken {
    NewToken {
        name: "page".to_owned(),
        scope,
        days: None,
    }
}

async fn caller(lab: &Lab, secret: &str) -> Option<Caller> {
    let hash = sha256_hex(secret.as_bytes());
    let found = lab.caller_by_token(&hash).await.unwrap();
    found.map(|(caller, _)| caller)
}

#[tokio::test]
async fn a_token_is_good_until_it_is_revoked_and_its_secret_is_nowhere() {
    let lab = Lab::open(LONG).await;
    assert!(!lab.has_tokens().await.unwrap());
    let made = lab.create_token(None, token(Scope::Submit)).await.unwrap();
    assert!(made.secret.starts_with("lf_") && made.secret.len() == 46);
    assert!(lab.has_tokens().await.unwrap());
    let known = caller(&lab, &made.secret).await.unwrap();
    assert_eq!(
        (known.identity, known.scope),
        (Identity::Sole, Scope::Submit)
    );
    assert!(caller(&lab, "lf_guess").await.is_none());
    let folder = std::fs::read_dir(lab.folder.path()).unwrap();
    for file in folder
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
    {
        let bytes = std::fs::read(&file).unwrap();
        let found = memmem::find(&bytes, made.secret.as_bytes());
        assert!(found.is_none(), "{}", file.display());
    }

    lab.revoke_token(made.id, None).await.unwrap();
    lab.revoke_token(made.id, None).await.unwrap();
    // at once, whoever revokes it
    assert!(caller(&lab, &made.secret).await.is_none());
    assert!(!lab.has_tokens().await.unwrap());
    let tokens = lab.tokens(None).await.unwrap();
    assert_eq!(tokens.len(), 1);
    assert!(tokens[0].revoked_at.is_some());
    assert!(is_missing(lab.revoke_token(Uuid::new_v4(), None).await));
}

#[tokio::test]
async fn a_workers_token_is_a_workers_and_none_does_everything() {
    let lab = Lab::open(LONG).await;
    let made = lab.create_token(None, token(Scope::Worker)).await.unwrap();
    let known = caller(&lab, &made.secret).await.unwrap();
    assert_eq!(known.identity, Identity::Worker);
    let refused = lab.create_token(None, token(Scope::Everything)).await;
    let Err(StoreError::Refused(violations)) = refused else {
        panic!("{refused:?}")
    };
    let [Violation { pointer, .. }] = violations.as_slice() else {
        panic!("{violations:?}")
    };
    assert_eq!(pointer, "/scope");
}

#[tokio::test]
async fn the_data_are_their_owners_alone() {
    let lab = Lab::open(LONG).await;
    let mode = |path: &std::path::Path| path.metadata().unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(lab.folder.path()), 0o700);
    for name in ["loadframe.db", "loadframe.db-wal", "lock"] {
        assert_eq!(mode(&lab.folder.path().join(name)), 0o600, "{name}");
    }
}
