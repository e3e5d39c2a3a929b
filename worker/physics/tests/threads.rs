//! The number of threads changes no bit of any result.
mod scene;

use loadframe_api::{
    Report,
    spec::nonwoven_tensile::{NonwovenTensile, Solver},
};
use loadframe_physics::{Ending, Uninterrupted};
use scene::{Record, polyester, run, run_with, solver};

/// The report of `spec`, the same on any number of threads.
fn same_on_all(spec: &NonwovenTensile) -> Report {
    let (expected, record) = run(spec);
    for threads in [2, 3, 8] {
        let mut other = Record::default();
        let ending = run_with(spec, &mut other, &Uninterrupted, None, threads);
        let Ending::Finished(report) = ending else {
            panic!("{ending:?}")
        };
        assert_eq!(report, expected, "{threads} threads");
        assert!(other.points == record.points, "{threads} threads");
        assert!(other.files == record.files, "{threads} threads");
    }
    expected
}

#[test]
fn results_have_the_same_bits_on_any_number_of_threads() {
    // more nodes and bonds than a chunk of the ordered sums holds
    let mut spec = polyester(25, 31, 3);
    spec.output.snapshot_every_steps = 1;
    for (method, step) in [(Solver::NewtonCg, 0.3), (Solver::Parallel, 0.7)] {
        spec.test.strain_step = step;
        spec.test.max_strain = 3.0 * step;
        spec.accuracy = solver(method, 10.0);
        let report = same_on_all(&spec);
        assert!(report.summary["broken_bonds"].value > Some(0.0));
    }
}

#[test]
fn threads_that_share_one_net_change_no_bit() {
    // some 20 000 nodes: three strips, with grids for its long waves
    let mut spec = polyester(80, 83, 3);
    spec.test.strain_step = 0.02;
    spec.test.max_strain = 0.04;
    spec.accuracy = solver(Solver::NewtonCg, 20.0);
    same_on_all(&spec);
}
