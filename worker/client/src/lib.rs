//! Speaks HTTP with a loadframe server, for the worker and for the commands.
pub mod direct;

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use loadframe_api::Problem;
use reqwest::header::{HeaderMap, RETRY_AFTER};
use reqwest::{Certificate, Method, RequestBuilder, Response, StatusCode, Url};
use serde::de::DeserializeOwned;

/// A server on the same network answers a connection at once or not at all.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// A connection that was not used for so long is not used again: the server ends it a little later.
const IDLE: Duration = Duration::from_secs(60);

/// Another server, which signed addresses lead to, may say nothing for so long within an answer.
const SILENCE: Duration = Duration::from_secs(60);

/// What asks for a longer pause than this waits no longer.
const LONGEST_ASKED: Duration = Duration::from_secs(60);

/// A server and how to speak with it; clones share connections.
#[derive(Clone, Debug)]
pub struct ServerClient {
    base: Url,
    token: Option<String>,
    http: reqwest::Client,
    /// For addresses of other servers that this one has signed; made when the first comes.
    elsewhere: Arc<OnceLock<reqwest::Client>>,
    authorities: Option<Vec<u8>>,
}

/// Why the server did not do what it was asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServerError {
    /// `--server` is not an address that can be spoken with, or its certificate cannot be checked.
    #[error("{address:?} is not a server's address: {reason}")]
    Address { address: String, reason: String },
    /// No answer, or one that broke off. Trying again may help.
    #[error("the server at {server} cannot be reached: {reason}")]
    Unreachable { server: String, reason: String },
    /// The server cannot answer now. Trying again may help, when it has said how soon not before that.
    #[error("the server is not able to answer: {problem}")]
    Unavailable {
        problem: Problem,
        retry_after: Option<Duration>,
    },
    /// A proxy before the server has no answer from it. Trying again may help.
    #[error("the proxy before the server has no answer from it: {problem}")]
    Gateway {
        problem: Problem,
        retry_after: Option<Duration>,
    },
    /// The lease is not held any more: another worker may have the job.
    #[error("the lease is lost")]
    LeaseLost,
    /// Trying again would not help.
    #[error("{0}")]
    Refused(Problem),
    /// Another server, such as that of a bucket, did not take what it should.
    #[error("the bucket did not take it: {reason}")]
    Elsewhere { reason: String },
    /// A file of this machine could not be sent or kept.
    #[error("{path} cannot be read or written: {reason}")]
    File { path: String, reason: String },
}

impl ServerError {
    /// Whether the same request may succeed later.
    pub fn is_transient(&self) -> bool {
        matches!(
            self,
            Self::Unreachable { .. }
                | Self::Unavailable { .. }
                | Self::Gateway { .. }
                | Self::Elsewhere { .. }
        )
    }

    /// Whether nothing was heard of the server itself.
    pub fn is_silence(&self) -> bool {
        matches!(self, Self::Unreachable { .. } | Self::Gateway { .. })
    }

    /// How long to wait before the same request is sent again: as long as its sender would by itself, or as
    /// long as was asked for where that is more.
    pub fn pause(&self, own: Duration) -> Duration {
        match self {
            Self::Unavailable { retry_after, .. } | Self::Gateway { retry_after, .. } => {
                let asked = retry_after.unwrap_or_default();
                own.max(asked.min(LONGEST_ASKED))
            }
            _ => own,
        }
    }

    /// What an answer says that is no success.
    fn of_answer(status: StatusCode, retry_after: Option<Duration>, text: &str) -> Self {
        // of the server's own answers every one is a problem; a proxy's is a page for people
        const OF_PROXIES: [StatusCode; 3] = [
            StatusCode::BAD_GATEWAY,
            StatusCode::SERVICE_UNAVAILABLE,
            StatusCode::GATEWAY_TIMEOUT,
        ];
        let told: Result<Problem, _> = serde_json::from_str(text);
        let is_of_proxy = told.is_err() && OF_PROXIES.contains(&status);
        let problem = told.unwrap_or_else(|_| {
            let title = status.canonical_reason().unwrap_or("HTTP error");
            let detail: String = text.chars().take(500).collect();
            Problem::new(status.as_u16(), "http", title, detail)
        });
        if is_of_proxy {
            Self::Gateway {
                problem,
                retry_after,
            }
        } else if status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS {
            Self::Unavailable {
                problem,
                retry_after,
            }
        } else {
            Self::Refused(problem)
        }
    }
}

impl ServerClient {
    /// A client of the server at `address`, such as `http://127.0.0.1:8400`. Servers of `https` are
    /// believed by the certificates that this machine trusts.
    ///
    /// # Errors
    /// When the address is not one of HTTP.
    pub fn new(address: &str, token: Option<String>) -> Result<Self, ServerError> {
        Self::trusting(address, token, None)
    }

    /// The same, believing the certificates in `authorities` (PEM) alone where they are given.
    ///
    /// # Errors
    /// When the address is not one of HTTP, or the certificates cannot be read.
    pub fn trusting(
        address: &str,
        token: Option<String>,
        authorities: Option<&[u8]>,
    ) -> Result<Self, ServerError> {
        let refuse = |reason: String| ServerError::Address {
            address: address.to_owned(),
            reason,
        };
        let base = Url::parse(address).map_err(|error| refuse(error.to_string()))?;
        if !matches!(base.scheme(), "http" | "https") {
            return Err(refuse("it must begin with http:// or https://".to_owned()));
        }
        // a second installation finds the first
        let _ = rustls::crypto::ring::default_provider().install_default();
        let http = reqwest::Client::builder()
            .connect_timeout(CONNECT_TIMEOUT)
            .pool_idle_timeout(IDLE)
            .tcp_nodelay(true)
            .user_agent(concat!("loadframe/", env!("CARGO_PKG_VERSION")));
        let http = match authorities {
            Some(pem) => http.tls_certs_only(certificates(pem).map_err(refuse)?),
            // the machine's own certificates take a moment to read, and some machines have none
            None if base.scheme() == "http" => http.tls_certs_only([]),
            None => http,
        };
        let http = http.build().map_err(|error| refuse(chain(&error)))?;
        Ok(Self {
            base,
            token,
            http,
            elsewhere: Arc::default(),
            authorities: authorities.map(<[u8]>::to_vec),
        })
    }

    /// The address given, without a slash at its end.
    pub fn address(&self) -> &str {
        self.base.as_str().trim_end_matches('/')
    }

    /// A request to `path`, which begins with a slash.
    pub fn request(&self, method: Method, path: &str) -> RequestBuilder {
        let request = self
            .http
            .request(method, format!("{}{path}", self.address()));
        match &self.token {
            Some(token) => request.bearer_auth(token),
            None => request,
        }
    }

    /// Sends a body to an address elsewhere, such as one of a bucket, that the server has signed: without the
    /// token, which is nobody else's. The address does not appear in errors.
    ///
    /// # Errors
    /// [`ServerError::Elsewhere`].
    pub async fn put_elsewhere(
        &self,
        address: &str,
        body: Vec<u8>,
    ) -> Result<Response, ServerError> {
        let failed = |reason| ServerError::Elsewhere { reason };
        let http = match self.elsewhere.get() {
            Some(http) => http,
            None => {
                let http = self.client_for_elsewhere().map_err(failed)?;
                self.elsewhere.get_or_init(|| http)
            }
        };
        let answer = http.put(address).body(body).send().await;
        let answer = answer.map_err(|error| failed(chain(&error.without_url())))?;
        let status = answer.status();
        if status.is_success() {
            return Ok(answer);
        }
        let text = answer.text().await.unwrap_or_default();
        let text: String = text.chars().take(300).collect();
        Err(failed(format!("{status}: {text}")))
    }

    fn client_for_elsewhere(&self) -> Result<reqwest::Client, String> {
        let http = reqwest::Client::builder()
            .connect_timeout(CONNECT_TIMEOUT)
            .read_timeout(SILENCE)
            .pool_idle_timeout(IDLE)
            .tcp_nodelay(true);
        let http = match &self.authorities {
            Some(pem) => http.tls_certs_only(certificates(pem)?),
            None => http,
        };
        http.build().map_err(|error| chain(&error))
    }

    /// Sends a request; every answer but success and "not modified" is an error.
    ///
    /// # Errors
    /// [`ServerError`].
    pub async fn send(&self, request: RequestBuilder) -> Result<Response, ServerError> {
        let answer = request
            .send()
            .await
            .map_err(|error| self.unreachable(&error))?;
        let status = answer.status();
        if status.is_success() || status == StatusCode::NOT_MODIFIED {
            return Ok(answer);
        }
        let retry_after = retry_after(answer.headers());
        let text = answer
            .text()
            .await
            .map_err(|error| self.unreachable(&error))?;
        Err(ServerError::of_answer(status, retry_after, &text))
    }

    /// Sends a request and reads the JSON of its answer.
    ///
    /// # Errors
    /// [`ServerError`].
    pub async fn json<T: DeserializeOwned>(
        &self,
        request: RequestBuilder,
    ) -> Result<T, ServerError> {
        let answer = self.send(request).await?;
        answer
            .json()
            .await
            .map_err(|error| self.unreachable(&error))
    }

    /// An answer that did not come or broke off.
    pub fn unreachable(&self, error: &reqwest::Error) -> ServerError {
        ServerError::Unreachable {
            server: self.address().to_owned(),
            reason: chain(error),
        }
    }
}

/// Seconds, as servers that are busy tell them; a time of day, which some proxies tell, is not looked at.
fn retry_after(headers: &HeaderMap) -> Option<Duration> {
    let seconds = headers.get(RETRY_AFTER)?.to_str().ok()?;
    seconds.trim().parse().ok().map(Duration::from_secs)
}

/// The certificates of a file in PEM.
fn certificates(pem: &[u8]) -> Result<Vec<Certificate>, String> {
    match Certificate::from_pem_bundle(pem) {
        Ok(found) if !found.is_empty() => Ok(found),
        Ok(_) => Err("the file of trusted certificates has none in PEM".to_owned()),
        Err(error) => Err(format!(
            "the trusted certificates cannot be read: {}",
            chain(&error)
        )),
    }
}

/// An error with its causes; the outermost one of the HTTP client only repeats the address.
fn chain(error: &reqwest::Error) -> String {
    let causes = std::iter::successors(std::error::Error::source(error), |cause| cause.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    if causes.is_empty() {
        error.to_string()
    } else {
        causes.join(": ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_of_a_proxy_is_no_word_of_the_server() {
        let page = "<html><h1>502 Bad Gateway</h1></html>";
        let own = serde_json::json!({ "type": "/problems/busy", "title": "Busy", "status": 503, "detail": "later" });
        let of = |status, text: &str| ServerError::of_answer(status, None, text);
        for status in [StatusCode::BAD_GATEWAY, StatusCode::SERVICE_UNAVAILABLE] {
            let error = of(status, page);
            assert!(error.is_silence() && error.is_transient(), "{error}");
        }
        let busy = of(StatusCode::SERVICE_UNAVAILABLE, &own.to_string());
        assert!(matches!(busy, ServerError::Unavailable { .. }) && !busy.is_silence());
        // such as a proxy's own word on sizes
        let refused = of(StatusCode::PAYLOAD_TOO_LARGE, page);
        assert!(matches!(refused, ServerError::Refused(_)) && !refused.is_transient());
    }

    #[test]
    fn who_is_asked_to_wait_waits_so_long_and_no_longer_than_a_minute() {
        let second = Duration::from_secs(1);
        let asked = |header: &'static str| {
            let headers = HeaderMap::from_iter([(RETRY_AFTER, header.parse().expect("a value"))]);
            let status = StatusCode::TOO_MANY_REQUESTS;
            ServerError::of_answer(status, retry_after(&headers), "").pause(second)
        };
        assert_eq!(asked("5"), 5 * second);
        assert_eq!(asked("0"), second);
        assert_eq!(asked("86400"), 60 * second);
        assert_eq!(asked("Sat, 28 Nov 2026 20:00:00 GMT"), second);
        assert_eq!(ServerError::LeaseLost.pause(second), second);
    }

    #[test]
    fn only_addresses_of_http_are_taken() {
        let client = ServerClient::new("http://127.0.0.1:8400/", None).expect("a good address");
        assert_eq!(client.address(), "http://127.0.0.1:8400");
        let nobody = ServerClient::trusting("https://lab", None, Some(b"no certificate"));
        let nobody = nobody.expect_err("nobody to trust").to_string();
        assert!(nobody.contains("none in PEM"), "{nobody}");
        for bad in ["127.0.0.1:8400", "ftp://lab", "lab", ""] {
            let refused = ServerClient::new(bad, None);
            assert!(matches!(refused, Err(ServerError::Address { .. })), "{bad}");
        }
    }
}
