//! Which tests have errors, and what they are made of. Values are those of the tables times the results.
use loadframe_api::{
    ErrorPart, JobSpec, Quantity, Report, Submission, spec::ballast::BallastOedometer,
};
use serde_json::{Value, json};

use super::add;

const STIFFNESS: f64 = 2e6;
const WAY: f64 = -3.0;

/// What is stated of an oedometer test with a change: of stiffness and residual way, and what is said.
fn stated(pointer: &str, value: &Value) -> ([Option<Vec<ErrorPart>>; 2], Option<String>) {
    let mut body = json!({"kind": "ballast_oedometer", "spec": {"version": 1,
        "grains": {"sizes": {"uniform": {"smallest_radius_m": 0.016, "largest_radius_m": 0.031}}},
        "materials": {"aggregate": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 7e7,
            "stiffness_ratio": 0.38, "friction_angle_rad": 0.54}},
        "preparation": {"longest_settling_s": 6},
        "accuracy": "draft",
        "test": {"smallest_force_n": 100, "peak_force_n": 6100}}});
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    body["spec"].pointer_mut(parent).expect("a place")[name] = value.clone();
    let job = Submission::from_slice(body.to_string().as_bytes());
    let JobSpec::BallastOedometer(spec) = job.expect("a valid job").spec else {
        panic!("another kind")
    };
    told(&spec)
}

fn told(spec: &BallastOedometer) -> ([Option<Vec<ErrorPart>>; 2], Option<String>) {
    let mut report = Report::default();
    for (name, value) in [
        ("unloading_stiffness", STIFFNESS),
        ("peak_displacement", WAY),
        ("residual_displacement", 0.0),
        ("simulated_time", 1.0),
    ] {
        let quantity = Quantity::new(value, "", "");
        report.summary.insert(name.to_owned(), quantity);
    }
    let words = add(&mut report, spec);
    assert_eq!(report.summary["simulated_time"].error, None);
    let parts = ["unloading_stiffness", "residual_displacement"].map(|name| {
        let error = report.summary[name].error.clone();
        error.map(|error| error.parts)
    });
    (parts, words)
}

/// An entry of the table: of a source, at its place among the levels.
fn tabled(source: &str, level: usize, name: &str) -> f64 {
    let table: Value =
        serde_json::from_str(include_str!("ballast_oedometer.json")).expect("a table");
    let error = &table["sources"][source][level]["errors"][name];
    error.as_f64().expect("a number")
}

#[test]
fn an_error_has_what_beds_differ_by_and_what_the_preset_is_off() {
    for (level, preset) in ["draft", "standard", "reference"].into_iter().enumerate() {
        let ([stiffness, residual], words) = stated("/accuracy", &json!(preset));
        assert_eq!(words, None);
        for (name, size, parts) in [
            ("unloading_stiffness", STIFFNESS, stiffness),
            // what is left may be nothing: its error is over the way down
            ("residual_displacement", -WAY, residual),
        ] {
            let parts = parts.expect("a measured test");
            let expected: Vec<(&str, f64)> = [("specimens", 0), ("preset", level)]
                .map(|(source, level)| (source, size * tabled(source, level, name)))
                .into_iter()
                .filter(|(_, value)| *value > 0.0)
                .collect();
            let found = parts.iter().map(|part| (part.source.as_str(), part.value));
            assert_eq!(found.collect::<Vec<_>>(), expected, "{name} at {preset}");
        }
    }
}

#[test]
fn knobs_have_the_error_of_the_finest_preset_that_none_of_them_is_coarser_than() {
    let of = |accuracy: Value| stated("/accuracy", &accuracy).0;
    // a bed of 70 MPa is softened by no preset
    let knobs = json!({"critical_step_fraction": 0.3, "inertial_number": 4e-4});
    assert_eq!(of(knobs), of(json!("standard")));
    let knobs = json!({"critical_step_fraction": 0.3, "inertial_number": 6e-4});
    assert_eq!(of(knobs), of(json!("draft")));
    let knobs = json!({"critical_step_fraction": 0.5});
    let (parts, words) = stated("/accuracy", &knobs);
    assert_eq!(parts, [None, None]);
    assert!(words.expect("a reason").contains("coarser than in draft"));
}

#[test]
fn what_was_not_measured_has_no_error_and_says_why() {
    for (pointer, value, reason) in [
        ("/test/period_s", json!(1.0), "no given period"),
        ("/preparation/compaction", json!(null), "shaken"),
        (
            "/grains/sizes",
            json!({"radius_m": 0.025}),
            "evenly spread radii",
        ),
        ("/laws", json!({"local_damping": 0.1}), "laws and walls"),
        (
            "/apparatus",
            json!({"height_m": 0.25}),
            "apparatus as it is",
        ),
        (
            "/materials/aggregate/rolling_resistance",
            json!({"rolling_friction": 0.1}),
            "laws and walls",
        ),
        (
            "/materials/aggregate/youngs_modulus_pa",
            json!(1e12),
            "youngs_modulus_pa is",
        ),
        ("/test/peak_force_n", json!(1e6), "stress_over_modulus is"),
    ] {
        let (parts, words) = stated(pointer, &value);
        assert_eq!(parts, [None, None], "{pointer}");
        let words = words.expect("a reason");
        assert!(
            words.contains("no error") && words.contains(reason),
            "{pointer}: {words}"
        );
    }
}
