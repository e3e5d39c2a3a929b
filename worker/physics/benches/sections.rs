//! Sections of composites: at rest, in motion beside what the machine's memory gives, until they break, and
//! a unit cell.
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use loadframe_api::{JobKind, JobSpec, Submission};
use loadframe_physics::{Ending, RunContext, Uninterrupted, Unrecorded, simulate};
use serde_json::{Value, json};

/// Steps of the section in motion.
const STEPS: u64 = 200;
/// Least traffic of a particle in a time step [B]: of both axes the displacements now, those before, read
/// and written, loads and inverse masses; a mass; of its cell nine moduli and two hourglass stiffnesses.
/// What a cache keeps is not counted twice.
const TRAFFIC: u64 = 8 * (2 * 5 + 1 + 11);

fn example(name: &str) -> Value {
    let examples = JobKind::ALL.iter().flat_map(|kind| kind.examples());
    let found = examples.into_iter().find(|example| example.name == name);
    let body = found.map(|example| example.body).unwrap_or_default();
    serde_json::from_str(body).unwrap_or_default()
}

fn job(body: &Value) -> JobSpec {
    match Submission::from_slice(body.to_string().as_bytes()) {
        Ok(submission) => submission.spec,
        Err(error) => panic!("{error:?}"),
    }
}

fn run(job: &JobSpec) -> Ending {
    run_on(job, 1)
}

fn run_on(job: &JobSpec, threads: usize) -> Ending {
    let context = RunContext {
        threads,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    match simulate(job, context, &mut Unrecorded) {
        Ok(ending) => ending,
        Err(error) => panic!("{error}"),
    }
}

/// The paper's section on a grid of so many cells along both sides.
fn section(cells: u64) -> Value {
    let mut body = example("composite_bending");
    body["spec"]["grid"] = json!({"cells": [cells, cells]});
    body["spec"]["output"] = json!({"picture": false});
    body
}

/// The same in motion for [`STEPS`] steps.
fn motion(cells: u64) -> Value {
    let mut body = section(cells);
    let step = 1e-9;
    for name in ["filler", "fibre"] {
        body["spec"]["materials"][name]["density_kg_per_m3"] = json!(1500);
    }
    body["spec"]["test"]["history"] = json!({"duration_s": step * STEPS as f64, "points": 2});
    body["spec"]["accuracy"] = json!({"solver": "verlet", "time_step_s": step});
    body
}

fn sections(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sections");
    group.sample_size(10);
    for cells in [100, 200] {
        let job = job(&section(cells));
        group.throughput(Throughput::Elements((cells + 1) * (cells + 1)));
        let name = format!("at rest, {cells} by {cells} cells, with two coarser grids");
        group.bench_function(name, |bencher| bencher.iter(|| run(black_box(&job))));
    }
    let cells = 400;
    let job_in_motion = job(&motion(cells));
    // the job moves half and a quarter of the cells, too
    let particles: u64 = [cells, cells / 2, cells / 4]
        .iter()
        .map(|cells| (cells + 1) * (cells + 1))
        .sum();
    group.throughput(Throughput::Bytes(particles * STEPS * TRAFFIC));
    for threads in [1, 2] {
        let name = format!("in motion, 400 by 400 cells, least traffic, {threads} threads");
        group.bench_function(name, |bencher| {
            bencher.iter(|| run_on(black_box(&job_in_motion), threads));
        });
    }
    for name in ["composite_bending_break", "composite_cell"] {
        let job = job(&example(name));
        group.throughput(Throughput::Elements(1));
        group.bench_function(name, |bencher| bencher.iter(|| run(black_box(&job))));
    }
    group.finish();
}

/// a = b + c d over arrays far larger than any cache: what the memory gives one core.
fn memory(criterion: &mut Criterion) {
    const SIZE: usize = 1 << 24;
    let mut group = criterion.benchmark_group("memory");
    group.sample_size(10);
    let (mut a, b, c) = (vec![0.0; SIZE], vec![1.0; SIZE], vec![2.0; SIZE]);
    // the written array is read first
    group.throughput(Throughput::Bytes(4 * 8 * SIZE as u64));
    group.bench_function("triad", |bencher| {
        bencher.iter(|| {
            for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
                *a = b + 3.0 * c;
            }
            black_box(&a);
        });
    });
    group.finish();
}

criterion_group!(benches, sections, memory);
criterion_main!(benches);
