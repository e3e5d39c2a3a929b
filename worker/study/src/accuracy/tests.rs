//! Studies of a small fabric from end to end.
use std::path::Path;

use loadframe_api::{JobKind, JobSpec, Submission};
use serde_json::{Value, json};

use super::*;
use crate::{Design as _, Findings, StudyEnd, StudyOptions, run};
use loadframe_run::{Engine, StopCause, StopSwitch};

const ENGINE: Engine = Engine {
    version: "1.2.3",
    commit: "abc",
};

/// The quick example with fewer points: done in hundredths of a second.
fn small() -> JobSpec {
    let body = JobKind::NonwovenTensile.examples()[1].body;
    let mut body: Value = serde_json::from_str(body).expect("an example");
    let lattice = &mut body["spec"]["fabric"]["lattice"];
    (lattice["points_per_row"], lattice["rows"]) = (json!(6), json!(7));
    body["spec"]["test"] = json!({"strain_step": 0.05, "max_strain": 3.0, "repeats": 7});
    let submission = Submission::from_slice(body.to_string().as_bytes());
    submission.expect("a valid job").spec
}

fn request(knob: &str, values: &[&str]) -> Request {
    Request {
        knob: knob.to_owned(),
        values: values.iter().map(|value| (*value).to_owned()).collect(),
    }
}

fn run_in(folder: &Path, design: &Design, threads: usize) -> StudyEnd<Study> {
    let options = StudyOptions {
        engine: ENGINE,
        threads,
        folder,
        switch: &StopSwitch::default(),
    };
    run(design, options, &mut |_| {}).expect("every test has a result")
}

fn finished(end: StudyEnd<Study>) -> Study {
    match end {
        StudyEnd::Finished(study) => study,
        StudyEnd::Suspended => panic!("nobody stopped it"),
    }
}

fn study(requests: &[Request], threads: usize) -> Study {
    let folder = tempfile::tempdir().expect("a folder");
    let design = Design::new(&small(), requests, 3).expect("a design");
    finished(run_in(folder.path(), &design, threads))
}

/// A study without what depends on the machine and the moment.
fn timeless(mut study: Study) -> Study {
    (study.cpu_s, study.total_cpu_s) = (0.0, 0.0);
    for row in study.knobs.iter_mut().flat_map(|knob| &mut knob.rows) {
        (row.cpu_s, row.time) = (0.0, 0.0);
    }
    study
}

#[test]
fn all_knobs_are_studied_against_references_without_error() {
    let study = study(&[], 2);
    let knobs: Vec<&str> = study.knobs.iter().map(|knob| knob.knob).collect();
    assert_eq!(
        knobs,
        [
            "force_accuracy",
            "solver",
            "strain_step",
            "break_precision",
            "breaking",
            "size"
        ]
    );
    let results: Vec<&String> = study.scatter.keys().collect();
    assert_eq!(
        results,
        [
            "strain_at_max_force",
            "strength",
            "modulus_at_10_percent",
            "poisson_ratio",
            "energy_absorption"
        ]
    );
    for knob in &study.knobs {
        let (reference, others) = knob.rows.split_last().expect("a row at least");
        assert!(reference.is_reference && others.iter().all(|row| !row.is_reference));
        let present = knob.rows.iter().filter(|row| row.is_present).count();
        assert_eq!(present, 1, "{}", knob.knob);
        for row in &knob.rows {
            assert!(row.cpu_s > 0.0 && row.time > 0.0);
            assert_eq!(row.errors.len(), results.len());
        }
        for error in reference.errors.values().flatten() {
            assert_eq!((error.mean, error.size(), error.n), (0.0, 0.0, 3));
        }
        // what is not the reference is not exact
        let is_off = |row: &Row| {
            row.errors
                .values()
                .flatten()
                .any(|error| error.size() > 0.0)
        };
        assert!(others.iter().all(is_off), "{}", knob.knob);
    }
    let accuracy = &study.knobs[0];
    let values: Vec<&str> = accuracy.rows.iter().map(|row| row.value.as_str()).collect();
    assert_eq!(values, ["5", "20", "100", "1e3", "1e4", "1e5"]);
    let modulus = |row: &Row| row.errors["modulus_at_10_percent"].map_or(f64::NAN, |e| e.size());
    // Newton's method misses equilibrium by less than the limit, which is so far apart here
    assert!(modulus(&accuracy.rows[4]) < 0.1 * modulus(&accuracy.rows[0]));
    assert!(study.repeats[0].errors["strength"] > study.repeats[3].errors["strength"]);
}

#[test]
fn errors_are_those_of_the_tests_themselves() {
    let study = study(&[request("force_accuracy", &["5"])], 1);
    let strength = |accuracy: &str, seed: u64| {
        let mut spec = small().single(seed);
        spec.turn("force_accuracy", accuracy).expect("a number");
        let folder = tempfile::tempdir().expect("a folder");
        let options = loadframe_run::DirectoryOptions {
            engine: ENGINE,
            threads: 1,
            checkpoint_every: std::time::Duration::from_secs(3600),
            switch: &StopSwitch::default(),
        };
        let end = loadframe_run::run_to_directory(&spec, folder.path(), options, &mut |_| {});
        match end {
            Ok(loadframe_run::DirectoryEnd::Finished(outcome)) => {
                outcome.summary["strength"].value.expect("it broke")
            }
            end => panic!("{end:?}"),
        }
    };
    let errors = [1, 2, 3].map(|seed| strength("5", seed) / strength("1e5", seed) - 1.0);
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / 3.0).sqrt();
    let error = study.knobs[0].rows[0].errors["strength"].expect("it is known");
    // round-off of a difference of nearly equal numbers
    assert!(
        (error.size() - rms).abs() < 1e-14
            && (error.mean - errors.iter().sum::<f64>() / 3.0).abs() < 1e-14
    );
    let worst = errors
        .iter()
        .fold(0.0, |worst: f64, error| worst.max(error.abs()));
    assert!((error.worst.expect("they compare") - worst).abs() < 1e-14);
}

#[test]
fn threads_change_the_time_only() {
    let requests = [
        request("force_accuracy", &["5", "50"]),
        request("size", &["1.5"]),
    ];
    assert_eq!(timeless(study(&requests, 1)), timeless(study(&requests, 3)));
}

#[test]
fn a_stopped_study_goes_on_with_what_it_has() {
    let folder = tempfile::tempdir().expect("a folder");
    let design = Design::new(&small(), &[request("strain_step", &[])], 3).expect("a design");
    let switch = StopSwitch::default();
    let options = StudyOptions {
        engine: ENGINE,
        threads: 1,
        folder: folder.path(),
        switch: &switch,
    };
    let mut last = None;
    let end = run(&design, options, &mut |progress| {
        if progress.fraction > 0.4 {
            switch.stop(StopCause::Shutdown);
        }
        last = Some(progress);
    });
    assert!(matches!(end, Ok(StudyEnd::Suspended)), "{end:?}");
    let lines = || {
        let text = std::fs::read_to_string(folder.path().join("runs.jsonl")).expect("a file");
        text.lines().map(str::to_owned).collect::<Vec<String>>()
    };
    let before = lines();
    assert!(!before.is_empty() && before.len() < design.settings().tests());
    let study = finished(run_in(folder.path(), &design, 2));
    assert_eq!(lines()[..before.len()], before);
    assert_eq!(lines().len(), design.settings().tests());
    let fresh = tempfile::tempdir().expect("a folder");
    assert_eq!(
        timeless(study),
        timeless(finished(run_in(fresh.path(), &design, 2)))
    );
}

#[test]
fn the_files_have_every_row_and_the_words_name_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let requests = [
        request("force_accuracy", &["5"]),
        request("breaking", &[]),
        request("size", &[]),
    ];
    let design = Design::new(&small(), &requests, 3).expect("a design");
    let study = finished(run_in(folder.path(), &design, 2));
    study.write(folder.path()).expect("a folder to write to");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
    let csv = read("accuracy.csv");
    let settings: usize = study.knobs.iter().map(|knob| knob.rows.len()).sum();
    assert_eq!(
        csv.lines().count(),
        1 + 5 * (settings + study.repeats.len())
    );
    let columns = csv.lines().map(|line| line.split(',').count());
    assert!(columns.into_iter().all(|columns| columns == 13), "{csv}");
    let json: Value = serde_json::from_str(&read("accuracy.json")).expect("JSON");
    assert_eq!(json["seeds"], json!([1, 2, 3]));
    assert_eq!(json["knobs"][1]["rows"][1]["is_reference"], json!(true));
    let svg = read("accuracy.svg");
    assert_eq!(svg.matches("class=\"frame\"").count(), 5);
    // a mark for each setting in each panel, with the present one ringed for each knob
    assert_eq!(svg.matches("<g><title>").count(), 5 * settings);
    assert_eq!(svg.matches("class=\"present\"").count(), 5 * 3);
    let words = study.text();
    for said in [
        "force_accuracy",
        "weakest_first",
        "reference",
        "times the time",
        "repeats",
    ] {
        assert!(words.contains(said), "{words}");
    }
}

#[test]
fn a_finer_value_than_the_kinds_finest_becomes_the_reference() {
    let reference = |knob: &str, values: &[&str]| {
        let design = Design::new(&small(), &[request(knob, values)], 2).expect("a design");
        let labels = design.lines[0]
            .points
            .iter()
            .map(|point| point.label.clone());
        labels.collect::<Vec<String>>()
    };
    assert_eq!(
        reference("force_accuracy", &["1e7", "5"]),
        ["5", "100", "1e7"]
    );
    assert_eq!(
        reference("force_accuracy", &["5", "50"]),
        ["5", "50", "100", "1e5"]
    );
    assert_eq!(
        reference("strain_step", &["0.1", "0.001"]),
        ["0.1", "0.05", "0.001"]
    );
}

#[test]
fn bad_knobs_and_values_are_refused_with_what_there_is() {
    let refused = |request| {
        Design::new(&small(), &[request], 2)
            .expect_err("bad")
            .to_string()
    };
    let message = refused(request("accuracy", &["5"]));
    assert!(
        message.contains("force_accuracy, solver, strain_step, break_precision, breaking, size"),
        "{message}"
    );
    let message = refused(request("solver", &["newton"]));
    assert!(
        message.contains("newton_cg, sequential or parallel"),
        "{message}"
    );
    let message = refused(request("force_accuracy", &["0.5"]));
    assert!(
        message.contains("force_accuracy=0.5") && message.contains("1 … 1e15"),
        "{message}"
    );
}
