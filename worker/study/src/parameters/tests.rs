//! Studies of parameters of a small fabric and a few grains, from end to end.
use std::path::Path;

use indexmap::IndexMap;
use loadframe_api::Message;
use loadframe_api::study::ParameterStudy;
use loadframe_physics::{Sample, Welch};
use serde_json::{Value, json};

use super::*;
use crate::{Design as _, Findings, StudyEnd, StudyOptions, run};
use loadframe_run::{Engine, StopCause, StopSwitch};

const ENGINE: Engine = Engine {
    version: "1.2.3",
    commit: "abc",
};

/// A fabric done in hundredths of a second, at three strengths and as it is.
fn file() -> Value {
    json!({
        "title": "Strength | of bonds",
        "source": "a rule of proportion",
        "statement": "The force grows with the strength.",
        "seeds": 3,
        "job": {"kind": "nonwoven_tensile", "spec": {
            "version": 1, "seed": 4,
            "fabric": {"lattice": {"points_per_row": 6, "rows": 7, "layers": 1,
                "spacing_mm": [20, 20, 10], "irregularity": [0.5, 0.5, 0.5]}},
            "bond": {"modulus_n": 0.4, "friction_modulus_n": 1.5, "compression_stiffness_n": 0.2,
                "mean_strength_n": 3.0, "strength_sigma": 0.3},
            "test": {"strain_step": 0.05, "max_strain": 3.0}}},
        "cases": [{"label": "strength = as it is"}],
        "vary": {"/bond/mean_strength_n": [1.5, 3.0, 6.0]},
        "results": ["max_force", "poisson_ratio", "magic"],
    })
}

fn design(file: &Value) -> Design {
    let study = ParameterStudy::from_slice(file.to_string().as_bytes()).expect("a study file");
    Design::new(&study).expect("good cases")
}

fn run_in(folder: &Path, design: &Design, threads: usize) -> Study {
    let options = StudyOptions {
        engine: ENGINE,
        threads,
        folder,
        switch: &StopSwitch::default(),
    };
    match run(design, options, &mut |_| {}).expect("every test has a result") {
        StudyEnd::Finished(study) => study,
        StudyEnd::Suspended => panic!("nobody stopped it"),
    }
}

fn study(file: &Value, threads: usize) -> Study {
    let folder = tempfile::tempdir().expect("a folder");
    run_in(folder.path(), &design(file), threads)
}

/// A study without what depends on the machine and the moment.
fn timeless(mut study: Study) -> Study {
    study.total_cpu_s = 0.0;
    for case in &mut study.cases {
        case.cpu_s = 0.0;
        case.tests.iter_mut().for_each(|test| test.cpu_s = 0.0);
    }
    study
}

/// A ball that falls for 0.2 s: too fast for steps of 1 ms.
fn falling(steps: &[f64]) -> Value {
    let stone = json!({"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3,
        "friction_angle_rad": 0.5});
    json!({
        "title": "Falling", "seeds": 2,
        "job": {"kind": "granular_scene", "spec": {
            "version": 1, "materials": {"stone": stone}, "gravity_m_per_s2": [0, 0, -9.81],
            "bodies": [{"material": "stone", "position_m": [0, 0, 0], "sphere": {"radius_m": 0.01}}],
            "stages": [{"run": {"time_s": 0.2}}]}},
        "vary": {"/time_step_s": steps},
        "results": ["kinetic_energy"],
    })
}

#[test]
fn a_test_that_its_spec_makes_impossible_is_a_finding() {
    let study = study(&falling(&[1e-4, 1e-3]), 1);
    let [good, bad] = study.cases.as_slice() else {
        panic!("{:?}", study.cases);
    };
    assert_eq!(good.results["kinetic_energy"].n, 2);
    assert_eq!((bad.results["kinetic_energy"].n, bad.doubtful), (0, 2));
    assert_eq!(bad.warnings["no_result"], 2);
    assert!(study.text().contains("no result (2)"), "{}", study.text());
    let folder = tempfile::tempdir().expect("a folder");
    let options = StudyOptions {
        engine: ENGINE,
        threads: 1,
        folder: folder.path(),
        switch: &StopSwitch::default(),
    };
    let error = run(&design(&falling(&[1e-3])), options, &mut |_| {}).expect_err("nothing");
    assert!(
        error
            .to_string()
            .contains("more than a tenth of its radius"),
        "{error}"
    );
}

#[test]
fn cases_have_the_statistics_of_their_tests() {
    let design = design(&file());
    // one case is what the job has without it
    assert_eq!((design.cases.len(), design.settings().tests()), (4, 9));
    let study = study(&file(), 2);
    assert_eq!(study.seeds, [4, 5, 6]);
    assert_eq!(study.unknown_results, ["magic"]);
    let findings: Vec<&String> = study.findings.keys().collect();
    assert_eq!(findings, ["max_force", "poisson_ratio"]);
    for case in &study.cases {
        let place = case.results.get_index_of("max_force").expect("it is told");
        let forces: Vec<f64> = case
            .tests
            .iter()
            .filter_map(|test| test.values[place])
            .collect();
        let sample = Sample::of(&forces).expect("three tests");
        let result = &case.results["max_force"];
        assert_eq!(result.sample(), Some(sample));
        assert_eq!((result.unit.as_str(), result.n), ("N", 3));
        assert!(case.cpu_s > 0.0);
    }
    let [whole, weak, same, strong] = [0, 1, 2, 3].map(|index| &study.cases[index]);
    assert_eq!((&whole.tests, &whole.results), (&same.tests, &same.results));
    // strengths scale with their mean, so that a strong fabric carries more
    let finding = &study.findings["max_force"];
    assert_eq!(finding.trend, Trend::Neither);
    assert_eq!(
        finding.order,
        [&weak.label, &whole.label, &same.label, &strong.label].map(String::clone)
    );
    let sample = |case: &CaseRow| case.results["max_force"].sample().expect("known");
    let test = Welch::test(&sample(weak), &sample(whole)).expect("three tests each");
    assert_eq!(
        (finding.steps[0].p, finding.steps[0].difference),
        (Some(test.p), test.difference)
    );
    assert_eq!(finding.steps[1].p, Some(1.0));
    assert!(
        test.p < 0.05 && finding.words.contains("strength = as it is and"),
        "{}",
        finding.words
    );
}

#[test]
fn trends_are_those_of_the_means() {
    let mut file = file();
    file["cases"] = json!([]);
    let rising = study(&file, 1);
    assert_eq!(rising.findings["max_force"].trend, Trend::Rises);
    assert!(
        rising.findings["max_force"]
            .words
            .contains("rises from case to case: 1.5 (")
    );
    file["vary"] = json!({"/bond/mean_strength_n": [6.0, 3.0]});
    file["results"] = json!(["max_force", "gauge_length"]);
    file["seeds"] = json!(1);
    let falling = study(&file, 1);
    let finding = &falling.findings["max_force"];
    assert_eq!((finding.trend, finding.steps[0].p), (Trend::Falls, None));
    assert!(
        finding.words.contains("nothing can be said of chance"),
        "{}",
        finding.words
    );
}

#[test]
fn threads_change_the_time_only() {
    assert_eq!(timeless(study(&file(), 1)), timeless(study(&file(), 3)));
}

#[test]
fn a_stopped_study_goes_on_in_the_middle_of_a_test() {
    let file = json!({
        "title": "Steps", "seeds": 2, "example": "nonwoven_tensile_quick",
        "vary": {"/test/strain_step": [0.02, 0.01]}});
    let design = design(&file);
    let folder = tempfile::tempdir().expect("a folder");
    let switch = StopSwitch::default();
    let options = StudyOptions {
        engine: ENGINE,
        threads: 1,
        folder: folder.path(),
        switch: &switch,
    };
    let end = run(&design, options, &mut |progress| {
        if progress.fraction > 0.6 {
            switch.stop(StopCause::Shutdown);
        }
    });
    assert!(matches!(end, Ok(StudyEnd::Suspended)), "{end:?}");
    let unfinished = || {
        let entries = std::fs::read_dir(folder.path()).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").path());
        let is_state = |path: &std::path::PathBuf| path.extension().is_some_and(|end| end == "bin");
        names.filter(is_state).collect::<Vec<_>>()
    };
    assert_eq!(unfinished().len(), 1);
    let lines = || {
        let text = std::fs::read_to_string(folder.path().join("runs.jsonl")).expect("a file");
        text.lines().count()
    };
    assert!((1..4).contains(&lines()), "{}", lines());
    let resumed = run_in(folder.path(), &design, 2);
    assert_eq!((lines(), unfinished().len()), (4, 0));
    assert_eq!(timeless(resumed), timeless(study(&file, 2)));

    // a state that is none costs time only
    let spoiled = tempfile::tempdir().expect("a folder");
    for seed in [1, 2] {
        let spec = design.settings().test(0, seed);
        let sha256 = spec.sha256();
        let state = crate::test_checkpoint::TestCheckpoint::new(spoiled.path(), ENGINE, &sha256);
        state
            .write(1.0, b"not what a simulation gave")
            .expect("written");
    }
    let study = run_in(spoiled.path(), &design, 1);
    assert_eq!(timeless(study), timeless(run_in(folder.path(), &design, 1)));
}

#[test]
fn the_files_have_every_case_and_every_test() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = run_in(folder.path(), &design(&file()), 2);
    study.write(folder.path()).expect("a folder to write to");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
    let csv = read("parameters.csv");
    assert_eq!(csv.lines().count(), 1 + 4 * 3);
    let head: Vec<&str> = csv.lines().next().expect("a head").split(',').collect();
    assert_eq!(head[..2], ["case", "seed"]);
    assert_eq!(head.len(), 4 + study.cases[0].results.len());
    let force = head
        .iter()
        .position(|name| *name == "max_force_n")
        .expect("a force");
    let row: Vec<&str> = csv.lines().nth(4).expect("a row").split(',').collect();
    assert_eq!(row[..2], ["mean_strength_n = 1.5", "4"]);
    let place = study.cases[1]
        .results
        .get_index_of("max_force")
        .expect("it is told");
    let value: f64 = row[force].parse().expect("a number");
    assert_eq!(Some(value), study.cases[1].tests[0].values[place]);

    let page = read("parameters.md");
    for said in [
        "# Strength | of bonds",
        "Source: a rule of proportion",
        "> The force grows with the strength.",
        "| case | max force [N] | poisson ratio | n |",
        "\n| mean_strength_n = 6.0 |",
        "seeds 4 to 6",
        "- Max force neither rises nor falls",
        "No test told magic; there are: ",
    ] {
        assert!(page.contains(said), "{said} in {page}");
    }
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with('|')).collect();
    assert_eq!(rows.len(), 2 + 4);
    let json: Value = serde_json::from_str(&read("parameters.json")).expect("JSON");
    assert_eq!(json["cases"][3]["set"]["/bond/mean_strength_n"], json!(6.0));
    assert_eq!(json["findings"]["max_force"]["trend"], json!("neither"));
    let svg = read("parameters.svg");
    assert_eq!(svg.matches("class=\"frame\"").count(), 2);
    // a bar for each case, a dot for each test, in each panel
    assert_eq!(svg.matches("class=\"path\"").count(), 2 * 4);
    assert_eq!(svg.matches("class=\"open\"").count(), 2 * 4 * 3);
    assert!(
        study.text().contains("mean_strength_n = 1.5"),
        "{}",
        study.text()
    );
}

#[test]
fn warnings_are_counted_by_case() {
    // a sphere on a floor, softer and softer until it sinks in
    let file = json!({
        "title": "Softness", "seeds": 2, "results": ["elastic_energy"],
        "job": {"kind": "granular_scene", "spec": {
            "version": 1, "seed": 1,
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
                "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
            "bodies": [{"sphere": {"radius_m": 0.01}, "material": "stone", "position_m": [0, 0, 0.01]}],
            "planes": [{"name": "floor", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
            "laws": {"local_damping": 0.3},
            "stages": [{"run": {"time_s": 0.2}}]}},
        "vary": {"/materials/stone/youngs_modulus_pa": [1e7, 3e3]}});
    let study = study(&file, 1);
    let [hard, soft] = [&study.cases[0], &study.cases[1]];
    assert_eq!((hard.doubtful, hard.warnings.len()), (0, 0));
    assert_eq!(
        (soft.doubtful, soft.warnings["largest_overlap_ratio"]),
        (2, 2)
    );
    assert!(
        soft.warnings_in_words()
            .starts_with("2 of 2: largest overlap ratio (2)")
    );
    // specimens that are all alike have no scatter to hold a difference against
    let finding = &study.findings["elastic_energy"];
    assert_eq!(finding.steps[0].p, None);
    assert!(
        finding
            .words
            .ends_with("Seeds change nothing in it, so that nothing is said of chance."),
        "{}",
        finding.words
    );
}

#[test]
fn where_seeds_change_nothing_nothing_is_said_of_chance() {
    let case = |label: &str, values: [f64; 2]| {
        let sample = Sample::of(&values).expect("two values");
        let result = CaseResult {
            unit: "N".to_owned(),
            mean: Some(sample.mean),
            deviation: sample.deviation,
            interval: sample.interval,
            n: sample.count,
        };
        CaseRow {
            label: label.to_owned(),
            set: IndexMap::new(),
            spec_sha256: String::new(),
            cpu_s: 0.0,
            doubtful: 0,
            warnings: IndexMap::new(),
            results: IndexMap::from([("force".to_owned(), result)]),
            tests: Vec::new(),
        }
    };
    let finding = |cases: &[CaseRow]| Finding::of("force", cases);
    // apart by rounding only
    let equal = [case("a", [8.0; 2]), case("b", [8.0 + 1e-12; 2])];
    let rounded = finding(&equal);
    assert_eq!((rounded.trend, rounded.steps[0].p), (Trend::Rises, None));
    assert!(
        !rounded.words.contains("more than chance"),
        "{}",
        rounded.words
    );
    assert!(
        rounded.words.contains("Seeds change nothing"),
        "{}",
        rounded.words
    );
    // t = 4/√(0.02/2) = 40 at one degree of freedom: p = 1 − 2 atan(40)/π
    let [a, b] = equal;
    let mixed = finding(&[a, b, case("c", [11.9, 12.1])]);
    let p = 1.0 - 2.0 * 40.0_f64.atan() / std::f64::consts::PI;
    let found = mixed.steps[1].p.expect("c scatters");
    assert!(
        mixed.steps[0].p.is_none() && (found - p).abs() < 1e-9,
        "{found} {p}"
    );
    assert!(
        mixed.words.contains(
            "Seeds change nothing in a and b, so that nothing is said of chance there. The difference \
             between b and c is more than chance"
        ),
        "{}",
        mixed.words
    );
}
