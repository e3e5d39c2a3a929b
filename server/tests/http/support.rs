//! A laboratory for a test: the router over a fresh store, and a worker played by hand. What it does is boxed,
//! for a future is compiled anew, with all that it awaits, in every unit of code that awaits it.
use futures_util::future::BoxFuture;
use std::net::SocketAddr;

use axum::Router;
use axum::body::{Body, Bytes, to_bytes};
use axum::extract::ConnectInfo;
use axum::http::{HeaderMap, Request, Response, header};
use loadframe_api::people::{NewToken, Scope, TokenMade};
use loadframe_api::worker::{ClaimRequest, CompleteRequest, CurveBlock, Lease, ProgressReport};
use loadframe_api::{JobKind, Limits, sha256_hex};
use loadframe_server::ServeConfig;
use loadframe_server::http::{AppState, router};
use loadframe_server::store::{LeaseKey, Store};
use serde_json::Value;
use tempfile::TempDir;
use tower::ServiceExt;
use uuid::Uuid;

use crate::outcome::outcome;

/// Larger answers than any test reads.
const MOST: usize = 64 << 20;

pub(crate) struct Lab {
    pub(crate) store: Store,
    pub(crate) state: AppState,
    pub(crate) router: Router,
    _data: TempDir,
}

/// An answer, read to its end.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Bytes,
}

impl Lab {
    /// An open server on this machine.
    pub(crate) async fn open() -> Self {
        Self::with(|_| {}).await
    }

    /// A server with other settings.
    pub(crate) async fn with(change: impl FnOnce(&mut ServeConfig)) -> Self {
        let data = TempDir::new().expect("a folder");
        let mut config = ServeConfig::new(data.path());
        config.store.database = crate::database::place(data.path());
        change(&mut config);
        Self::of(config, data).await
    }

    fn of(config: ServeConfig, data: TempDir) -> BoxFuture<'static, Self> {
        Box::pin(async move {
            let store = Store::open(config.store.clone()).await.expect("a store");
            let address = config.listen.parse().expect("an address");
            let state = AppState::new(store.clone(), &config, address);
            Self {
                router: router(state.clone()),
                store,
                state,
                _data: data,
            }
        })
    }

    /// Changes what the estimate of a job may reach.
    pub(crate) fn limit(&mut self, change: impl FnOnce(&mut Limits)) {
        change(&mut self.state.limits);
        self.router = router(self.state.clone());
    }

    /// The answer as it comes, for streams.
    pub(crate) fn begin(&self, mut request: Request<Body>) -> BoxFuture<'_, Response<Body>> {
        Box::pin(async move {
            let peer = ConnectInfo(SocketAddr::from(([192, 0, 2, 1], 40_000)));
            request.extensions_mut().get_or_insert(peer);
            let host = "localhost".parse().expect("a header");
            request.headers_mut().entry(header::HOST).or_insert(host);
            let answer = self.router.clone().oneshot(request).await;
            answer.expect("the router answers everything")
        })
    }

    pub(crate) async fn send(&self, request: Request<Body>) -> Answer {
        let response = self.begin(request).await;
        self.read(response).await
    }

    /// An answer read to its end.
    pub(crate) fn read(&self, response: Response<Body>) -> BoxFuture<'_, Answer> {
        Box::pin(async move {
            let (parts, body) = response.into_parts();
            Answer {
                status: parts.status.as_u16(),
                headers: parts.headers,
                body: to_bytes(body, MOST).await.unwrap_or_default(),
            }
        })
    }

    /// A token of nobody in particular.
    pub(crate) fn token(&self, scope: Scope) -> BoxFuture<'_, TokenMade> {
        Box::pin(async move {
            let new = NewToken {
                name: "a token".to_owned(),
                scope,
                days: None,
            };
            self.store.create_token(None, new).await.expect("a token")
        })
    }

    pub(crate) async fn get(&self, path: &str) -> Answer {
        self.send(request("GET", path, &[], "")).await
    }

    pub(crate) async fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        self.send(request("GET", path, headers, "")).await
    }

    pub(crate) async fn post(&self, path: &str, body: &str) -> Answer {
        self.send(request("POST", path, &[JSON], body)).await
    }

    /// Submits the quick example; its id.
    pub(crate) fn submit(&self) -> BoxFuture<'_, Uuid> {
        Box::pin(async move {
            let answer = self.post("/v1/jobs", example()).await;
            assert_eq!(answer.status, 201, "{answer:?}");
            let id = answer.json()["id"].as_str().expect("an id").to_owned();
            id.parse().expect("a UUID")
        })
    }

    /// Claims the next job as a worker would.
    pub(crate) fn claim(&self) -> BoxFuture<'_, Lease> {
        Box::pin(async move {
            let claim = ClaimRequest::new(Uuid::from_u128(7), "by hand", "test", "0");
            let lease = self.store.claim(&claim).await.expect("a claim");
            lease.expect("a job is waiting")
        })
    }

    /// Reports points of a curve with these columns.
    pub(crate) fn report<'a>(
        &'a self,
        lease: &'a Lease,
        first: u64,
        rows: Vec<Vec<f64>>,
    ) -> BoxFuture<'a, ()> {
        Box::pin(async move {
            let report = ProgressReport {
                progress: 0.5,
                phase: "pulling".to_owned(),
                eta_s: Some(1.0),
                points: Some(CurveBlock {
                    columns: vec!["strain".to_owned(), "force_n".to_owned()],
                    first,
                    rows,
                }),
                log: vec!["a line".to_owned()],
                log_from: None,
            };
            let reported = self.store.report(key(lease), &report).await;
            reported.expect("the lease is held");
        })
    }

    /// Submits a job and finishes it with these files beside `outcome.json`; its id.
    pub(crate) async fn finished(&self, files: &[(&str, &[u8])]) -> Uuid {
        let id = self.submit().await;
        self.finish(id, files).await;
        id
    }

    /// Finishes the job that is next with these files beside `outcome.json`.
    pub(crate) fn finish<'a>(
        &'a self,
        id: Uuid,
        files: &'a [(&'a str, &'a [u8])],
    ) -> BoxFuture<'a, ()> {
        Box::pin(async move {
            let lease = self.claim().await;
            assert_eq!(lease.job_id, id);
            self.report(&lease, 0, vec![vec![0.0, 1.0], vec![1.0, 2.5e-7]])
                .await;
            let outcome = outcome(&lease, &[]);
            let text = serde_json::to_string(&outcome).expect("plain data");
            let mut entries = Vec::new();
            for (name, bytes) in files.iter().chain(&[("outcome.json", text.as_bytes())]) {
                let uploaded = self
                    .store
                    .upload(key(&lease), name, &sha256_hex(bytes), *bytes)
                    .await;
                entries.push(uploaded.expect("the lease is held"));
            }
            let complete = CompleteRequest {
                outcome,
                files: entries,
            };
            let completed = self.store.complete(key(&lease), &complete).await;
            completed.expect("the lease is held");
        })
    }
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8(self.body.to_vec()).expect("text")
    }

    pub(crate) fn header(&self, name: &str) -> &str {
        let value = self.headers.get(name).map(|value| value.to_str());
        value.and_then(Result::ok).unwrap_or("")
    }

    /// The problem, having checked its form.
    pub(crate) fn problem(&self, status: u16, slug: &str) -> Value {
        assert_eq!(
            self.status,
            status,
            "{}",
            String::from_utf8_lossy(&self.body)
        );
        assert_eq!(self.header("content-type"), "application/problem+json");
        let problem = self.json();
        assert_eq!(problem["type"], format!("/problems/{slug}"));
        assert_eq!(problem["status"], status);
        assert_ne!(problem["title"], "");
        assert_ne!(problem["detail"], "");
        problem
    }
}

pub(crate) const JSON: (&str, &str) = ("content-type", "application/json");

pub(crate) fn request(
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: &str,
) -> Request<Body> {
    let request = Request::builder().method(method).uri(path);
    let request = headers.iter().fold(request, |request, (name, value)| {
        request.header(*name, *value)
    });
    request
        .body(Body::from(body.to_owned()))
        .expect("a request")
}

/// The body of a job that is done in no time.
pub(crate) fn example() -> &'static str {
    let examples = JobKind::NonwovenTensile.examples();
    let quick = examples
        .iter()
        .find(|example| example.name.ends_with("quick"));
    quick.expect("there is a quick example").body
}

pub(crate) fn key(lease: &Lease) -> LeaseKey {
    LeaseKey {
        id: lease.id,
        token: lease.token,
    }
}
