//! How fast the queue is, over HTTP on loopback and with the disk's own durability: each figure
//! contains everything a user or worker waits for. Clients run in the same process, so the true
//! figures of the server alone are better.
//!
//! Held (issue "lab end to end"): 300 single submits/s, 500 claim+complete/s, 20 000 curve
//! points/s, and p99 from submit to start under 1 s with idle workers. `QUEUE_BENCH_DATA` chooses
//! the folder whose disk is measured.
mod lab;

use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use futures_util::future::join_all;
use loadframe_api::worker::{CurveBlock, ProgressReport, ReleaseReason, ReleaseRequest};
use reqwest::{Method, StatusCode};

use lab::Server;

/// Points a report brings.
const BATCH: u64 = 1000;
/// Submissions whose delay until a worker has them is measured.
const DELAYS: usize = 300;

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
                let _ = server.as_person(Method::POST, &cancel).send().await;
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
