//! Whole tests of a few bonds, against what can be written down.
use std::collections::BTreeMap;
use std::io::{self, Write};

use loadframe_api::{JobSpec, Report, Submission};
use loadframe_harness::{Decorator, Ending, Recorder, RunContext, Uninterrupted, Unrecorded};

/// What a run logged, and its files.
#[derive(Default)]
struct Kept {
    log: Vec<String>,
    files: BTreeMap<String, Vec<u8>>,
}

impl Decorator for Kept {
    fn inner(&self) -> &dyn Recorder {
        &Unrecorded
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        unreachable!("all that is asked for is taken")
    }

    fn columns(&mut self, _: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _: &[f64]) -> io::Result<()> {
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
fn only_lattices_like_those_that_were_measured_have_errors() {
    let same = "[0.5, 0.5, 0.5]";
    let told = |spec: &str| {
        let (report, kept) = run(spec);
        let has_error = report.summary["poisson_ratio"].error.is_some();
        (has_error, kept.log.join("\n"))
    };
    assert!(told(&lattice("[2, 2, 1]", same, "", "")).0);
    for (spec, words) in [
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
