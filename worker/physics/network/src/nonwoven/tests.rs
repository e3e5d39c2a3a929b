//! Whole tests of a few bonds, against what can be written down.
mod equilibria;

use std::collections::BTreeMap;
use std::io::{self, Write};

use loadframe_api::{JobKind, JobSpec, Report, Submission};
use loadframe_harness::{Decorator, Ending, Recorder, RunContext, Uninterrupted, Unrecorded};

/// What a run logged, its files, and where its curve ended.
#[derive(Default)]
struct Kept {
    log: Vec<String>,
    columns: Vec<String>,
    last: Vec<f64>,
    files: BTreeMap<String, Vec<u8>>,
}

impl Decorator for Kept {
    fn inner(&self) -> &dyn Recorder {
        &Unrecorded
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        unreachable!("all that is asked for is taken")
    }

    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        self.columns = names.iter().map(|name| (*name).to_owned()).collect();
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        values.clone_into(&mut self.last);
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        self.files.insert(name.to_owned(), bytes);
        Ok(())
    }

    fn progress(&mut self, _: f64, _: &str) {}

    fn log(&mut self, message: &str) {
        self.log.push(message.to_owned());
    }
}

impl Kept {
    fn at_end(&self, name: &str) -> f64 {
        let column = self.columns.iter().position(|column| column == name);
        self.last[column.expect("a column")]
    }
}

/// Runs a spec to its end.
fn run(spec: &str) -> (Report, Kept) {
    let job = format!(r#"{{"kind": "nonwoven_tensile", "spec": {{"version": 1, {spec}}}}}"#);
    run_job(job.as_bytes())
}

fn run_job(job: &[u8]) -> (Report, Kept) {
    let submission = Submission::from_slice(job).expect("a job");
    let JobSpec::NonwovenTensile(spec) = submission.spec else {
        panic!("another kind")
    };
    let context = RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    let mut kept = Kept::default();
    match super::run(&spec, context, &mut kept) {
        Ok(Ending::Finished(report)) => (report, kept),
        other => panic!("{other:?}"),
    }
}

/// Bonds side by side between jaws 10 mm apart, 1 mm wide.
fn bundle(bonds: &[&str]) -> String {
    let bonds: Vec<String> = bonds
        .iter()
        .map(|bond| format!(r#"{{"nodes": [0, 1], {bond}}}"#))
        .collect();
    format!(
        r#""fabric": {{"network": {{"nodes_mm": [[0, 0, 0], [0, 10, 0]], "jaws": ["bottom", "top"],
            "width_mm": 1, "bonds": [{}]}}}}"#,
        bonds.join(", ")
    )
}

fn value(report: &Report, name: &str) -> f64 {
    report.summary[name].value.expect("known")
}

fn warning<'a>(report: &'a Report, code: &str) -> Option<&'a str> {
    let mut warnings = report.warnings.iter();
    let found = warnings.find(|warning| warning.code == code);
    found.map(|warning| &*warning.detail)
}

#[test]
fn what_is_read_between_strain_steps_is_measured_there() {
    // slack until 0.5 %: nothing is carried at 0.1 %, and 100 N (ε - 0.005)/1.005 beyond
    let slack = bundle(&[r#""rest_length_mm": 10.05, "modulus_n": 100, "strength_n": 3"#]);
    let (report, kept) = run(&format!(
        r#"{slack}, "output": {{"reading_strains": [0.001, 0.0075]}}"#
    ));
    assert!(value(&report, "secant_stiffness_at_0_1_percent").abs() < 1e-9);
    let expected = 100.0 * 0.002_5 / 1.005 / 0.007_5;
    let found = value(&report, "secant_stiffness_at_0_75_percent");
    assert!((found - expected).abs() < 1e-9 * expected, "{found}");
    // the steps stay where they are
    let curve = String::from_utf8(kept.files["curve.csv"].clone()).expect("text");
    let strains = curve.lines().skip(1).map(|row| row.split(',').next());
    let first: Vec<_> = strains.flatten().take(5).collect();
    assert_eq!(first, ["0", "0.001", "0.0075", "0.01", "0.02"]);
}

#[test]
fn a_long_step_rests_at_the_usual_strain() {
    let bond = r#""modulus_n": 0.399, "friction_modulus_n": 1.473, "strength_n": 3"#;
    let (report, _) = run(&format!(
        r#"{}, "test": {{"strain_step": 1.0}}"#,
        bundle(&[bond])
    ));
    // e + f_r ε
    let found = value(&report, "secant_stiffness_at_10_percent");
    assert!((found - 0.5463).abs() < 1e-9, "{found}");
}

#[test]
fn what_is_read_before_the_first_step_is_as_exact_as_what_is_read_later() {
    // e of 1 N and 3 N in line: 10 mm/(5 mm/1 N + 5 mm/3 N); moved alike, the upper one by itself has 3 N
    let line = r#""fabric": {"network": {"nodes_mm": [[0, 0, 0], [0, 5, 0], [0, 10, 0]],
        "jaws": ["bottom", "free", "top"], "width_mm": 1, "bonds": [
            {"nodes": [0, 1], "modulus_n": 1}, {"nodes": [1, 2], "modulus_n": 3}]}}"#;
    for (accuracy, force_accuracy) in [("draft", 5.0), ("standard", 100.0)] {
        let (report, _) = run(&format!(
            r#"{line}, "test": {{"strain_step": 1.0, "breaking": "none", "max_strain": 1.0}},
            "output": {{"reading_strains": [0.001]}}, "accuracy": "{accuracy}""#
        ));
        for name in ["0_1", "10"] {
            let found = value(&report, &format!("secant_stiffness_at_{name}_percent"));
            // the softest bond's tension at this strain over A_cc, of which the upper one bears 3/4
            let limit = 0.75 / force_accuracy;
            assert!(
                (found - 1.5).abs() <= limit,
                "{accuracy}, {name} %: {found}"
            );
        }
    }
}

/// A bond stretched to twice its length that breaks at a strain of 0.15 %, and a slack one in parallel
/// whose compression pushes the jaws apart until 1 %.
fn taut_and_pressed(pressed: &str) -> String {
    bundle(&[
        r#""rest_length_mm": 5.0, "modulus_n": 100.0, "strength_n": 100.3"#,
        &format!(
            r#""rest_length_mm": 10.1, "compression_stiffness_n": 10100.0, "strength_n": 1000, {pressed}"#
        ),
    ])
}

#[test]
fn a_force_below_zero_is_no_fall_to_a_fraction_of_zero() {
    let (report, _) = run(&format!(
        r#"{}, "test": {{"strain_step": 0.0005, "max_strain": 0.02, "stop_force_fraction": 0.0}}"#,
        taut_and_pressed(r#""modulus_n": 10100.0"#)
    ));
    assert_eq!(report.stop_reason, "max_strain");
    // after the break the other bond alone, 10100 N (10.2 - 10.1)/10.1 at the end
    assert!((value(&report, "max_force") - 100.0).abs() < 1e-6);
}

#[test]
fn a_force_that_grows_faster_than_the_tension_is_not_overstepped() {
    // 100 (1 + 2 ε) N breaks at 100.3 N, ε = 0.0015; the other presses with 10100 N (0.1 - 10 ε)/10.1
    let expected = 100.3 - 10_100.0 * (0.1 - 10.0 * 0.001_5) / 10.1;
    for (accuracy, precision) in [("draft", 0.05), ("standard", 0.01), ("reference", 0.002)] {
        let (report, _) = run(&format!(
            r#"{}, "test": {{"strain_step": 0.005, "max_strain": 0.009}}, "accuracy": "{accuracy}""#,
            taut_and_pressed(r#""modulus_n": 0.001"#)
        ));
        let past = (value(&report, "max_force") - expected) / value(&report, "max_force");
        let told = report.quality["overstepped_force"].value;
        // both curves are straight, so that the estimate is what it is
        assert!(
            (past - told).abs() < 1e-6,
            "{accuracy}: {past}, {told} told"
        );
        assert!(told <= precision, "{accuracy}: {told}");
    }
}

#[test]
fn a_taut_bond_is_not_passed_for_another_that_is_farther_over_its_strength() {
    // 1 + 2 ε N breaks at 1.0001 N, ε = 5·10⁻⁵; the other, slack, at ε = 0.004, by when it is the farther one
    let modulus = 249.234_643_492;
    let expected = 1.000_1 + modulus * 5e-5;
    let bonds = bundle(&[
        r#""rest_length_mm": 5.0, "modulus_n": 1.0, "strength_n": 1.0001"#,
        &format!(r#""modulus_n": {modulus}, "strength_n": 1.0"#),
    ]);
    for (accuracy, precision) in [("draft", 0.05), ("standard", 0.01), ("reference", 0.002)] {
        let (report, _) = run(&format!(
            r#"{bonds}, "test": {{"strain_step": 0.01, "max_strain": 0.1}}, "accuracy": "{accuracy}""#
        ));
        let past = value(&report, "max_force") / expected - 1.0;
        let told = report.quality["overstepped_force"].value;
        assert!(
            (-1e-9..=precision).contains(&past) && told <= precision,
            "{accuracy}: {past}, {told} told"
        );
    }
}

#[test]
fn bonds_in_one_line_have_no_width_and_results_say_so() {
    let spec = bundle(&[r#""modulus_n": 10, "strength_n": 3"#]).replace(r#""width_mm": 1, "#, "");
    assert!(!spec.contains("width"));
    let (report, _) = run(&spec);
    assert!((value(&report, "max_force") - 3.0).abs() < 0.03);
    for name in ["modulus_at_10_percent", "strength", "energy_absorption"] {
        let quantity = &report.summary[name];
        let reason = quantity.reason.as_deref().unwrap_or_default();
        assert!(reason.contains("has no width"), "{name}: {quantity:?}");
    }
    assert!((value(&report, "secant_stiffness_at_10_percent") - 10.0).abs() < 1e-6);
}

#[test]
fn cycles_that_end_before_they_begin_are_named() {
    // 100 N at no strain are beyond the 50 N of the pull
    let taut = bundle(&[r#""rest_length_mm": 5.0, "modulus_n": 100.0, "strength_n": 1000"#]);
    let history = |blocks: &str| {
        format!(
            r#"{taut}, "test": {{"strain_step": 0.01, "max_strain": 0.1, "history": [{blocks}]}}"#
        )
    };
    let up = r#"{"to": {"strain": 0.02}, "back_to": {"strain": 0}}"#;
    let none = r#"{"to": {"force_n": 50}, "back_to": {"force_n": 20}, "repetitions": 2}"#;
    let (report, _) = run(&history(&format!("{up}, {none}")));
    let words = warning(&report, "cycles_skipped").expect("a warning");
    assert!(
        words.contains("2 of 3 cycles") && words.contains("cycle 2 in /test/history/1"),
        "{words}"
    );
    assert_eq!(warning(&report, "history_not_finished"), None);
    assert_eq!(warning(&run(&history(up)).0, "cycles_skipped"), None);
}

/// A small lattice with these spacings [mm].
fn lattice(spacing: &str, more: &str, bond: &str, rest: &str) -> String {
    format!(
        r#""fabric": {{"lattice": {{"points_per_row": 7, "rows": 9, "layers": 1, "spacing_mm": {spacing},
            "irregularity": {more}}}}},
        "bond": {{"modulus_n": 0.399, "friction_modulus_n": 1.473, "compression_stiffness_n": 0.157,
            "mean_strength_n": 3.397, "strength_sigma": 0.365{bond}}},
        "test": {{"strain_step": 0.01, "max_strain": 0.12}}, "output": {{"snapshot_every_steps": 0}}{rest}"#
    )
}

#[test]
fn the_example_of_both_directions_shows_errors() {
    let mut examples = JobKind::NonwovenTensile.examples().iter();
    let example = examples.find(|example| example.name == "nonwoven_tensile_directions");
    let fewer = example
        .expect("an example")
        .body
        .replace(r#""repeats": 5"#, r#""repeats": 2"#);
    let (report, kept) = run_job(fewer.as_bytes());
    for name in ["strength", "modulus_at_10_percent", "poisson_ratio"] {
        for name in [name.to_owned(), format!("{name}_along_x")] {
            let error = report.summary[&name].error.as_ref();
            let parts = &error
                .unwrap_or_else(|| panic!("{name}: {:?}", kept.log))
                .parts;
            let has = |source: &str| parts.iter().any(|part| part.source == source);
            assert!(has("solver") && has("specimens"), "{name}: {parts:?}");
        }
    }
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn only_lattices_like_those_that_were_measured_have_errors() {
    let same = "[0.5, 0.5, 0.5]";
    let told = |spec: &str| {
        let (report, kept) = run(spec);
        let has_error = report.summary["poisson_ratio"].error.is_some();
        (has_error, kept.log.join("\n"))
    };
    assert!(told(&lattice("[2, 2, 1]", same, "", "")).0);
    let of_points = |points_per_row: u32, rows: u32| {
        let sides = format!(r#""points_per_row": {points_per_row}, "rows": {rows},"#);
        lattice("[2, 2, 1]", same, "", "").replace(r#""points_per_row": 7, "rows": 9,"#, &sides)
    };
    for (spec, words) in [
        (of_points(5, 9), "at least 6 points along both sides"),
        (of_points(6, 17), "rows_over_points_per_row is 2.833"),
        (
            lattice("[2, 2, 4]", same, "", ""),
            "spacing_z_over_y is 2.000",
        ),
        (
            lattice("[4, 2, 1]", same, "", ""),
            "spacing_x_over_y is 2.000",
        ),
        (
            lattice("[2, 2, 1]", "[0.5, 0.5, 0.4]", "", ""),
            "alike irregular",
        ),
        (
            lattice("[2, 2, 1]", same, r#", "strength_draw": "normal""#, ""),
            "log-normal",
        ),
        (
            lattice(
                "[2, 2, 1]",
                same,
                "",
                r#", "accuracy": {"force_accuracy": 1e4, "iteration_limit": 1}"#,
            ),
            "steps have none",
        ),
    ] {
        let (has_error, log) = told(&spec);
        assert!(!has_error && log.contains(words), "{log}");
    }
}
