//! Oblique impacts against Yade 2023.02a, step by step the same algorithm.
//!
//! `impacts.jsonl` is what `tests/granular/yade_impacts.py` printed.
use serde_json::{Value, json};

use super::{body, contact, run};

/// Round-off of some hundred steps, relative to the largest component.
const ROUND_OFF: f64 = 1e-10;

fn scene(case: &Value) -> Value {
    let is_wall = case["wall"] == true;
    let material = |density: f64, modulus: f64, ratio: f64| json!({"density_kg_per_m3": density, "youngs_modulus_pa": modulus, "stiffness_ratio": ratio, "friction_angle_rad": case["phi"]});
    let down = if is_wall { -1.0 } else { 0.7 };
    let mut bodies = vec![json!({
        "sphere": {"radius_m": 0.01}, "material": "a", "position_m": [0, 0, 0.01005],
        "velocity_m_per_s": [0.3, -0.2, down], "angular_velocity_rad_per_s": [-10, 7, 15]})];
    let (mut planes, mut facets) = (Vec::new(), Vec::new());
    if case["facet"].is_array() {
        facets.push(json!({"name": "plate", "triangles_m": [case["facet"]], "material": "b"}));
    } else if is_wall {
        planes.push(
            json!({"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "b"}),
        );
    } else {
        bodies.push(json!({
            "sphere": {"radius_m": 0.015}, "material": "b", "position_m": [0.006, -0.004, 0.0344],
            "velocity_m_per_s": [0.1, 0.2, -1.5], "angular_velocity_rad_per_s": [5, -3, 20]}));
    }
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {"a": material(2600.0, 1e8, 0.3), "b": material(1800.0, 3e8, 0.4)},
        "bodies": bodies, "planes": planes, "facets": facets,
        "laws": {"local_damping": case["damping"], "convention": "yade"},
        "time_step_s": case["dt"],
        "stages": [{"run": {"steps": case["steps"]}}],
        "record": {"every_steps": 1, "contacts": true}
    })
}

#[track_caller]
fn assert_same(name: &str, found: [f64; 3], expected: &Value) {
    let expected: Vec<f64> = serde_json::from_value(expected.clone()).expect("three numbers");
    let scale = expected
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    for (found, expected) in found.iter().zip(&expected) {
        assert!(
            (found - expected).abs() <= ROUND_OFF * scale,
            "{name}: {found:e} is not {expected:e}"
        );
    }
}

#[test]
fn oblique_impacts_follow_yade() {
    for line in include_str!("impacts.jsonl").lines() {
        let case: Value = serde_json::from_str(line).expect("a line is a case");
        let name = case["name"].as_str().expect("a name");
        let (_, record) = run(&scene(&case));
        let rows = record.table("contacts.csv").len() as u64;
        assert_eq!(Some(rows), case["touched"].as_u64(), "{name}");
        let middle = &case["middle"];
        let step = middle["step"].as_u64().expect("a step");
        let (overlap, [_, normal_force, shear_force]) =
            contact(&record, step, [0, 1]).expect("they touch");
        let expected = middle["overlap"].as_f64().expect("a number");
        assert!((overlap - expected).abs() < ROUND_OFF * expected, "{name}");
        assert_same(name, normal_force, &middle["fn"]);
        assert_same(name, shear_force, &middle["fs"]);
        for (number, state) in (0..).zip(case["states"].as_array().expect("states")) {
            for (part, found) in body(&record, case["steps"].as_u64().expect("steps"), number)
                .into_iter()
                .enumerate()
            {
                assert_same(name, found, &state[part]);
            }
        }
    }
}
