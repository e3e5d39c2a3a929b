//! Which tests have errors, and what they are made of. Values are those of the tables times the results.
use loadframe_api::{
    JobSpec, Quantity, Report, Submission, Warning,
    spec::soil::{SoilDirectShear, SoilTriaxial},
};
use serde_json::{Value, json};

use super::{DirectShear, Tabled, Triaxial, add};
use crate::soil::Soil;

const ANGLE: f64 = 40.0;
const DILATANCY: f64 = -2.0;

/// Of an error, by source.
type Parts = Option<Vec<(String, f64)>>;

/// A job of the kind with a change.
fn job(kind: &str, test: &Value, pointer: &str, value: &Value) -> JobSpec {
    let mut body = json!({"kind": kind, "spec": {"version": 1,
        "grains": {"sizes": {"uniform": {"smallest_radius_m": 0.001, "largest_radius_m": 0.0015}}},
        "soil": {"density_kg_per_m3": 2650, "youngs_modulus_pa": 2e8, "stiffness_ratio": 0.3,
            "friction_angle_rad": 0.5, "rolling_resistance": {"rolling_friction": 0.1}},
        "preparation": {"friction_factor": 0.1},
        "accuracy": "draft",
        "test": test}});
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    body["spec"].pointer_mut(parent).expect("a place")[name] = value.clone();
    let job = Submission::from_slice(body.to_string().as_bytes());
    job.expect("a valid job").spec
}

fn triaxial(pointer: &str, value: &Value) -> SoilTriaxial {
    let test = json!({"width_m": 0.0155, "height_m": 0.0225, "confining_pressure_pa": 1e5,
        "axial_strain": 0.15});
    let JobSpec::Triaxial(spec) = job("triaxial", &test, pointer, value) else {
        panic!("another kind")
    };
    *spec
}

fn direct_shear(pointer: &str, value: &Value) -> SoilDirectShear {
    let test =
        json!({"length_m": 0.027, "width_m": 0.0155, "height_m": 0.0155, "normal_stress_pa": 1e5});
    let JobSpec::DirectShear(spec) = job("direct_shear", &test, pointer, value) else {
        panic!("another kind")
    };
    *spec
}

/// Parts of the errors of peak and dilatancy, and what is said.
fn told<T: Tabled>(spec: &Soil<T>) -> ([Parts; 2], Option<String>) {
    let mut report = Report::default();
    for (name, value) in [
        ("peak_friction_angle", ANGLE),
        ("dilatancy_angle", DILATANCY),
        ("simulated_time", 1.0),
    ] {
        let quantity = Quantity::new(value, "", "");
        report.summary.insert(name.to_owned(), quantity);
    }
    let words = add(&mut report, spec);
    assert_eq!(report.summary["simulated_time"].error, None);
    let parts = ["peak_friction_angle", "dilatancy_angle"].map(|name| {
        let parts = report.summary[name].error.clone()?.parts.into_iter();
        Some(parts.map(|part| (part.source, part.value)).collect())
    });
    (parts, words)
}

/// What the table says of a test at a level of the preset; of dilatancy over the angle at the peak.
fn tabled<T: Tabled>(level: usize) -> [Parts; 2] {
    let table: Value = serde_json::from_str(T::ERRORS).expect("a table");
    ["peak_friction_angle", "dilatancy_angle"].map(|name| {
        let parts = [("specimens", 0), ("preset", level)].map(|(source, level)| {
            let error = &table["sources"][source][level]["errors"][name];
            (source.to_owned(), ANGLE * error.as_f64().expect("a number"))
        });
        let parts = parts.into_iter().filter(|(_, value)| *value > 0.0);
        Some(parts.collect())
    })
}

#[test]
fn an_error_has_what_specimens_differ_by_and_what_the_preset_is_off() {
    // that of a reference was not measured: it has the error of the next coarser
    for (level, preset) in [(0, "draft"), (1, "standard"), (1, "reference")] {
        let preset = json!(preset);
        let spec = triaxial("/accuracy", &preset);
        assert_eq!(told(&spec), (tabled::<Triaxial>(level), None), "{preset}");
        let spec = direct_shear("/accuracy", &preset);
        assert_eq!(
            told(&spec),
            (tabled::<DirectShear>(level), None),
            "{preset}"
        );
    }
}

#[test]
fn a_given_rate_counts_by_its_inertial_number() {
    let unit = {
        let spec = triaxial("/accuracy", &json!("draft"));
        spec.pace().test / (3f64.sqrt() * spec.accuracy.knobs().inertial_number)
    };
    // draft has 1e-3, standard 3e-4 at a step of 0.3
    for (number, expected) in [
        (9e-4, tabled::<Triaxial>(0)),
        (2e-4, tabled::<Triaxial>(1)),
        (2e-3, [None, None]),
    ] {
        let mut spec = triaxial("/accuracy", &json!("standard"));
        spec.test.axial_strain_rate_per_s = Some(number * unit);
        assert_eq!(told(&spec).0, expected, "{number}");
    }
    let spec = direct_shear("/test/shear_velocity_m_per_s", &json!(1.0));
    assert!(
        told(&spec)
            .1
            .expect("a reason")
            .contains("coarser than in draft")
    );
}

#[test]
fn size_and_modulus_alone_change_nothing() {
    let spec = triaxial("/accuracy", &json!("draft"));
    let mut other = spec.clone();
    other.soil.youngs_modulus_pa *= 100.0;
    other.test.confining_pressure_pa *= 100.0;
    other.soil.density_kg_per_m3 *= 3.0;
    assert_eq!(told(&other), told(&spec));
}

#[test]
fn what_was_not_measured_has_no_error_and_says_why() {
    for (pointer, value, reason) in [
        ("/laws", json!({"local_damping": 0.5}), "laws"),
        ("/laws", json!({"contact": "hertz_mindlin"}), "laws"),
        (
            "/grains/sizes",
            json!({"radius_m": 0.00125}),
            "evenly spread",
        ),
        (
            "/soil/rolling_resistance",
            json!({"rolling_friction": 0.1, "twisting_friction": 0.1}),
            "not twisting",
        ),
        (
            "/soil/rolling_resistance",
            json!(null),
            "rolling_friction is",
        ),
        ("/soil/restitution", json!(0.5), "laws"),
        (
            "/preparation/friction_factor",
            json!(1.0),
            "preparation_friction_factor is",
        ),
        ("/test/axial_strain", json!(0.02), "way is"),
        ("/test/height_m", json!(0.05), "height_over_width is"),
    ] {
        let (parts, words) = told(&triaxial(pointer, &value));
        assert_eq!(parts, [None, None], "{pointer}");
        let words = words.expect("a reason");
        assert!(
            words.contains("no error") && words.contains(reason),
            "{pointer}: {words}"
        );
    }
}

#[test]
fn a_modulus_that_a_warning_doubts_has_no_error() {
    let has_error = |is_doubted: bool| {
        let mut report = Report::default();
        for name in ["secant_modulus", "peak_friction_angle"] {
            let quantity = Quantity::new(ANGLE, "", "");
            report.summary.insert(name.to_owned(), quantity);
        }
        if is_doubted {
            report.warnings.push(Warning {
                code: "secant_modulus".to_owned(),
                detail: String::new(),
            });
        }
        add(&mut report, &triaxial("/accuracy", &json!("draft")));
        ["secant_modulus", "peak_friction_angle"].map(|name| report.summary[name].error.is_some())
    };
    assert_eq!(has_error(false), [true, true]);
    assert_eq!(has_error(true), [false, true]);
}
