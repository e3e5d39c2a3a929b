//! Submissions: examples are accepted, mistakes are all named at once, nothing panics.
use loadframe_api::{Example, JobKind, JobSpec, Submission, SubmissionError, Violation};
use proptest::prelude::*;
use serde_json::{Value, json};

fn examples() -> impl Iterator<Item = (JobKind, &'static Example)> {
    JobKind::ALL
        .iter()
        .flat_map(|kind| kind.examples().iter().map(|example| (*kind, example)))
}

fn violations(body: &Value) -> Vec<Violation> {
    match Submission::from_slice(body.to_string().as_bytes()) {
        Err(SubmissionError::Invalid(violations)) => violations,
        other => panic!("expected violations, got {other:?}"),
    }
}

fn example() -> Value {
    serde_json::from_str(JobKind::NonwovenTensile.examples()[0].body).expect("examples are JSON")
}

#[test]
fn every_example_is_accepted_and_survives_normalisation() {
    for (kind, example) in examples() {
        let submission = Submission::from_slice(example.body.as_bytes())
            .unwrap_or_else(|error| panic!("{}: {}", example.name, error.into_problem()));
        assert_eq!(submission.spec.kind(), kind);
        let again = JobSpec::from_json(kind, &submission.spec.to_json())
            .expect("normalised specs are valid");
        assert_eq!(again.sha256(), submission.spec.sha256(), "{}", example.name);
    }
}

#[test]
fn every_example_file_is_listed() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    for entry in std::fs::read_dir(folder).expect("examples exist") {
        let name = entry
            .expect("readable")
            .file_name()
            .into_string()
            .expect("ASCII");
        assert!(
            examples().any(|(_, example)| format!("{}.json", example.name) == name),
            "{name} is not in the list of kinds"
        );
    }
}

#[test]
fn all_mistakes_are_named_at_once_with_value_range_and_unit() {
    let mut body = example();
    body["spec"]["bond"]["modulus_n"] = json!(-1);
    body["spec"]["fabric"]["lattice"]["rows"] = json!(0);
    body["spec"]["fabric"]["lattice"]["spacing_mm"][1] = json!(1e308);
    body["spec"]["test"]["strain_setp"] = json!(0.01);
    body["spec"]["accuracy"]["solver"] = json!("newton");
    body["priority"] = json!("high");
    let violations = violations(&body);
    let find = |pointer: &str| {
        violations
            .iter()
            .find(|v| v.pointer == pointer)
            .unwrap_or_else(|| panic!("{pointer} not in {violations:#?}"))
    };
    let modulus = find("/spec/bond/modulus_n");
    assert_eq!(
        (modulus.code.as_str(), modulus.unit.as_deref()),
        ("out_of_range", Some("N"))
    );
    assert_eq!(modulus.allowed.as_deref(), Some("1e-12 … 1e12"));
    assert_eq!(modulus.value, Some(json!(-1)));
    assert_eq!(find("/spec/fabric/lattice/rows").code, "out_of_range");
    let spacing = find("/spec/fabric/lattice/spacing_mm/1");
    assert_eq!(
        (spacing.code.as_str(), spacing.unit.as_deref()),
        ("out_of_range", Some("mm"))
    );
    assert_eq!(find("/spec/test/strain_setp").code, "unknown_field");
    let solver = find("/spec/accuracy/solver");
    assert_eq!(solver.code, "not_allowed");
    assert!(
        solver
            .allowed
            .as_deref()
            .is_some_and(|allowed| allowed.contains("newton_cg")),
        "{solver:?}"
    );
    assert_eq!(find("/priority").code, "wrong_type");
    assert_eq!(violations.len(), 6, "{violations:#?}");
}

#[test]
fn the_form_a_user_was_writing_is_recognised() {
    let mut body = example();
    body["spec"]["fabric"] = json!({"network": {"nodes_mm": [[0, 0, 0], [0, "1", 0]], "jaws": ["bottom", "top"], "bonds": []}});
    let found = violations(&body);
    assert!(
        found
            .iter()
            .any(|v| v.pointer == "/spec/fabric/network/nodes_mm/1/1" && v.code == "wrong_type"),
        "{found:#?}"
    );
    assert!(
        found
            .iter()
            .any(|v| v.pointer == "/spec/fabric/network/bonds" && v.code == "wrong_length"),
        "{found:#?}"
    );
    body = example();
    body["spec"]["accuracy"] = json!("standrad");
    let found = violations(&body);
    assert_eq!(found[0].pointer, "/spec/accuracy");
    assert!(
        found[0]
            .allowed
            .as_deref()
            .is_some_and(|allowed| allowed.contains("standard")),
        "{found:#?}"
    );
    body["spec"]["accuracy"] = json!({"force_acuracy": 10});
    assert_eq!(violations(&body)[0].pointer, "/spec/accuracy/force_acuracy");
}

#[test]
fn the_same_spec_in_other_words_has_the_same_hash() {
    let plain = Submission::from_slice(example().to_string().as_bytes()).expect("valid");
    let mut body = example();
    body["spec"]["accuracy"] = json!("standard");
    body["spec"]["fabric"]["lattice"]["spacing_mm"] = json!([2.0, 2e0, 1]);
    let other = Submission::from_slice(body.to_string().as_bytes()).expect("valid");
    assert_eq!(plain.spec.sha256(), other.spec.sha256());
}

#[test]
fn text_that_is_not_json_is_located() {
    for (text, code) in [
        ("", "truncated"),
        ("{\"kind\": \"nonwoven_tensile\", \"spec\": {", "truncated"),
        ("{\"spec\": {\"bond\": {\"modulus_n\": NaN}}}", "syntax"),
        ("{\"spec\": {\"bond\": {\"modulus_n\": 1e309}}}", "syntax"),
    ] {
        let Err(SubmissionError::Syntax(violation)) = Submission::from_slice(text.as_bytes())
        else {
            panic!("{text} was accepted as JSON")
        };
        assert_eq!(violation.code, code, "{violation:?}");
        if text.contains("modulus") {
            assert_eq!(violation.pointer, "/spec/bond/modulus_n");
        }
    }
    let brackets = "[".repeat(1 << 20);
    assert!(matches!(
        Submission::from_slice(brackets.as_bytes()),
        Err(SubmissionError::Syntax(_))
    ));
}

#[test]
fn duplicate_fields_are_refused() {
    let text = example()
        .to_string()
        .replacen("\"version\":1", "\"version\":1,\"version\":1", 1);
    let Err(SubmissionError::Invalid(found)) = Submission::from_slice(text.as_bytes()) else {
        panic!("accepted")
    };
    assert_eq!(found[0].code, "duplicate_field");
}

proptest! {
    /// Any change of any value of an example gives a job or an error, never a panic.
    #[test]
    fn any_mutation_is_accepted_or_refused(at in 0_usize..60, with in prop_oneof![
        Just(json!(null)), Just(json!(-1)), Just(json!(1e308)), Just(json!("x")), Just(json!([])), Just(json!({})),
        Just(json!(0)), Just(json!(0.5)), Just(json!(18_446_744_073_709_551_615_u64)), Just(json!(true)),
    ]) {
        for (_, example) in examples() {
            let mut body: Value = serde_json::from_str(example.body).expect("JSON");
            let mut seen = 0;
            mutate(&mut body, at, &with, &mut seen);
            match Submission::from_slice(body.to_string().as_bytes()) {
                Ok(submission) => prop_assert!(!submission.spec.to_json().is_empty()),
                Err(error) => prop_assert!(!error.into_problem().violations.is_empty()),
            }
        }
    }
}

/// Replaces the `at`-th value in depth-first order.
fn mutate(value: &mut Value, at: usize, with: &Value, seen: &mut usize) {
    if *seen == at {
        *value = with.clone();
    }
    *seen += 1;
    match value {
        Value::Array(items) => items
            .iter_mut()
            .for_each(|item| mutate(item, at, with, seen)),
        Value::Object(fields) => fields
            .values_mut()
            .for_each(|item| mutate(item, at, with, seen)),
        _ => {}
    }
}

#[test]
fn a_body_of_too_many_values_is_refused_unread() {
    // commas within a text count as text
    let text = format!("[\"{}\"]", ",\\\"[{".repeat(2_000_000));
    let found = Submission::from_slice(text.as_bytes());
    assert!(
        matches!(found, Err(SubmissionError::Invalid(violations)) if violations[0].code == "wrong_type")
    );
    let many = format!("[{}0]", "0,".repeat(4_000_000));
    let found = Submission::from_slice(many.as_bytes());
    assert!(
        matches!(found, Err(SubmissionError::Invalid(violations)) if violations[0].code == "too_large")
    );
}

#[test]
fn repeats_are_few_enough_and_so_are_their_seeds() {
    let mut body = example();
    body["spec"]["test"]["repeats"] = json!(1001);
    let found = &violations(&body)[0];
    assert_eq!(found.pointer, "/spec/test/repeats");
    assert_eq!(found.allowed.as_deref(), Some("whole numbers 1 … 1000"));
    body["spec"]["test"]["repeats"] = json!(3);
    let largest = (1_u64 << 53) - 1;
    body["spec"]["seed"] = json!(largest - 1);
    let found = &violations(&body)[0];
    assert_eq!(
        (found.pointer.as_str(), found.code.as_str()),
        ("/spec/seed", "out_of_range")
    );
    body["spec"]["seed"] = json!(largest - 2);
    assert!(Submission::from_slice(body.to_string().as_bytes()).is_ok());
}

#[test]
fn bond_forces_are_asked_for_within_the_test() {
    let mut body = example();
    body["spec"]["test"]["max_strain"] = json!(0.5);
    body["spec"]["output"]["force_distribution_strains"] = json!([0.5, 0.6]);
    let found = violations(&body);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(
        found[0].pointer,
        "/spec/output/force_distribution_strains/1"
    );
    assert_eq!(found[0].unit.as_deref(), Some("1"));
}

#[test]
fn repeats_take_as_many_times_as_long() {
    let estimate = |repeats: u32| {
        let mut body = example();
        body["spec"]["test"]["repeats"] = json!(repeats);
        let submission = Submission::from_slice(body.to_string().as_bytes()).expect("valid");
        submission.spec.estimate(&Default::default())
    };
    let (one, ten) = (estimate(1), estimate(10));
    assert!((ten.wall_s / one.wall_s - 10.0).abs() < 1e-9);
    assert!(ten.disk_mb > one.disk_mb && ten.memory_mb > one.memory_mb);
    let mut body = example();
    body["spec"]["test"]["directions"] = json!(["y", "x"]);
    let submission = Submission::from_slice(body.to_string().as_bytes()).expect("valid");
    let both = submission.spec.estimate(&Default::default());
    assert!((both.wall_s / one.wall_s - 2.0).abs() < 1e-9 && both.disk_mb > 1.9 * one.disk_mb);
}

fn calibration() -> Value {
    serde_json::from_str(JobKind::Calibrate.examples()[0].body).expect("examples are JSON")
}

#[test]
fn a_calibration_names_what_is_wrong_with_its_job_in_its_place() {
    let mut body = calibration();
    body["spec"]["job"]["spec"]["fabric"]["lattice"]["rows"] = json!(4);
    let found = violations(&body);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].pointer, "/spec/job/spec/fabric/lattice/rows");
    let mut body = calibration();
    body["spec"]["free"][0]["parameter"] = json!("/bond/strength");
    let found = violations(&body);
    assert_eq!(found[0].pointer, "/spec/free/0/parameter");
    let allowed = found[0].allowed.as_deref().expect("it says what there is");
    assert!(
        allowed.contains("/bond/modulus_n, /bond/friction_modulus_n"),
        "{allowed}"
    );
    assert!(
        !allowed.contains("seed") && !allowed.contains("rows"),
        "{allowed}"
    );
}

#[test]
fn a_calibration_takes_no_more_than_all_its_trials() {
    let estimate = |body: &Value| {
        let submission = Submission::from_slice(body.to_string().as_bytes()).expect("valid");
        submission.spec.estimate(&Default::default())
    };
    let body = calibration();
    let inner = estimate(&body["spec"]["job"]);
    let tests = 60.0 * 4.0;
    // without the snapshots and tables that nobody would see, the test itself takes as long
    assert!((estimate(&body).wall_s / (tests * inner.wall_s) - 1.0).abs() < 1e-9);
    assert!(estimate(&body).disk_mb < inner.disk_mb * tests);
}

#[test]
fn a_measured_curve_is_rows_however_it_was_given() {
    let given = |curve: Value| {
        let mut body = calibration();
        body["spec"]["measured"]["curve"] = curve;
        let submission = Submission::from_slice(body.to_string().as_bytes());
        let spec = submission.expect("valid").spec.to_json();
        let spec: Value = serde_json::from_str(&spec).expect("JSON");
        spec["measured"]["curve"]["rows"].clone()
    };
    let rows = given(json!({"rows": [[0.1, 8.5], [0.2, 30]]}));
    assert_eq!(given(json!({"csv": "strain;force\n0,1;8,5\n0,2;30"})), rows);
}
