//! Bytes from anybody: whatever a request's target, headers and body are, it has an answer, none that the
//! server failed, and every refusal has the form of a problem.
//!
//! A request is written as in HTTP/1.1 with plain line ends; `{job}` stands for a job that has results.
//! What is none is left out: hyper refuses that before this server sees it. `tests/fuzz` looks further,
//! guided by coverage.
#[cfg(test)]
#[path = "../../../tests/fuzz/mutants.rs"]
mod mutants;

use std::net::SocketAddr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::http::{Method, Request};
use tokio::time::timeout;
use uuid::Uuid;

use crate::support::Lab;

/// What no answer takes, on however busy a machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A server that is open, and one that asks for a token.
pub(crate) struct Labs {
    labs: [Lab; 2],
    job: Uuid,
    requests: AtomicU32,
}

impl Labs {
    pub(crate) async fn open() -> Self {
        let open = Lab::open().await;
        let closed = Lab::with(|config| {
            config.require_token = true;
            config.token = Some("lf_0123456789abcdef".to_owned());
        });
        let job = open.finished(&[("noise.vtp", &[7; 5000])]).await;
        Self {
            labs: [open, closed.await],
            job,
            requests: AtomicU32::new(0),
        }
    }

    /// Sends the bytes to both, if they are a request.
    ///
    /// # Panics
    /// When an answer is not as it should be.
    pub(crate) async fn hold(&self, bytes: &[u8]) {
        for lab in &self.labs {
            let Some(mut request) = self.request(bytes) else {
                return;
            };
            // from everywhere, since guesses at tokens are slowed down by address
            let number = self.requests.fetch_add(1, Ordering::Relaxed);
            let peer = ConnectInfo(SocketAddr::from((number.to_be_bytes(), 40_000)));
            request.extensions_mut().insert(peer);
            let is_head = request.method() == Method::HEAD;
            let shown = String::from_utf8_lossy(bytes);
            let response = timeout(PATIENCE, lab.begin(request)).await;
            let response = response.unwrap_or_else(|_| panic!("no answer to {shown}"));
            let status = response.status().as_u16();
            // 503 and 507 are answers; of others from 500 on nothing else is known than a fault of ours
            assert!(
                status < 500 || matches!(status, 503 | 507),
                "{status} to {shown}"
            );
            if status < 400 {
                continue;
            }
            let answer = timeout(PATIENCE, lab.read(response)).await;
            let answer = answer.unwrap_or_else(|_| panic!("no end of the answer to {shown}"));
            let media_type = answer.header("content-type");
            assert_eq!(
                media_type, "application/problem+json",
                "{status} to {shown}"
            );
            if !is_head {
                assert_eq!(answer.json()["status"], status, "{shown}");
            }
        }
    }

    fn request(&self, bytes: &[u8]) -> Option<Request<Body>> {
        let end = bytes.windows(2).position(|pair| pair == b"\n\n")?;
        let (head, body) = (&bytes[..end], &bytes[end + 2..]);
        let mut lines = head.split(|byte| *byte == b'\n');
        let first = std::str::from_utf8(lines.next()?).ok()?;
        let first = first.replace("{job}", &self.job.to_string());
        let (method, target) = first.split_once(' ')?;
        let mut request = Request::builder().method(method).uri(target);
        for line in lines {
            let colon = line.iter().position(|byte| *byte == b':')?;
            request = request.header(&line[..colon], line[colon + 1..].trim_ascii());
        }
        request.body(Body::from(body.to_vec())).ok()
    }
}

#[cfg(test)]
#[tokio::test]
async fn whatever_comes_has_an_answer_and_none_is_a_fault_of_the_server() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/fuzz/corpus/request");
    let files = mutants::files(std::path::Path::new(folder));
    let labs = Labs::open().await;
    for file in &files {
        assert!(labs.request(file).is_some(), "no request: {file:?}");
    }
    for bytes in mutants::of(&files) {
        labs.hold(&bytes).await;
    }
}
