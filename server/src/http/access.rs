//! What callers are known by, held against what is in force; [`super::identify`] asks.
//!
//! On a loopback address a server without people is open to its own machine, by the rules of
//! [`super::origin`]. Everywhere else, and wherever there are people, everything under `/v1` and
//! `/metrics` demands `Authorization: Bearer` or the cookie of a session; the page itself,
//! documentation and health stay readable, for they hold nothing of the users'. What the caller may
//! do then is decided by [`crate::access`].
use std::collections::HashMap;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::http::{HeaderMap, header};
use loadframe_api::sha256_hex;
use tokio::sync::Semaphore;
use uuid::Uuid;

use super::origin::Names;
use crate::ServeConfig;
use crate::access::{Caller, Credential, Guesses, Identity, Pace};
use crate::connections::client;
use crate::single_sign_on::SingleSignOn;

/// What a link's secret begins with.
pub(super) const LINK: &str = "lfs_";
/// Cookie of a session over TLS: bound to this very host, unseen by scripts.
pub(super) const SECURE_COOKIE: &str = "__Host-loadframe";
/// The same within one machine, where there is no TLS.
pub(super) const PLAIN_COOKIE: &str = "loadframe";
/// Passwords hashed at once: each takes 19 MB and tens of milliseconds of a core.
const HASHES_AT_ONCE: usize = 2;
/// An address counts as a visit of a link once in this time.
const VISIT: Duration = Duration::from_secs(3600);
/// Visits remembered; beyond it the old ones are forgotten.
const VISITS: usize = 10_000;

/// Whose requests are counted together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Sender {
    /// All that come with one token or session, from wherever: many workers may be behind one address.
    Credential(Uuid),
    /// Those that come with the secrets that the server was started with.
    Workers,
    Owner,
    /// Nobody's, and visitors of links, by their address (of IPv6, its network).
    Address(IpAddr),
}

impl Sender {
    /// Who sent a request, if that can be told.
    pub(super) fn of(caller: Option<&Caller>, address: Option<IpAddr>) -> Option<Self> {
        let by_address = || address.map(|address| Self::Address(client(address)));
        let Some(caller) = caller else {
            return by_address();
        };
        match (caller.credential, &caller.identity) {
            (Credential::Token(id) | Credential::Session(id) | Credential::Proxy(id), _) => {
                Some(Self::Credential(id))
            }
            (Credential::Local, Identity::Worker) => Some(Self::Workers),
            (Credential::Local, _) => Some(Self::Owner),
            (Credential::Link(_), _) => by_address(),
        }
    }
}

/// How callers are known.
#[derive(Debug)]
pub(crate) struct Access {
    /// The server is open to its own machine as long as there are no people.
    pub(super) is_open: bool,
    pub(super) names: Names,
    /// SHA-256 of the secrets the server was started with: its own, and its workers'.
    pub(super) own: Option<String>,
    pub(super) workers: Option<String>,
    /// Signing in is allowed in the clear over a network.
    pub(super) plain_sign_in: bool,
    pub(super) wrong_tokens: Guesses<IpAddr>,
    pub(super) wrong_passwords: Guesses<Option<IpAddr>>,
    pub(super) wrong_for_account: Guesses<String>,
    /// Requests, by who sends them.
    pub(super) pace: Pace<Sender>,
    /// Heartbeats by themselves: a lease lives by them, whatever else comes too fast with the same token.
    pub(super) heartbeats: Pace<Sender>,
    pub(super) single_sign_on: Option<Arc<SingleSignOn>>,
    pub(super) hashing: Arc<Semaphore>,
    visits: Mutex<HashMap<(Uuid, Option<IpAddr>), Instant>>,
}

impl Access {
    pub(super) fn new(config: &ServeConfig, address: SocketAddr) -> Self {
        let hash =
            |secret: &Option<String>| secret.as_ref().map(|text| sha256_hex(text.as_bytes()));
        Self {
            is_open: !config.require_token && address.ip().is_loopback(),
            names: Names::new(&config.allowed_hosts),
            own: hash(&config.token),
            workers: hash(&config.worker_token),
            plain_sign_in: config.plain_sign_in,
            wrong_tokens: Guesses::default(),
            wrong_passwords: Guesses::default(),
            wrong_for_account: Guesses::default(),
            pace: Pace::new(config.requests_per_s),
            heartbeats: Pace::new(config.requests_per_s),
            single_sign_on: config.single_sign_on.clone(),
            hashing: Arc::new(Semaphore::new(HASHES_AT_ONCE)),
            visits: Mutex::default(),
        }
    }

    /// Whether the server answers its own machine only.
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Whether requests need a token that the server was not started with.
    pub(crate) fn needs_tokens(&self) -> bool {
        !self.is_open && self.own.is_none()
    }

    /// The address that a request came from, over a connection with `peer`.
    pub(super) fn client_address(
        &self,
        peer: Option<IpAddr>,
        headers: &HeaderMap,
    ) -> Option<IpAddr> {
        match &self.single_sign_on {
            Some(sign_on) => sign_on.client_address(peer, headers),
            None => peer,
        }
    }

    /// Whether a visit of a link by this address is a new one.
    pub(super) fn is_new_visit(&self, link: Uuid, address: Option<IpAddr>, now: Instant) -> bool {
        let mut visits = self.visits.lock().unwrap_or_else(PoisonError::into_inner);
        if visits.len() >= VISITS {
            visits.retain(|_, since| now.duration_since(*since) < VISIT);
        }
        if visits.len() >= VISITS {
            visits.clear();
        }
        let last = visits.get(&(link, address));
        let is_new = last.is_none_or(|since| now.duration_since(*since) >= VISIT);
        if is_new {
            visits.insert((link, address), now);
        }
        is_new
    }
}

/// Whether two hashes are the same, in a time that does not tell where they differ.
pub(super) fn is_same(kept: Option<&str>, given: &str) -> bool {
    kept.is_some_and(|kept| {
        let differences = kept
            .bytes()
            .zip(given.bytes())
            .fold(0, |sum, (a, b)| sum | (a ^ b));
        kept.len() == given.len() && differences == 0
    })
}

pub(super) fn is_guarded(path: &str) -> bool {
    path == "/v1" || path.starts_with("/v1/") || path == "/metrics"
}

/// The secret of an `Authorization: Bearer` header.
pub(super) fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, secret) = value.split_once(' ')?;
    let secret = secret.trim();
    (scheme.eq_ignore_ascii_case("bearer") && !secret.is_empty()).then_some(secret)
}

pub(super) fn cookie<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let values = headers.get_all(header::COOKIE).iter();
    let pairs = values
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(';'));
    let mut pairs = pairs.filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(key, _)| *key == name).map(|(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cookies_are_found_by_their_whole_name() {
        let mut headers = HeaderMap::new();
        let value = "theme=dark; loadframe=b; __Host-loadframe=a=; x";
        headers.insert(header::COOKIE, value.parse().expect("a header"));
        assert_eq!(cookie(&headers, SECURE_COOKIE), Some("a="));
        assert_eq!(cookie(&headers, PLAIN_COOKIE), Some("b"));
        assert_eq!(cookie(&headers, "frame"), None);
    }

    #[test]
    fn hashes_are_the_same_or_not() {
        assert!(is_same(Some("abc"), "abc"));
        for (kept, given) in [
            (Some("abc"), "abd"),
            (Some("abc"), "ab"),
            (Some(""), "a"),
            (None, ""),
        ] {
            assert!(!is_same(kept, given), "{kept:?} {given}");
        }
    }
}
