//! An issuer of identities for a test: a provider of OpenID Connect that says what it is told to say.
use std::sync::{Arc, Mutex, MutexGuard};

use axum::extract::{Form, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use loadframe_api::{Timestamp, sha256_hex};
use rcgen::{KeyPair, PKCS_ED25519, PublicKeyData, SigningKey};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use tokio::net::TcpListener;

pub(crate) const CLIENT: &str = "loadframe";
/// Marked, so that it can be looked for.
pub(crate) const CLIENT_SECRET: &str = "marked-client-secret-a81f";

/// How a token is signed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Signing {
    /// By the key that is published.
    Published,
    /// By another key under the same name.
    Other,
    /// Not at all.
    None,
    /// By the client's secret, which a provider and its clients share.
    Secret,
}

#[derive(Debug)]
pub(crate) struct Word {
    key: KeyPair,
    key_id: u32,
    /// Claims of the next token beyond the usual, `null` takes one away.
    pub(crate) claims: Value,
    /// What the issuer adds on being asked.
    pub(crate) more: Value,
    pub(crate) signing: Signing,
    /// The code that is good for the next token, and the challenge of its sign-in.
    code: Option<(String, String)>,
    nonce: String,
    codes: u32,
    /// How often the keys were asked for.
    pub(crate) asked_for_keys: u32,
}

#[derive(Clone, Debug)]
pub(crate) struct Issuer {
    pub(crate) address: String,
    word: Arc<Mutex<Word>>,
}

fn key() -> KeyPair {
    KeyPair::generate_for(&PKCS_ED25519).expect("a key")
}

impl Issuer {
    pub(crate) async fn open() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("an address");
        let address = format!("http://{}", listener.local_addr().expect("an address"));
        let issuer = Self {
            address,
            word: Arc::new(Mutex::new(Word {
                key: key(),
                key_id: 1,
                claims: json!({}),
                more: json!({}),
                signing: Signing::Published,
                code: None,
                nonce: String::new(),
                codes: 0,
                asked_for_keys: 0,
            })),
        };
        let router = Router::new()
            .route("/.well-known/openid-configuration", get(metadata))
            .route("/keys", get(keys))
            .route("/token", post(token))
            .route("/more", get(more))
            .with_state(issuer.clone());
        tokio::spawn(async move { axum::serve(listener, router).await });
        issuer
    }

    pub(crate) fn word(&self) -> MutexGuard<'_, Word> {
        self.word.lock().expect("no test panicked with it")
    }

    /// Signs with another key from now on.
    pub(crate) fn change_key(&self) {
        let mut word = self.word();
        word.key = key();
        word.key_id += 1;
    }

    /// What somebody does at the issuer: the query with which the browser comes back.
    pub(crate) fn agree(&self, address: &str) -> BTreeMap<String, String> {
        let (to, query) = address.split_once('?').expect("a query");
        assert_eq!(to, format!("{}/authorize", self.address));
        let asked: BTreeMap<String, String> = url::form_urlencoded::parse(query.as_bytes())
            .into_owned()
            .collect();
        assert_eq!(asked["response_type"], "code");
        assert_eq!(asked["client_id"], CLIENT);
        assert_eq!(asked["code_challenge_method"], "S256");
        assert_eq!(asked["scope"], "openid profile email");
        let mut word = self.word();
        word.codes += 1;
        let code = format!("marked-code-{}", word.codes);
        word.code = Some((code.clone(), asked["code_challenge"].clone()));
        word.nonce = asked["nonce"].clone();
        BTreeMap::from([
            ("code".to_owned(), code),
            ("state".to_owned(), asked["state"].clone()),
        ])
    }
}

async fn metadata(State(issuer): State<Issuer>) -> Json<Value> {
    let at = |path: &str| format!("{}/{path}", issuer.address);
    Json(json!({
        "issuer": issuer.address, "authorization_endpoint": at("authorize"), "token_endpoint": at("token"),
        "jwks_uri": at("keys"), "userinfo_endpoint": at("more"), "response_types_supported": ["code"],
        "subject_types_supported": ["public"],
        "id_token_signing_alg_values_supported": ["EdDSA", "RS256", "HS256", "none"],
    }))
}

async fn keys(State(issuer): State<Issuer>) -> Json<Value> {
    let mut word = issuer.word();
    word.asked_for_keys += 1;
    let x = URL_SAFE_NO_PAD.encode(word.key.der_bytes());
    Json(
        json!({ "keys": [{ "kty": "OKP", "crv": "Ed25519", "use": "sig", "alg": "EdDSA", "x": x,
        "kid": word.key_id.to_string() }] }),
    )
}

async fn token(
    State(issuer): State<Issuer>,
    Form(given): Form<BTreeMap<String, String>>,
) -> Response {
    let mut word = issuer.word();
    let is_right = word.code.take().is_some_and(|(code, challenge)| {
        // RFC 7636: the challenge is the hash of the verifier
        let hash = sha256_hex(given["code_verifier"].as_bytes());
        let hash: Vec<u8> = (0..32)
            .map(|byte| u8::from_str_radix(&hash[2 * byte..2 * byte + 2], 16).expect("digits"))
            .collect();
        given["code"] == code && URL_SAFE_NO_PAD.encode(hash) == challenge
    });
    if !is_right {
        return (
            StatusCode::BAD_REQUEST,
            Json(json!({ "error": "invalid_grant" })),
        )
            .into_response();
    }
    let now = Timestamp::now().as_millis() / 1000;
    let mut claims = json!({ "iss": issuer.address, "sub": "1", "aud": CLIENT, "iat": now, "exp": now + 60,
        "nonce": word.nonce });
    for (name, value) in word.claims.as_object().expect("claims") {
        claims[name] = value.clone();
    }
    claims
        .as_object_mut()
        .expect("claims")
        .retain(|_, value| !value.is_null());
    let id_token = word.sign(&claims);
    Json(
        json!({ "access_token": "marked-access-token", "token_type": "Bearer", "expires_in": 60,
        "id_token": id_token }),
    )
    .into_response()
}

async fn more(State(issuer): State<Issuer>) -> Json<Value> {
    let word = issuer.word();
    let mut more = word.more.clone();
    more["sub"] = word.claims.get("sub").cloned().unwrap_or(json!("1"));
    Json(more)
}

impl Word {
    fn sign(&self, claims: &Value) -> String {
        let algorithm = match self.signing {
            Signing::Published | Signing::Other => "EdDSA",
            Signing::None => "none",
            Signing::Secret => "HS256",
        };
        let head = json!({ "alg": algorithm, "typ": "JWT", "kid": self.key_id.to_string() });
        let encode = |value: &Value| URL_SAFE_NO_PAD.encode(value.to_string());
        let text = format!("{}.{}", encode(&head), encode(claims));
        let signature = match self.signing {
            Signing::Published => self.key.sign(text.as_bytes()).expect("a signature"),
            Signing::Other => key().sign(text.as_bytes()).expect("a signature"),
            Signing::None => Vec::new(),
            Signing::Secret => {
                use hmac::{KeyInit, Mac};
                let mac = hmac::Hmac::<sha2::Sha256>::new_from_slice(CLIENT_SECRET.as_bytes());
                let mut mac = mac.expect("a key of any length");
                mac.update(text.as_bytes());
                mac.finalize().into_bytes().to_vec()
            }
        };
        format!("{text}.{}", URL_SAFE_NO_PAD.encode(signature))
    }
}
