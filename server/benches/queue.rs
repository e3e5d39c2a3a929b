//! How fast the queue is, over HTTP on loopback and with the disk's own durability: each figure
//! contains everything a user or worker waits for. Clients run in the same process, so the true
//! figures of the server alone are better.
//!
//! Held (issue "lab end to end"): 300 single submits/s, 500 claim+complete/s, 20 000 curve
//! points/s, and p99 from submit to start under 1 s with idle workers. `QUEUE_BENCH_DATA` chooses
//! the folder whose disk is measured.
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use futures_util::future::join_all;
use loadframe_api::worker::{
    ClaimRequest, CompleteRequest, CurveBlock, LEASE_TOKEN_HEADER, Lease, ProgressReport,
    ReleaseReason, ReleaseRequest,
};
use loadframe_api::{Cost, FileEntry, JobKind, Outcome, OutcomeStatus, Provenance, sha256_hex};
use loadframe_server::{ServeConfig, serve};
use reqwest::{Client, Method, RequestBuilder, StatusCode};
use tempfile::TempDir;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;
use uuid::Uuid;

/// Clients or workers at once.
const CLIENTS: u64 = 16;
/// Points a report brings.
const BATCH: u64 = 1000;
/// Submissions whose delay until a worker has them is measured.
const DELAYS: usize = 300;

/// A server on a free port, and a client of it.
struct Server {
    address: String,
    client: Client,
    runtime: Runtime,
    /// Dropped, it ends the server, which runs in a thread of its own.
    shutdown: Option<oneshot::Sender<()>>,
    serving: Option<JoinHandle<()>>,
    _folder: TempDir,
}

impl Server {
    fn start() -> Self {
        let folder = match std::env::var_os("QUEUE_BENCH_DATA") {
            Some(parent) => TempDir::new_in(parent),
            None => TempDir::new_in(env!("CARGO_TARGET_TMPDIR")),
        }
        .expect("a folder");
        let runtime = Runtime::new().expect("a runtime");
        let config = ServeConfig {
            listen: "127.0.0.1:0".to_owned(),
            ..ServeConfig::new(folder.path())
        };
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
            runtime,
            shutdown: Some(shutdown),
            serving: Some(serving),
            _folder: folder,
        }
    }

    fn request(&self, method: Method, path: &str) -> RequestBuilder {
        self.client
            .request(method, format!("{}{path}", self.address))
    }

    fn under(&self, lease: &Lease, method: Method, path: &str) -> RequestBuilder {
        let path = format!("/v1/worker/leases/{}{path}", lease.id);
        let request = self.request(method, &path);
        request.header(LEASE_TOKEN_HEADER, lease.token.to_string())
    }

    async fn submit(&self) {
        let body = JobKind::NonwovenTensile.examples()[2].body;
        let request = self.request(Method::POST, "/v1/jobs").body(body);
        let request = request.header("content-type", "application/json");
        let answer = request.send().await.expect("an answer");
        assert_eq!(answer.status(), StatusCode::CREATED);
    }

    async fn claim(&self, wait_s: f64) -> Option<Lease> {
        let claim = ClaimRequest {
            worker_id: Uuid::new_v4(),
            name: "bench".to_owned(),
            host: "bench".to_owned(),
            threads: 1,
            engine_version: "bench".to_owned(),
            kinds: JobKind::ALL.to_vec(),
            calibration: None,
            memory_mb: None,
            disk_mb: None,
            time_left_s: None,
            wait_s,
        };
        let request = self.request(Method::POST, "/v1/worker/claims").json(&claim);
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
    async fn cycle(&self) {
        let lease = self.claim(0.0).await.expect("a job");
        let outcome = outcome(&lease);
        let text = serde_json::to_vec(&outcome).expect("JSON");
        let sha256 = sha256_hex(&text);
        let path = format!("/files/outcome.json?sha256={sha256}");
        let upload = self.under(&lease, Method::PUT, &path).body(text);
        let answer = upload.send().await.expect("an answer");
        assert_eq!(answer.status(), StatusCode::OK);
        let file: FileEntry = answer.json().await.expect("an entry");
        let request = CompleteRequest {
            outcome,
            files: vec![file],
        };
        let complete = self.under(&lease, Method::POST, "/complete").json(&request);
        let answer = complete.send().await.expect("an answer");
        assert!(answer.status().is_success());
    }

    /// Does `work` `total` times, by `CLIENTS` at once.
    fn together(&self, total: u64, work: impl AsyncFn()) -> Duration {
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

fn submissions(criterion: &mut Criterion) {
    let server = Server::start();
    let mut group = criterion.benchmark_group("submit");
    group.throughput(Throughput::Elements(1)).sample_size(20);
    group.bench_function("one client", |bencher| {
        bencher.iter_custom(|total| {
            server.runtime.block_on(async {
                let start = Instant::now();
                for _ in 0..total {
                    server.submit().await;
                }
                start.elapsed()
            })
        });
    });
    group.bench_function("16 clients", |bencher| {
        bencher.iter_custom(|total| server.together(total, async || server.submit().await));
    });
    group.finish();
}

fn cycles(criterion: &mut Criterion) {
    let server = Server::start();
    let mut group = criterion.benchmark_group("claim, upload, complete");
    group.throughput(Throughput::Elements(1)).sample_size(20);
    group.bench_function("16 workers", |bencher| {
        bencher.iter_custom(|total| {
            server.together(total, async || server.submit().await);
            server.together(total, async || server.cycle().await)
        });
    });
    group.finish();
}

fn points(criterion: &mut Criterion) {
    let server = Server::start();
    let lease = server.runtime.block_on(async {
        server.submit().await;
        server.claim(0.0).await.expect("a job")
    });
    let columns = [
        "nominal_strain",
        "force_n",
        "force_bottom_jaw_n",
        "broken_bonds",
        "residual",
    ];
    let mut first = 0;
    let mut group = criterion.benchmark_group("curve points");
    group
        .throughput(Throughput::Elements(BATCH))
        .sample_size(20);
    group.bench_function("in batches of 1000", |bencher| {
        bencher.iter_custom(|batches| {
            let mut spent = Duration::ZERO;
            for _ in 0..batches {
                let row = |index: u64| {
                    let strain = index as f64 * 1e-4;
                    vec![
                        strain,
                        strain.sin(),
                        strain.cos(),
                        index as f64,
                        strain.sqrt(),
                    ]
                };
                let report = ProgressReport {
                    points: Some(CurveBlock {
                        columns: columns.map(str::to_owned).to_vec(),
                        first,
                        rows: (first..first + BATCH).map(row).collect(),
                    }),
                    ..ProgressReport::default()
                };
                first += BATCH;
                let start = Instant::now();
                let request = server
                    .under(&lease, Method::POST, "/progress")
                    .json(&report);
                let answer = server.runtime.block_on(request.send()).expect("an answer");
                assert_eq!(answer.status(), StatusCode::OK);
                spent += start.elapsed();
            }
            spent
        });
    });
    group.finish();
}

/// From the moment a client sends a job to the moment an idle worker has it. The quantiles are the
/// point, so they are printed beside criterion's mean.
#[allow(
    clippy::print_stderr,
    reason = "the quantiles are what this bench is for"
)]
fn delay(criterion: &mut Criterion) {
    let server = Server::start();
    let once = || {
        server.runtime.block_on(async {
            let start = Instant::now();
            let claims = join_all((0..4).map(async |_| {
                let lease = server.claim(2.0).await?;
                Some((lease, start.elapsed()))
            }));
            let (_, claims) = tokio::join!(server.submit(), async {
                // the other idle workers are let go by further jobs
                let feed = async {
                    for _ in 1..4 {
                        server.submit().await;
                    }
                };
                tokio::join!(claims, feed).0
            });
            let mut delays = Vec::new();
            for (lease, delay) in claims.into_iter().flatten() {
                delays.push(delay);
                let release = ReleaseRequest {
                    reason: ReleaseReason::Cancelled,
                    detail: None,
                };
                let cancel = format!("/v1/jobs/{}/cancel", lease.job_id);
                let _ = server.request(Method::POST, &cancel).send().await;
                let release = server
                    .under(&lease, Method::POST, "/release")
                    .json(&release);
                let answer = release.send().await.expect("an answer");
                assert!(answer.status().is_success());
            }
            delays
        })
    };
    let mut delays: Vec<Duration> = (0..DELAYS / 4).flat_map(|_| once()).collect();
    delays.sort();
    let quantile = |part: f64| delays[((delays.len() - 1) as f64 * part) as usize];
    eprintln!(
        "submit to start with 4 idle workers, {} jobs: median {:?}, p99 {:?}, longest {:?}",
        delays.len(),
        quantile(0.5),
        quantile(0.99),
        quantile(1.0)
    );
    let mut group = criterion.benchmark_group("submit to start");
    group.sample_size(10);
    group.bench_function("idle workers", |bencher| {
        bencher.iter_custom(|rounds| {
            let longest = (0..rounds).map(|_| once().into_iter().max().unwrap_or_default());
            longest.sum()
        });
    });
    group.finish();
}

criterion_group! {
    name = queue;
    config = Criterion::default()
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(8));
    targets = submissions, cycles, points, delay
}
criterion_main!(queue);
