//! Who may use the server.
//!
//! On a loopback address the server is open to its own machine. A web page from elsewhere, opened
//! in a browser on that machine, must not drive it: `Host` and `Origin` have to name this machine
//! (no DNS rebinding, no cross-site request). On any other address, or with `--require-token`,
//! everything under `/v1` and `/metrics` demands `Authorization: Bearer`; the page itself,
//! documentation and health stay readable, for they hold nothing of the users'.
use std::collections::HashMap;
use std::net::{IpAddr, SocketAddr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use axum::http::{HeaderMap, HeaderValue, Uri, header, uri::Authority};

use super::problem::{ApiError, FOREIGN_HOST, Result};
use crate::ServeConfig;

/// How requests are admitted.
#[derive(Debug)]
pub(crate) enum Access {
    /// Everybody on this machine, under these names.
    Open { hosts: Vec<String> },
    /// Everybody who has a token.
    Token { wrong_tokens: WrongTokens },
}

impl Access {
    pub(super) fn new(config: &ServeConfig, address: SocketAddr) -> Self {
        if config.require_token || !address.ip().is_loopback() {
            return Self::Token {
                wrong_tokens: WrongTokens::default(),
            };
        }
        let own = ["localhost", "127.0.0.1", "[::1]"].map(str::to_owned);
        let allowed = config.allowed_hosts.iter().map(|host| host.to_lowercase());
        Self::Open {
            hosts: own.into_iter().chain(allowed).collect(),
        }
    }

    /// Whether requests need a token.
    pub(crate) fn demands_token(&self) -> bool {
        matches!(self, Self::Token { .. })
    }
}

pub(super) fn is_guarded(path: &str) -> bool {
    path == "/v1" || path.starts_with("/v1/") || path == "/metrics"
}

/// Refuses requests that were meant for another name or sent by a page of another origin.
pub(super) fn check_names(hosts: &[String], uri: &Uri, headers: &HeaderMap) -> Result<()> {
    let refuse = |what: &str, value: &str| {
        let detail = format!(
            "{what} is {value:?}; an open server answers {} only; `--allow-host` adds a name, `--require-token` opens it by token",
            hosts.join(", ")
        );
        Err(ApiError::new(FOREIGN_HOST, detail))
    };
    let is_known = |host: &str| hosts.iter().any(|known| known.eq_ignore_ascii_case(host));
    let text = |value: &HeaderValue| String::from_utf8_lossy(value.as_bytes()).into_owned();

    // HTTP/2 and proxies put the name into the request's target instead of the header
    let target = uri
        .authority()
        .map(|authority| authority.as_str().to_owned());
    let host = headers.get(header::HOST).map(text);
    for host in target.iter().chain(&host) {
        let authority = host.parse::<Authority>().ok();
        if !authority.is_some_and(|authority| is_known(authority.host())) {
            return refuse("Host", host);
        }
    }
    if target.is_none() && host.is_none() {
        return refuse("Host", "");
    }
    for origin in headers.get_all(header::ORIGIN) {
        let origin = text(origin);
        let name = origin.parse::<Uri>().ok();
        if !name.is_some_and(|uri| uri.host().is_some_and(is_known)) {
            return refuse("Origin", &origin);
        }
    }
    Ok(())
}

/// The secret of an `Authorization: Bearer` header.
pub(super) fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, secret) = value.split_once(' ')?;
    let secret = secret.trim();
    (scheme.eq_ignore_ascii_case("bearer") && !secret.is_empty()).then_some(secret)
}

/// Wrong tokens one address may send in a [`WINDOW`] before it is slowed down.
const FREE_GUESSES: u32 = 10;
const WINDOW: Duration = Duration::from_secs(60);
/// Addresses remembered; beyond it the old ones are forgotten.
const REMEMBERED: usize = 10_000;

/// Wrong tokens by address: how many since when.
#[derive(Debug, Default)]
pub(crate) struct WrongTokens(Mutex<HashMap<IpAddr, (u32, Instant)>>);

impl WrongTokens {
    /// Counts a wrong token; `Err` holds how long the address should wait.
    pub(super) fn count(&self, address: IpAddr, now: Instant) -> Result<(), Duration> {
        let mut seen = self
            .0
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        if seen.len() >= REMEMBERED {
            seen.retain(|_, (_, since)| now.duration_since(*since) < WINDOW);
        }
        if seen.len() >= REMEMBERED {
            seen.clear();
        }
        let (count, since) = seen.entry(address).or_insert((0, now));
        let age = now.duration_since(*since);
        if age >= WINDOW {
            (*count, *since) = (0, now);
        }
        *count += 1;
        if *count <= FREE_GUESSES {
            Ok(())
        } else {
            Err(WINDOW.saturating_sub(age))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_tokens_are_free_until_the_limit_and_again_after_the_window() {
        let wrong_tokens = WrongTokens::default();
        let start = Instant::now();
        let address = IpAddr::from([192, 0, 2, 1]);
        for _ in 0..FREE_GUESSES {
            assert_eq!(wrong_tokens.count(address, start).ok(), Some(()));
        }
        assert_eq!(wrong_tokens.count(address, start).err(), Some(WINDOW));
        assert!(
            wrong_tokens
                .count(IpAddr::from([192, 0, 2, 2]), start)
                .is_ok()
        );
        assert!(wrong_tokens.count(address, start + WINDOW).is_ok());
    }

    #[test]
    fn only_this_machine_is_answered() {
        let hosts = ["localhost", "127.0.0.1", "[::1]"].map(str::to_owned);
        let check = |host: &str, origin: Option<&str>| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, host.parse().expect("a header"));
            if let Some(origin) = origin {
                headers.insert(header::ORIGIN, origin.parse().expect("a header"));
            }
            check_names(&hosts, &Uri::from_static("/v1/jobs"), &headers).is_ok()
        };
        assert!(check("localhost", None));
        assert!(check("LOCALHOST:8400", Some("http://127.0.0.1:5173")));
        assert!(check("[::1]:8400", Some("http://[::1]:8400")));
        assert!(!check("evil.example:8400", None));
        assert!(!check("localhost.evil.example", None));
        assert!(!check("localhost@evil.example", None));
        assert!(!check("", None));
        assert!(!check("localhost", Some("null")));
        assert!(!check("localhost", Some("https://evil.example")));
        assert!(!check("localhost", Some("https://localhost.evil.example")));
    }
}
