//! Study files, read and refused.
use serde_json::{Value, json};

use super::*;
use crate::{Message, SubmissionError, Violation};

fn read(file: &Value) -> Result<Vec<Case>, Vec<Violation>> {
    let study = ParameterStudy::from_slice(file.to_string().as_bytes());
    study.map_err(SubmissionError::violations)?.cases()
}

fn with(more: &Value) -> Value {
    let mut file = json!({"title": "Strain step", "example": "nonwoven_tensile_quick"});
    for (name, value) in more.as_object().expect("fields") {
        file[name] = value.clone();
    }
    file
}

fn spec(case: &Case) -> Value {
    serde_json::from_str(&case.spec.to_json()).expect("JSON")
}

fn refused(more: &Value) -> Violation {
    let mut violations = read(&with(more)).expect_err("it is wrong");
    assert_eq!(violations.len(), 1, "{violations:#?}");
    violations.remove(0)
}

#[test]
fn every_study_of_the_folder_is_valid() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/studies");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let body = std::fs::read(&path).expect("a file");
        let study = ParameterStudy::from_slice(&body);
        let study = study.unwrap_or_else(|error| panic!("{}: {error:?}", path.display()));
        let cases = study.cases();
        let cases = cases.unwrap_or_else(|error| panic!("{}: {error:#?}", path.display()));
        assert!(!cases.is_empty());
        count += 1;
    }
    assert!(count > 0);
}

#[test]
fn cases_set_what_they_name_and_nothing_else() {
    let cases = read(&with(&json!({"cases": [
        {"label": "as it is"},
        {"label": "coarse", "set": {"/test/strain_step": 0.05, "/output/snapshot_every_steps": 3}},
    ]})));
    let cases = cases.expect("valid");
    let [plain, coarse] = [&cases[0], &cases[1]];
    assert_eq!(
        (plain.label.as_str(), coarse.label.as_str()),
        ("as it is", "coarse")
    );
    let mut expected = spec(plain);
    expected["test"]["strain_step"] = json!(0.05);
    // the example has no output of its own: it is made
    expected["output"]["snapshot_every_steps"] = json!(3);
    assert_eq!(spec(coarse), expected);
    assert_eq!(coarse.set["/test/strain_step"], json!(0.05));
}

#[test]
fn varied_pointers_are_combined_with_the_last_fastest() {
    let cases = read(&with(&json!({
        "cases": [{"label": "first"}],
        "vary": {"/bond/strength_sigma": [0.1, 0.3], "/test/breaking": ["weakest_first", "none"]},
    })));
    let labels: Vec<String> = cases
        .expect("valid")
        .into_iter()
        .map(|case| case.label)
        .collect();
    assert_eq!(
        labels,
        [
            "first",
            "strength_sigma = 0.1, breaking = weakest_first",
            "strength_sigma = 0.1, breaking = none",
            "strength_sigma = 0.3, breaking = weakest_first",
            "strength_sigma = 0.3, breaking = none",
        ]
    );
    // pointers that end alike are told in full
    let file = json!({"title": "t", "example": "granular_scene", "vary": {
        "/materials/stone/stiffness_ratio": [0.1], "/materials/steel/stiffness_ratio": [0.2]}});
    assert_eq!(
        read(&file).expect("valid")[0].label,
        "materials/stone/stiffness_ratio = 0.1, materials/steel/stiffness_ratio = 0.2"
    );
}

#[test]
fn the_job_may_stand_in_the_file() {
    let example = crate::JobKind::NonwovenTensile.examples()[1].body;
    let job: Value = serde_json::from_str(example).expect("JSON");
    let file = json!({"title": "t", "job": job, "vary": {"/test/strain_step": [0.04]}});
    let named = with(&json!({"vary": {"/test/strain_step": [0.04]}}));
    assert_eq!(read(&file), read(&named));
    let mut bad = file.clone();
    bad["job"]["spec"]["bond"]["modulus_n"] = json!(-1);
    let violations = read(&bad).expect_err("no negative modulus");
    assert_eq!(violations[0].pointer, "/job/spec/bond/modulus_n");
    let mut both = file;
    both["example"] = json!("nonwoven_tensile_quick");
    let violations = read(&both).expect_err("two jobs");
    assert_eq!(
        violations[0].allowed.as_deref(),
        Some("job or example, one of them")
    );
}

#[test]
fn a_bad_value_is_told_with_case_pointer_value_and_range() {
    let violation = refused(&json!({"cases": [
        {"label": "good"}, {"label": "steep", "set": {"/test/strain_step": 7}}]}));
    assert_eq!(violation.pointer, "/cases/1/set/~1test~1strain_step");
    assert!(
        violation.detail.starts_with("case \"steep\": "),
        "{violation}"
    );
    assert_eq!(violation.value, Some(json!(7)));
    assert!(violation.allowed.is_some(), "{violation}");

    // a bad value of several combinations is told once
    let violation = refused(&json!({"vary": {
        "/bond/modulus_n": [0.4, -1], "/test/strain_step": [0.01, 0.02]}}));
    assert_eq!(violation.pointer, "/vary/~1bond~1modulus_n/1");
    assert_eq!(violation.unit.as_deref(), Some("N"));

    // what is wrong inside a value is told with its place there
    let violation = refused(&json!({"cases": [{"label": "a", "set": {"/bond": {
        "modulus_n": 1, "friction_modulus_n": 1, "compression_stiffness_n": 1,
        "mean_strength_n": -3, "strength_sigma": 0.3}}}]}));
    assert_eq!(violation.pointer, "/cases/0/set/~1bond/mean_strength_n");

    // a name that is none, with those there are
    let violation = refused(&json!({"vary": {"/bond/strength": [1]}}));
    assert_eq!(
        (violation.code.as_str(), violation.pointer.as_str()),
        ("unknown_field", "/vary/~1bond~1strength/0")
    );
    assert!(
        violation
            .allowed
            .is_some_and(|allowed| allowed.contains("mean_strength_n"))
    );
}

#[test]
fn pointers_seeds_labels_and_counts_are_checked() {
    let pointer = |more: Value| {
        let violation = refused(&more);
        (violation.pointer.clone(), violation.code)
    };
    let at = |pointer: &str, code: &str| (pointer.to_owned(), code.to_owned());
    assert_eq!(
        pointer(json!({"vary": {"/accuracy/force_accuracy": [10]}})),
        at("/vary/~1accuracy~1force_accuracy/0", "not_allowed")
    );
    assert_eq!(
        pointer(json!({"cases": [{"label": "a", "set": {"/seed": 5}}]})),
        at("/cases/0/set/~1seed", "not_allowed")
    );
    assert_eq!(
        pointer(json!({"cases": [{"label": "a"}, {"label": "a"}]})),
        at("/cases/1", "not_unique")
    );
    assert_eq!(pointer(json!({})), at("/cases", "wrong_length"));
    assert_eq!(
        pointer(json!({"cases": [{"label": "a"}], "vary": {"/seed": [1], "/version": []}})),
        at("/vary/~1version", "wrong_length")
    );
    let many: Vec<u32> = (0..100).collect();
    assert_eq!(
        pointer(json!({"vary": {"/a": many, "/b": many}})),
        at("/vary", "wrong_length")
    );
    assert_eq!(
        pointer(json!({"vary": {"/a": []}})),
        at("/vary/~1a", "wrong_length")
    );
    assert_eq!(
        pointer(json!({"cases": [{"label": "a", "set": {"/x": 1}, "sets": 1}]})),
        at("/cases/0/sets", "unknown_field")
    );
    assert_eq!(
        pointer(json!({"seeds": 0, "cases": [{"label": "a"}]})),
        at("/seeds", "out_of_range")
    );
    let unknown = json!({"title": "t", "example": "nonwoven", "cases": [{"label": "a"}]});
    let violation = &read(&unknown).expect_err("no such example")[0];
    assert!(violation.detail.contains("nonwoven_tensile_quick"));
}
