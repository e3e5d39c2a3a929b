//! What peers compute without a word is refused, or told.
use loadframe_physics::SimulationError;
use serde_json::{Value, json};

use super::{body, failure, run, sphere, submission};

fn scene(bodies: &[Value]) -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "bodies": bodies,
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
        "laws": {"local_damping": 0.3},
        "stages": [{"run": {"steps": 1000}}]
    })
}

fn codes(spec: &Value) -> Vec<(String, String)> {
    let violations = submission(spec).expect_err("this must be refused");
    violations
        .into_iter()
        .map(|violation| (violation.pointer, violation.code))
        .collect()
}

fn one(pointer: &str, code: &str) -> Vec<(String, String)> {
    vec![(pointer.to_owned(), code.to_owned())]
}

#[test]
fn bodies_inside_each_other_are_refused() {
    let at = |z: f64| sphere("stone", 0.01, [0.0, 0.0, z], [0.0; 3]);
    assert_eq!(
        codes(&scene(&[at(0.01), at(0.029)])),
        one("/spec/bodies/1/position_m", "overlap")
    );
    assert!(
        submission(&scene(&[at(0.01), at(0.0296)])).is_ok(),
        "4 % may overlap"
    );
    assert_eq!(
        codes(&scene(&[at(0.01), at(0.01)])),
        one("/spec/bodies/1/position_m", "equal_centres")
    );
    assert_eq!(
        codes(&scene(&[at(0.005)])),
        one("/spec/bodies/0/position_m", "overlap")
    );
    assert_eq!(
        codes(&scene(&[at(-0.5)])),
        one("/spec/bodies/0/position_m", "overlap")
    );
}

#[test]
fn an_unstable_step_is_refused_with_the_right_one() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    // 2√(m/K) with m = 4/3 π 2600 1e-6 kg and K = 1e8 · 0.01 N/m, or the shear mode's 3.5 · 0.3 K
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 2600.0 * 1e-6;
    let critical = 2.0 * (mass / (1.05 * 1e6_f64)).sqrt();
    spec["time_step_s"] = json!(1.01 * critical);
    assert_eq!(codes(&spec), one("/spec/time_step_s", "unstable"));
    spec["allow_unstable"] = json!(true);
    assert!(submission(&spec).is_ok());
    spec["allow_unstable"] = json!(false);
    spec["time_step_s"] = json!(0.99 * critical);
    assert!(submission(&spec).is_ok());
}

#[test]
fn a_body_that_would_tunnel_is_refused_or_stopped() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0, 0.0, -200.0])]);
    spec["time_step_s"] = json!(1e-5);
    assert_eq!(
        codes(&spec),
        one("/spec/bodies/0/velocity_m_per_s", "too_fast")
    );
    spec["time_step_s"] = json!("auto");
    let (_, record) = run(&spec);
    let [position, velocity, _] = body(&record, 1000, 0);
    assert!(
        position[2] > 0.01 && velocity[2] > 0.0,
        "it bounced: {position:?}"
    );
    // it becomes too fast only while it falls
    spec["bodies"] = json!([sphere("stone", 0.01, [0.0, 0.0, 1.0], [0.0; 3])]);
    spec["gravity_m_per_s2"] = json!([0, 0, -1e6]);
    spec["time_step_s"] = json!(1e-5);
    assert!(matches!(
        failure(&spec),
        SimulationError::TooFast { body: 0, .. }
    ));
}

#[test]
fn names_that_do_not_exist_are_all_told_at_once() {
    let mut spec = scene(&[sphere("chalk", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    spec["stages"] =
        json!([{"run": {}}, {"move_plane": {"name": "top", "velocity_m_per_s": -0.1, "steps": 5}}]);
    spec["record"] = json!({"bodies": [3], "planes": ["lid"]});
    let expected = [
        ("/spec/bodies/0/material", "no_such_material"),
        ("/spec/stages/0/run", "not_one_duration"),
        ("/spec/stages/1/move_plane/name", "no_such_plane"),
        ("/spec/record/planes/0", "no_such_plane"),
        ("/spec/record/bodies/0", "no_such_body"),
    ];
    let expected: Vec<(String, String)> = expected
        .iter()
        .map(|(p, c)| ((*p).to_owned(), (*c).to_owned()))
        .collect();
    assert_eq!(codes(&spec), expected);
}

#[test]
fn unknown_fields_are_refused() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    spec["facets"] = json!([]);
    spec["bodies"][0]["colour"] = json!("red");
    spec["stages"] = json!([{"explode": {"steps": 10}}]);
    let mut found = codes(&spec);
    found.sort();
    assert!(
        found
            .iter()
            .any(|(pointer, code)| pointer == "/spec/facets" && code == "unknown_field"),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|(pointer, _)| pointer == "/spec/bodies/0/colour"),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|(pointer, _)| pointer.starts_with("/spec/stages/0")),
        "{found:?}"
    );
}

#[test]
fn bodies_that_leave_are_told_of() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [10.0, 0.0, 0.0])]);
    spec["gravity_m_per_s2"] = json!([0, 0, 0]);
    spec["stages"] = json!([{"run": {"time_s": 0.1}}]);
    let (report, _) = run(&spec);
    assert_eq!(report.summary["escaped_bodies"].value, Some(1.0));
    assert!(
        report
            .warnings
            .iter()
            .any(|warning| warning.code == "escaped_bodies")
    );
}
