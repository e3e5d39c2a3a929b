//! The polyester lattice of [Zilka2022] tables 5 and 6: to 10 % strain by each solver, and to
//! rupture.
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use loadframe_api::{
    JobSpec,
    spec::nonwoven_tensile::{Accuracy, Knobs, Solver},
};
use loadframe_physics::{
    Ending, RunContext, Uninterrupted, Unrecorded, calibration_spec, simulate,
};

fn polyester(method: Solver, max_strain: f64) -> JobSpec {
    let JobSpec::NonwovenTensile(mut spec) = calibration_spec() else {
        panic!("the calibration pulls a nonwoven");
    };
    spec.test.max_strain = max_strain;
    spec.accuracy = Accuracy::Knobs(Knobs {
        solver: method,
        ..Knobs::default()
    });
    JobSpec::NonwovenTensile(spec)
}

fn run(job: &JobSpec) -> Ending {
    let context = RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    match simulate(job, context, &mut Unrecorded) {
        Ok(ending) => ending,
        Err(error) => panic!("{error}"),
    }
}

fn tensile(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tensile");
    group.sample_size(10);
    for (name, method, max_strain) in [
        ("newton_cg to 10 %", Solver::NewtonCg, 0.1),
        ("newton_cg to rupture", Solver::NewtonCg, 3.0),
        ("sequential to 10 %", Solver::Sequential, 0.1),
        ("parallel to 10 %", Solver::Parallel, 0.1),
    ] {
        let job = polyester(method, max_strain);
        group.bench_function(name, |bencher| bencher.iter(|| run(black_box(&job))));
    }
    group.finish();
}

criterion_group!(benches, tensile);
criterion_main!(benches);
