//! A run that was suspended, anywhere and any number of times, leaves the same bytes as one that
//! was not.
mod scene;

use loadframe_api::{
    Report,
    spec::nonwoven_tensile::{Breaking, NonwovenTensile, Solver},
};
use loadframe_physics::{
    CheckpointError, Ending, Interrupt, RunContext, SimulationError, Uninterrupted, simulate,
};
use scene::{AtLook, Record, polyester, run, run_with, solver};

fn small(method: Solver) -> NonwovenTensile {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.05;
    spec.accuracy = solver(method, 30.0);
    spec.output.snapshot_every_steps = 4;
    spec
}

/// Suspends at every `looks`-th look until the run ends.
fn run_in_pieces(spec: &NonwovenTensile, looks: u64) -> (Report, Record, usize) {
    let mut record = Record::default();
    let mut checkpoint: Option<Vec<u8>> = None;
    for pieces in 1.. {
        let interrupt = AtLook::new(Interrupt::Suspend, looks);
        match run_with(spec, &mut record, &interrupt, checkpoint.as_deref(), 1) {
            Ending::Finished(report) => return (report, record, pieces),
            Ending::Suspended => checkpoint = record.checkpoint.clone(),
            Ending::Cancelled => panic!("nobody cancelled"),
        }
    }
    unreachable!("the loop is endless")
}

fn assert_same(expected: &(Report, Record), found: &(Report, Record, usize)) {
    assert_eq!(
        expected.1.files.keys().collect::<Vec<_>>(),
        found.1.files.keys().collect::<Vec<_>>()
    );
    for (name, bytes) in &expected.1.files {
        assert!(*bytes == found.1.files[name], "{name} differs");
    }
    assert_eq!(expected.1.points, found.1.points);
    // work is a cost: what an abandoned equilibrium took is counted twice
    let without_work = |report: &Report| Report {
        work: Default::default(),
        ..report.clone()
    };
    assert_eq!(without_work(&expected.0), without_work(&found.0));
}

#[test]
fn suspended_runs_end_with_the_same_bytes() {
    for method in [Solver::NewtonCg, Solver::Sequential, Solver::Parallel] {
        let spec = small(method);
        let expected = run(&spec);
        for looks in [2, 3, 7, 20] {
            let pieces = run_in_pieces(&spec, looks);
            assert!(pieces.2 > 2, "{method:?} was not suspended");
            assert_same(&expected, &pieces);
        }
    }
}

#[test]
fn a_single_break_at_a_time_resumes_between_its_rounds() {
    let mut spec = small(Solver::NewtonCg);
    spec.test.breaking = Breaking::WeakestFirst;
    let expected = run(&spec);
    assert_same(&expected, &run_in_pieces(&spec, 2));
}

#[test]
fn a_break_that_is_being_looked_for_is_found_all_the_same() {
    let mut spec = small(Solver::NewtonCg);
    spec.bond.modulus_n = Some(100.0);
    spec.bond.friction_modulus_n = 0.0;
    spec.test.strain_step = 0.02;
    for breaking in [Breaking::AllOverStrength, Breaking::WeakestFirst] {
        spec.test.breaking = breaking;
        let expected = run(&spec);
        for looks in [2, 3, 7] {
            let pieces = run_in_pieces(&spec, looks);
            assert!(pieces.2 > 10, "{} pieces", pieces.2);
            assert_same(&expected, &pieces);
        }
    }
}

#[test]
fn an_equilibrium_that_was_abandoned_is_searched_again() {
    // large enough that looks fall into the middle of equilibria
    let mut spec = polyester(15, 17, 3);
    spec.test.max_strain = 0.3;
    spec.test.strain_step = 0.1;
    spec.accuracy = solver(Solver::NewtonCg, 1e6);
    let expected = run(&spec);
    let first = AtLook::new(Interrupt::Suspend, 3);
    let mut record = Record::default();
    let ending = run_with(&spec, &mut record, &first, None, 1);
    assert!(matches!(ending, Ending::Suspended));
    let checkpoint = record.checkpoint.clone();
    let ending = run_with(&spec, &mut record, &Uninterrupted, checkpoint.as_deref(), 1);
    let Ending::Finished(report) = ending else {
        panic!("{ending:?}")
    };
    assert!(report.work["bond_evaluations"] > expected.0.work["bond_evaluations"]);
    assert_same(&expected, &(report, record, 2));
}

#[test]
fn a_run_killed_after_any_checkpoint_can_go_on_from_it() {
    let spec = small(Solver::NewtonCg);
    let expected = run(&spec);
    let mut killed = Record {
        always_checkpoint: true,
        ..Record::default()
    };
    let interrupt = AtLook::new(Interrupt::Cancel, 15);
    let ending = run_with(&spec, &mut killed, &interrupt, None, 1);
    assert!(matches!(ending, Ending::Cancelled));
    let checkpoint = killed.checkpoint.clone();
    match run_with(&spec, &mut killed, &Uninterrupted, checkpoint.as_deref(), 1) {
        Ending::Finished(report) => assert_same(&expected, &(report, killed, 2)),
        ending => panic!("{ending:?}"),
    }
}

#[test]
fn a_checkpoint_of_another_spec_is_refused() {
    let spec = small(Solver::NewtonCg);
    let mut record = Record::default();
    let interrupt = AtLook::new(Interrupt::Suspend, 3);
    run_with(&spec, &mut record, &interrupt, None, 1);
    let other = NonwovenTensile { seed: 2, ..spec };
    let context = RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: record.checkpoint.as_deref(),
    };
    let job = loadframe_api::JobSpec::NonwovenTensile(Box::new(other));
    let result = simulate(&job, context, &mut Record::default());
    let expected = SimulationError::Checkpoint(CheckpointError::OtherSpec);
    assert_eq!(
        result.expect_err("it must be refused").to_string(),
        expected.to_string()
    );
}
