//! Repeats are the same tests as alone, on any number of threads and across any suspension.
#![allow(clippy::float_cmp, reason = "copied numbers are exact")]
mod scene;

use loadframe_api::{Report, spec::nonwoven_tensile::NonwovenTensile};
use loadframe_physics::{Ending, Interrupt, RunContext, SimulationError, Uninterrupted, simulate};
use scene::{
    AtLook, Record, assert_same, finished, polyester, run, run_with, suspended_again_and_again,
    value,
};

const REPEATS: u32 = 4;

fn repeated() -> NonwovenTensile {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.05;
    spec.test.repeats = REPEATS;
    spec.output.snapshot_every_steps = 8;
    spec.output.force_distribution_strains = vec![0.1];
    spec
}

/// Repeat number `index` as a job of its own.
fn alone(index: u64) -> (Report, Record) {
    let mut spec = repeated();
    spec.test.repeats = 1;
    spec.seed += index;
    run(&spec)
}

#[test]
fn results_are_means_of_the_tests_alone_with_their_scatter() {
    let (report, record) = run(&repeated());
    let singles: Vec<(Report, Record)> = (0..u64::from(REPEATS)).map(alone).collect();
    let forces: Vec<f64> = singles
        .iter()
        .map(|(report, _)| value(report, "max_force"))
        .collect();
    let mean = forces.iter().sum::<f64>() / 4.0;
    let squares: f64 = forces.iter().map(|force| (force - mean).powi(2)).sum();
    let deviation = (squares / 3.0).sqrt();
    let force = &report.summary["max_force"];
    // Student's t of three degrees of freedom is 3.18245, and √4 = 2
    let interval = force.interval.expect("repeats scatter");
    let half = 3.182_446 * deviation / 2.0;
    assert!((value(&report, "max_force") - mean).abs() < 1e-12 * mean);
    assert!((force.deviation.expect("repeats scatter") - deviation).abs() < 1e-9 * deviation);
    assert!((interval[0] - (mean - half)).abs() < 1e-6 * half);
    assert!((interval[1] - (mean + half)).abs() < 1e-6 * half);
    assert_eq!(force.n, Some(REPEATS));
    assert!(deviation > 0.0, "seeds differ");

    // curve and tables are those of the first repeat
    let (_, first) = &singles[0];
    assert_eq!(record.points, first.points);
    for (name, bytes) in &first.files {
        assert!(*bytes == record.files[name], "{name} differs");
    }
    assert!(record.fractions.is_sorted() && record.fractions.last() == Some(&1.0));

    let rows = record.table("repeats.csv");
    let header = String::from_utf8_lossy(&record.files["repeats.csv"]).into_owned();
    assert!(header.starts_with("repeat,seed,max_force_n,strain_at_max_force,strength_n_per_m,"));
    let curves = record.table("repeats_curves.csv");
    for (index, (single, single_record)) in singles.iter().enumerate() {
        let number = (index + 1) as f64;
        assert_eq!(
            rows[index][..3],
            [number, number, value(single, "max_force")]
        );
        let curve = curves.iter().filter(|row| row[0] == number);
        let forces: Vec<f64> = curve.map(|row| row[2]).collect();
        assert_eq!(forces, single_record.column("force_n"));
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let expected = run(&repeated());
    for threads in [2, 3, 8] {
        let mut record = Record::default();
        let report = finished(run_with(
            &repeated(),
            &mut record,
            &Uninterrupted,
            None,
            threads,
        ));
        assert_eq!(report.work, expected.0.work);
        assert_same(&expected, &(report, record));
    }
}

#[test]
fn suspended_repeats_end_with_the_same_bytes() {
    let spec = repeated();
    let expected = run(&spec);
    for threads in [1, 3] {
        for looks in [5, 40, 150] {
            let (report, record) = suspended_again_and_again(&spec, looks, threads);
            assert_same(&expected, &(report, record));
        }
    }
}

#[test]
fn repeats_go_on_from_a_checkpoint_left_on_the_way() {
    let spec = repeated();
    let expected = run(&spec);
    for (threads, looks) in [(1, 60), (1, 200), (2, 90), (3, 200)] {
        let (mut record, checkpoint) = killed_with_a_checkpoint(&spec, looks, threads);
        record.always_checkpoint = false;
        let from = Some(checkpoint.as_slice());
        let report = finished(run_with(&spec, &mut record, &Uninterrupted, from, threads));
        assert_same(&expected, &(report, record));
    }
}

/// Kills a run at a look, and with it what it had not yet written: a run whose checkpoint was not there by
/// then is run again, because threads count looks together and answer when they come to it.
fn killed_with_a_checkpoint(
    spec: &NonwovenTensile,
    looks: u64,
    threads: usize,
) -> (Record, Vec<u8>) {
    for _ in 0..100 {
        let mut record = Record {
            always_checkpoint: true,
            ..Record::default()
        };
        let killed = AtLook::new(Interrupt::Cancel, looks);
        let ending = run_with(spec, &mut record, &killed, None, threads);
        assert!(matches!(ending, Ending::Cancelled), "{ending:?}");
        if let Some(checkpoint) = record.checkpoint.clone() {
            return (record, checkpoint);
        }
    }
    panic!("no checkpoint within {looks} looks of {threads} threads, a hundred times");
}

#[test]
fn a_checkpoint_of_another_spec_is_refused() {
    let mut record = Record::default();
    let interrupt = AtLook::new(Interrupt::Suspend, 20);
    run_with(&repeated(), &mut record, &interrupt, None, 2);
    let mut other = repeated();
    other.test.repeats += 1;
    let context = RunContext {
        threads: 2,
        interrupt: &Uninterrupted,
        checkpoint: record.checkpoint.as_deref(),
    };
    let job = loadframe_api::JobSpec::NonwovenTensile(Box::new(other));
    let result = simulate(&job, context, &mut Record::default());
    assert!(
        matches!(result, Err(SimulationError::Checkpoint(_))),
        "{result:?}"
    );
}

#[test]
fn repeats_that_cannot_differ_say_so() {
    let mut spec = repeated();
    scene::lattice(&mut spec).irregularity = [0.0; 3];
    spec.bond.strength_sigma = 0.0;
    let (report, _) = run(&spec);
    assert_eq!(report.summary["max_force"].deviation, Some(0.0));
    assert!(
        report
            .warnings
            .iter()
            .any(|warning| warning.code == "repeats_alike")
    );
}
