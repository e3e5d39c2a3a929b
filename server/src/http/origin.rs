//! Under which name a request was meant for this server, and whose page sent it.
//!
//! A page from elsewhere, opened in a browser, must not drive this server: neither by a name that was
//! made to lead here (DNS rebinding) nor by a request of its own (cross-site request forgery). A page
//! on another port of the same machine is from elsewhere, too.
use axum::http::{HeaderMap, HeaderValue, Method, Uri, header, uri::Authority};

use super::problem::{ApiError, FOREIGN_HOST, FOREIGN_ORIGIN, Result};

/// Names by which an open server is known to its own machine.
const OWN: [&str; 3] = ["localhost", "127.0.0.1", "[::1]"];

/// Names under which a server is known.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    /// Those given with `--allow-host`, in small letters: pages under them are this server's too.
    allowed: Vec<String>,
}

fn text(value: &HeaderValue) -> String {
    String::from_utf8_lossy(value.as_bytes()).into_owned()
}

/// Name and port; the usual port of the scheme is left out.
fn host_and_port(authority: &Authority, usual: &[u16]) -> (String, Option<u16>) {
    let port = authority.port_u16().filter(|port| !usual.contains(port));
    (authority.host().to_ascii_lowercase(), port)
}

impl Names {
    pub(super) fn new(allowed: &[String]) -> Self {
        Self {
            allowed: allowed.iter().map(|host| host.to_lowercase()).collect(),
        }
    }

    fn is_allowed(&self, host: &str) -> bool {
        self.allowed
            .iter()
            .any(|known| known.eq_ignore_ascii_case(host))
    }

    /// Refuses what was meant for another name than those of this machine.
    pub(super) fn check_host(&self, uri: &Uri, headers: &HeaderMap) -> Result<()> {
        // HTTP/2 and proxies put the name into the request's target instead of the header
        let target = uri.authority().map(ToString::to_string);
        let host = headers.get(header::HOST).map(text);
        let given: Vec<&String> = target.iter().chain(&host).collect();
        let is_known = |host: &str| {
            OWN.iter().any(|own| own.eq_ignore_ascii_case(host)) || self.is_allowed(host)
        };
        let foreign = given.iter().find(|host| {
            let authority = host.parse::<Authority>().ok();
            !authority.is_some_and(|authority| is_known(authority.host()))
        });
        match foreign
            .map(|host| host.as_str())
            .or(given.is_empty().then_some(""))
        {
            None => Ok(()),
            Some(host) => {
                let detail = format!(
                    "Host is {host:?}; an open server answers {} only; `--allow-host` adds a name, `--require-token` opens it by token",
                    OWN.map(str::to_owned)
                        .into_iter()
                        .chain(self.allowed.clone())
                        .collect::<Vec<_>>()
                        .join(", ")
                );
                Err(ApiError::new(FOREIGN_HOST, detail))
            }
        }
    }

    /// Refuses what a page of another origin sent: one under another name or port, or a site that the
    /// browser says is not this one.
    pub(super) fn check_origin(
        &self,
        method: &Method,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Result<()> {
        let refuse = |what: &str, value: &str| {
            let detail = format!(
                "{what} is {value:?}: a page of another origin sent this, and only this server's own may"
            );
            Err(ApiError::new(FOREIGN_ORIGIN, detail))
        };
        for origin in headers.get_all(header::ORIGIN) {
            let origin = text(origin);
            if !self.is_own(&origin, uri, headers) {
                return refuse("Origin", &origin);
            }
        }
        let site = headers.get("sec-fetch-site").map(text);
        match site.as_deref() {
            Some(site @ ("cross-site" | "same-site")) if !is_safe(method) => {
                refuse("Sec-Fetch-Site", site)
            }
            _ => Ok(()),
        }
    }

    /// Refuses what does not say by which page it was sent: a cookie comes along by itself.
    pub(super) fn demand_origin(
        &self,
        method: &Method,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Result<()> {
        let site = headers.get("sec-fetch-site").map(text);
        if headers.contains_key(header::ORIGIN) || site.as_deref() == Some("same-origin") {
            return self.check_origin(method, uri, headers);
        }
        let detail =
            "a request with a cookie has to say that this server's own page sent it (`Origin`)";
        Err(ApiError::new(FOREIGN_ORIGIN, detail))
    }

    /// Whether the origin is the address that the request was sent to.
    fn is_own(&self, origin: &str, uri: &Uri, headers: &HeaderMap) -> bool {
        let Ok(origin) = origin.parse::<Uri>() else {
            return false;
        };
        let Some(sender) = origin.authority() else {
            return false;
        };
        if self.is_allowed(sender.host()) {
            return true;
        }
        let usual = match origin.scheme_str() {
            Some("https") => 443,
            _ => 80,
        };
        let host = headers.get(header::HOST).map(text);
        let host = host.and_then(|host| host.parse::<Authority>().ok());
        let target = uri.authority().cloned().or(host);
        target.is_some_and(|target| {
            host_and_port(&target, &[usual]) == host_and_port(sender, &[usual])
        })
    }
}

/// Whether a request of this method changes nothing.
pub(super) fn is_safe(method: &Method) -> bool {
    matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS)
}

/// What is known of the way from the page to here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Over TLS, here or at a proxy before.
    Secure,
    /// In the clear, within this machine.
    Loopback,
    /// In the clear, over a network.
    Plain,
}

/// The way on which the page was loaded that sends this request, by its own `Origin`.
pub(super) fn way(headers: &HeaderMap) -> Way {
    let origin = headers.get(header::ORIGIN).map(text).unwrap_or_default();
    let origin = origin.parse::<Uri>().unwrap_or_default();
    let host = origin.host().unwrap_or("");
    match origin.scheme_str() {
        Some("https") => Way::Secure,
        _ if OWN.contains(&host) => Way::Loopback,
        _ => Way::Plain,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(given: &[(&'static str, &str)]) -> HeaderMap {
        let pair = |(name, value): &(&'static str, &str)| (*name, value.parse().expect("a header"));
        let mut headers = HeaderMap::new();
        for (name, value) in given.iter().map(pair) {
            headers.insert(name, value);
        }
        headers
    }

    const URI: &str = "/v1/jobs";

    #[test]
    fn only_names_of_this_machine_are_answered() {
        let names = Names::new(&["Lab.example".to_owned()]);
        let check = |host: &str| {
            let headers = headers(&[("host", host)]);
            names.check_host(&Uri::from_static(URI), &headers).is_ok()
        };
        for good in [
            "localhost",
            "LOCALHOST:8400",
            "[::1]:8400",
            "lab.example:80",
        ] {
            assert!(check(good), "{good}");
        }
        for bad in [
            "evil.example:8400",
            "localhost.evil.example",
            "localhost@evil.example",
            "",
        ] {
            assert!(!check(bad), "{bad}");
        }
        assert!(
            names
                .check_host(&Uri::from_static(URI), &HeaderMap::new())
                .is_err()
        );
    }

    #[test]
    fn only_the_servers_own_page_may_send() {
        let names = Names::new(&["lab.example".to_owned()]);
        let check = |method: Method, given: &[(&'static str, &str)]| {
            let given = headers(given);
            names
                .check_origin(&method, &Uri::from_static(URI), &given)
                .is_ok()
        };
        let from =
            |host: &str, origin: &str| check(Method::POST, &[("host", host), ("origin", origin)]);
        assert!(from("localhost:8400", "http://localhost:8400"));
        assert!(from("LOCALHOST:8400", "http://localhost:8400"));
        assert!(from("[::1]:8400", "http://[::1]:8400"));
        assert!(from("localhost", "http://localhost:80"));
        assert!(from("lab.org", "https://lab.org:443"));
        // behind a proxy that speaks TLS and another name
        assert!(from("127.0.0.1:8400", "https://lab.example"));
        for origin in [
            "http://localhost:5173",
            "http://127.0.0.1:8400",
            "https://localhost",
            "null",
            "https://evil.example",
            "https://localhost.evil.example:8400",
        ] {
            assert!(!from("localhost:8400", origin), "{origin}");
        }
        let site = |method, site| check(method, &[("host", "localhost"), ("sec-fetch-site", site)]);
        assert!(site(Method::POST, "same-origin") && site(Method::GET, "cross-site"));
        assert!(!site(Method::POST, "same-site") && !site(Method::DELETE, "cross-site"));
    }

    #[test]
    fn a_cookie_alone_says_nothing() {
        let names = Names::default();
        let check = |given: &[(&'static str, &str)]| {
            let given = headers(given);
            names
                .demand_origin(&Method::POST, &Uri::from_static(URI), &given)
                .is_ok()
        };
        assert!(!check(&[("host", "lab")]));
        assert!(!check(&[("host", "lab"), ("sec-fetch-site", "none")]));
        assert!(check(&[("host", "lab"), ("sec-fetch-site", "same-origin")]));
        assert!(check(&[("host", "lab"), ("origin", "http://lab")]));
    }

    #[test]
    fn the_way_is_that_of_the_page() {
        let of = |origin| way(&headers(&[("origin", origin)]));
        assert_eq!(of("https://lab.example"), Way::Secure);
        assert_eq!(of("http://[::1]:8400"), Way::Loopback);
        assert_eq!(of("http://lab.example"), Way::Plain);
        assert_eq!(way(&HeaderMap::new()), Way::Plain);
    }
}
