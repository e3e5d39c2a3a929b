//! Access tokens.
use uuid::Uuid;

use crate::lab::{LONG, Lab, is_missing};

#[tokio::test]
async fn a_token_is_good_until_it_is_revoked_and_its_secret_is_nowhere() {
    let lab = Lab::open(LONG).await;
    assert!(!lab.has_tokens().await.unwrap());
    let token = lab.create_token("page").await.unwrap();
    assert!(token.secret.starts_with("lf_") && token.secret.len() == 46);
    assert!(lab.has_tokens().await.unwrap());
    assert!(lab.check_token(&token.secret).await.unwrap());
    assert!(!lab.check_token("lf_guess").await.unwrap());
    let folder = std::fs::read_dir(lab.folder.path()).unwrap();
    for file in folder
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
    {
        let bytes = std::fs::read(&file).unwrap();
        let found = bytes
            .windows(token.secret.len())
            .any(|text| text == token.secret.as_bytes());
        assert!(!found, "{}", file.display());
    }

    lab.revoke_token(token.id).await.unwrap();
    lab.revoke_token(token.id).await.unwrap();
    assert!(!lab.check_token(&token.secret).await.unwrap());
    assert!(!lab.has_tokens().await.unwrap());
    let tokens = lab.tokens().await.unwrap();
    assert_eq!(tokens.len(), 1);
    assert!(tokens[0].revoked_at.is_some());
    assert!(is_missing(lab.revoke_token(Uuid::new_v4()).await));
}

#[tokio::test]
async fn a_given_secret_becomes_a_token_once_and_stays_revoked() {
    let lab = Lab::open(LONG).await;
    lab.ensure_token("environment", "chosen by the user")
        .await
        .unwrap();
    lab.ensure_token("environment", "chosen by the user")
        .await
        .unwrap();
    assert!(lab.check_token("chosen by the user").await.unwrap());
    let tokens = lab.tokens().await.unwrap();
    assert_eq!(tokens.len(), 1);
    lab.revoke_token(tokens[0].id).await.unwrap();
    lab.ensure_token("environment", "chosen by the user")
        .await
        .unwrap();
    assert!(!lab.check_token("chosen by the user").await.unwrap());
}
