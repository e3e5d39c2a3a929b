//! A server that is measured, and what its clients do.
#![allow(dead_code, reason = "each bench uses its part")]
pub(crate) mod turns;

use std::path::Path;
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use futures_util::future::join_all;
use loadframe_api::people::{Acceptance, NewInvitation, NewToken, Role, Scope};
use loadframe_api::worker::{ClaimRequest, CompleteRequest, LEASE_TOKEN_HEADER, Lease};
use loadframe_api::{Cost, FileEntry, JobKind, Outcome, OutcomeStatus, Provenance, sha256_hex};
use loadframe_server::store::people::Actor;
use loadframe_server::store::{DatabasePlace, Store, StoreOptions};
use loadframe_server::{ServeConfig, serve};
use reqwest::{Client, Method, RequestBuilder, StatusCode};
use tempfile::TempDir;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;
use uuid::Uuid;

/// Clients or workers at once.
const CLIENTS: u64 = 16;

/// A server on a free port, and a client of it.
pub(crate) struct Server {
    address: String,
    client: Client,
    /// Tokens of a person and of the workers, where there are accounts.
    tokens: Option<[String; 2]>,
    pub(crate) runtime: Runtime,
    /// Dropped, it ends the server, which runs in a thread of its own.
    shutdown: Option<oneshot::Sender<()>>,
    serving: Option<JoinHandle<()>>,
    _folder: TempDir,
}

impl Server {
    /// A server of one person, who needs no token.
    pub(crate) fn start() -> Self {
        Self::begin(false, |_| DatabasePlace::Folder)
    }

    /// The same, its database at the place that is told for its folder.
    pub(crate) fn on(database: fn(&Path) -> DatabasePlace) -> Self {
        Self::begin(false, database)
    }

    /// A server with accounts. Its jobs are those of a member of ten groups.
    pub(crate) fn with_accounts() -> Self {
        Self::begin(true, |_| DatabasePlace::Folder)
    }

    fn begin(has_accounts: bool, database: fn(&Path) -> DatabasePlace) -> Self {
        let folder = match std::env::var_os("QUEUE_BENCH_DATA") {
            Some(parent) => TempDir::new_in(parent),
            None => TempDir::new_in(env!("CARGO_TARGET_TMPDIR")),
        }
        .expect("a folder");
        let runtime = Runtime::new().expect("a runtime");
        let mut config = ServeConfig {
            listen: "127.0.0.1:0".to_owned(),
            ..ServeConfig::new(folder.path())
        };
        config.store.database = database(folder.path());
        let tokens = has_accounts.then(|| runtime.block_on(accounts(folder.path())));
        let (tell, told) = mpsc::channel();
        let (shutdown, stop) = oneshot::channel();
        let handle = runtime.handle().clone();
        let serving = thread::spawn(move || {
            let ready = move |address| tell.send(address).expect("somebody waits");
            let stop = async { drop(stop.await) };
            handle
                .block_on(serve(config, ready, stop))
                .expect("a server");
        });
        let address = told.recv().expect("the server starts");
        Self {
            address: format!("http://{address}"),
            client: client(),
            tokens,
            runtime,
            shutdown: Some(shutdown),
            serving: Some(serving),
            _folder: folder,
        }
    }

    /// A request of the person who submits.
    pub(crate) fn as_person(&self, method: Method, path: &str) -> RequestBuilder {
        self.request(method, path, self.tokens.as_ref().map(|[person, _]| person))
    }

    fn as_worker(&self, method: Method, path: &str) -> RequestBuilder {
        self.request(method, path, self.tokens.as_ref().map(|[_, worker]| worker))
    }

    fn request(&self, method: Method, path: &str, token: Option<&String>) -> RequestBuilder {
        let request = self
            .client
            .request(method, format!("{}{path}", self.address));
        match token {
            Some(token) => request.bearer_auth(token),
            None => request,
        }
    }

    pub(crate) fn under(&self, lease: &Lease, method: Method, path: &str) -> RequestBuilder {
        let path = format!("/v1/worker/leases/{}{path}", lease.id);
        let request = self.as_worker(method, &path);
        request.header(LEASE_TOKEN_HEADER, lease.token.to_string())
    }

    pub(crate) async fn submit(&self) {
        let body = JobKind::NonwovenTensile.examples()[2].body;
        let request = self.as_person(Method::POST, "/v1/jobs").body(body);
        let request = request.header("content-type", "application/json");
        let answer = request.send().await.expect("an answer");
        assert_eq!(answer.status(), StatusCode::CREATED);
    }

    pub(crate) async fn claim(&self, wait_s: f64) -> Option<Lease> {
        let claim = ClaimRequest {
            wait_s,
            ..ClaimRequest::new(Uuid::new_v4(), "bench", "bench", "bench")
        };
        let request = self
            .as_worker(Method::POST, "/v1/worker/claims")
            .json(&claim);
        let answer = request.send().await.expect("an answer");
        match answer.status() {
            StatusCode::NO_CONTENT => None,
            status => {
                assert_eq!(status, StatusCode::OK);
                Some(answer.json().await.expect("a lease"))
            }
        }
    }

    /// Claims a job, uploads its outcome and completes it.
    pub(crate) async fn cycle(&self) {
        let lease = self.claim(0.0).await.expect("a job");
        self.finish(&lease).await;
    }

    /// Says that a worker lives.
    pub(crate) async fn heartbeat(&self, lease: &Lease) {
        let request = self.under(lease, Method::POST, "/heartbeat");
        let answer = request.send().await.expect("an answer");
        assert_eq!(answer.status(), StatusCode::OK);
    }

    /// Uploads the outcome of a job and completes it.
    pub(crate) async fn finish(&self, lease: &Lease) {
        let outcome = outcome(lease);
        let text = serde_json::to_vec(&outcome).expect("JSON");
        let sha256 = sha256_hex(&text);
        let path = format!("/files/outcome.json?sha256={sha256}");
        let upload = self.under(lease, Method::PUT, &path).body(text);
        let answer = upload.send().await.expect("an answer");
        assert_eq!(answer.status(), StatusCode::OK);
        let file: FileEntry = answer.json().await.expect("an entry");
        let request = CompleteRequest {
            outcome,
            files: vec![file],
        };
        let complete = self.under(lease, Method::POST, "/complete").json(&request);
        let answer = complete.send().await.expect("an answer");
        assert!(answer.status().is_success());
    }

    /// The page of the newest 200 jobs.
    pub(crate) async fn list(&self) {
        let request = self.as_person(Method::GET, "/v1/jobs?limit=200");
        let answer = request.send().await.expect("an answer");
        assert_eq!(answer.status(), StatusCode::OK);
        let page: Listed = answer.json().await.expect("a page");
        assert_eq!(page.items.len(), 200);
    }

    /// Does `work` `total` times, by `CLIENTS` at once.
    pub(crate) fn together(&self, total: u64, work: impl AsyncFn()) -> Duration {
        self.runtime.block_on(async {
            let start = Instant::now();
            join_all((0..CLIENTS).map(async |client| {
                let share = total / CLIENTS + u64::from(client < total % CLIENTS);
                for _ in 0..share {
                    work().await;
                }
            }))
            .await;
            start.elapsed()
        })
    }
}

/// A page of jobs, of which the client, in the same process, keeps nothing: the server is measured.
#[derive(serde::Deserialize)]
struct Listed {
    items: Vec<serde::de::IgnoredAny>,
}

/// Makes the data folder a group's; the tokens of a member of ten groups and of the workers.
async fn accounts(data: &Path) -> [String; 2] {
    const PASSWORD: &str = "a password for benches";
    let store = Store::open_beside(StoreOptions::new(data))
        .await
        .expect("a store");
    let store = store.acting(Actor::shell());
    let first = store.create_first_administrator("Ada", PASSWORD).await;
    first.expect("an administrator");
    let mut groups = Vec::new();
    for number in 0..10 {
        let group = store.create_group(&format!("Group {number}")).await;
        groups.push(group.expect("a group").id);
    }
    let invitation = store.invite(NewInvitation {
        role: Role::Member,
        groups,
        days: 1,
        email: None,
    });
    let invitation = invitation.await.expect("an invitation");
    let (_, secret) = invitation.path.split_once('#').expect("a secret");
    let anna = store.accept_invitation(Acceptance {
        secret: secret.to_owned(),
        name: "Anna".to_owned(),
        password: PASSWORD.to_owned(),
    });
    let anna = anna.await.expect("an account").id;
    let token = async |person, scope| {
        let name = "bench".to_owned();
        let days = None;
        let made = store.create_token(person, NewToken { name, scope, days });
        made.await.expect("a token").secret
    };
    [
        token(Some(anna), Scope::Submit).await,
        token(None, Scope::Worker).await,
    ]
}

/// A client that trusts nobody, and so reads no certificates.
fn client() -> Client {
    let _ = rustls::crypto::ring::default_provider().install_default();
    let client = Client::builder().tls_certs_only([]).build();
    client.expect("a client")
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.shutdown.take());
        if let Some(serving) = self.serving.take() {
            serving.join().expect("the server ends in order");
        }
    }
}

fn outcome(lease: &Lease) -> Outcome {
    Outcome {
        kind: lease.kind,
        status: OutcomeStatus::Succeeded,
        stop_reason: "max_strain".to_owned(),
        summary: Default::default(),
        quality: Default::default(),
        cost: Cost::default(),
        provenance: Provenance {
            spec_sha256: lease.spec_sha256.clone(),
            engine_version: "bench".to_owned(),
            engine_commit: "bench".to_owned(),
            seed: 1,
            threads: 1,
            // of its own for every job, so that no file is stored already
            started_at: lease.id.to_string(),
            host: "bench".to_owned(),
        },
        warnings: Vec::new(),
        bodies: Vec::new(),
        files: Vec::new(),
    }
}
