//! A sign-in that has begun: what the browser keeps of it until it comes back.
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use hmac::{Hmac, KeyInit, Mac};
use loadframe_api::Timestamp;
use rand::Rng;
use serde::{Deserialize, Serialize};
use sha2::Sha256;
use uuid::Uuid;

/// How long somebody may take at the provider [ms].
pub const LONGEST: i64 = 600_000;

/// What must come back, and what is needed then.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Started {
    pub state: String,
    pub nonce: String,
    /// The verifier of PKCE (RFC 7636).
    pub verifier: String,
    /// The person who was signed in when it began: the identity becomes theirs.
    pub person: Option<Uuid>,
    /// When it began [ms since 1970].
    pub since: i64,
}

impl std::fmt::Debug for Started {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Started").finish_non_exhaustive()
    }
}

/// Seals what a browser keeps, so that it comes back as it was given: HMAC-SHA256 (RFC 2104) under a key
/// of this process. The server itself keeps nothing, so there is nothing to fill.
pub struct Seal([u8; 32]);

impl std::fmt::Debug for Seal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Seal").finish_non_exhaustive()
    }
}

impl Default for Seal {
    fn default() -> Self {
        let mut key = [0; 32];
        rand::rng().fill_bytes(&mut key);
        Self(key)
    }
}

impl Seal {
    fn mac(&self, text: &str) -> Option<Hmac<Sha256>> {
        let mut mac = Hmac::<Sha256>::new_from_slice(&self.0).ok()?;
        mac.update(text.as_bytes());
        Some(mac)
    }

    /// As the value of a cookie; nothing where it cannot be written, which does not happen.
    pub fn close(&self, started: &Started) -> Option<String> {
        let text = URL_SAFE_NO_PAD.encode(serde_json::to_vec(started).ok()?);
        let tag = URL_SAFE_NO_PAD.encode(self.mac(&text)?.finalize().into_bytes());
        Some(format!("{text}.{tag}"))
    }

    /// What a cookie holds, if it is this server's and not too old; compared in constant time.
    pub fn open(&self, cookie: &str, now: Timestamp) -> Option<Started> {
        let (text, tag) = cookie.split_once('.')?;
        let tag = URL_SAFE_NO_PAD.decode(tag).ok()?;
        self.mac(text)?.verify_slice(&tag).ok()?;
        let started: Started = serde_json::from_slice(&URL_SAFE_NO_PAD.decode(text).ok()?).ok()?;
        let age = now.as_millis() - started.since;
        (0..=LONGEST).contains(&age).then_some(started)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cookie_is_this_servers_whole_and_young_or_nothing() {
        let started = Started {
            state: "s".to_owned(),
            nonce: "n".to_owned(),
            verifier: "v".to_owned(),
            person: None,
            since: 1000,
        };
        let seal = Seal::default();
        let cookie = seal.close(&started).expect("a cookie");
        let at = |now| seal.open(&cookie, Timestamp(now));
        assert_eq!(at(1000), Some(started.clone()));
        assert_eq!(at(1000 + LONGEST), Some(started));
        assert_eq!(at(1001 + LONGEST), None);
        assert_eq!(at(999), None);
        assert_eq!(Seal::default().open(&cookie, Timestamp(1000)), None);
        let changed = cookie.replacen('e', "f", 1);
        assert_ne!(changed, cookie);
        assert_eq!(seal.open(&changed, Timestamp(1000)), None);
        assert_eq!(seal.open("", Timestamp(1000)), None);
    }
}
