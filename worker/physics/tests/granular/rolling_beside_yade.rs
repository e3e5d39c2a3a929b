//! Impacts of spheres that resist rolling and twisting against Yade 2023.02a.
//!
//! `rolling.jsonl` is what `tests/granular/yade_rolling.py` printed. Yade's moments turn by a formula of
//! first order that lengthens them; ours keep their length.
use serde_json::{Value, json};

use super::{body, run};

/// Half the square of the angle by which the normal turns in a step, 4e-5, over 200 steps.
const SECOND_ORDER: f64 = 4e-7;

fn scene(case: &Value) -> Value {
    let resistance = json!({"rolling_friction": case["rolling"], "twisting_friction": case["twisting"],
                            "stiffness_ratio": case["ratio"]});
    let material = |density: f64, modulus: f64| {
        json!({"density_kg_per_m3": density, "youngs_modulus_pa": modulus, "stiffness_ratio": 0.3,
               "friction_angle_rad": case["phi"], "rolling_resistance": resistance})
    };
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {"a": material(2600.0, 1e8), "b": material(1800.0, 3e8)},
        "bodies": [
            {"sphere": {"radius_m": 0.01}, "material": "a", "position_m": [0, 0, 0.01005],
             "velocity_m_per_s": [0.3, -0.2, 0.7], "angular_velocity_rad_per_s": [-10, 7, 15]},
            {"sphere": {"radius_m": 0.015}, "material": "b", "position_m": [0.006, -0.004, 0.0344],
             "velocity_m_per_s": [0.1, 0.2, -1.5], "angular_velocity_rad_per_s": [5, -3, 20]}],
        "laws": {"local_damping": case["damping"], "convention": "yade"},
        "time_step_s": case["dt"],
        "stages": [{"run": {"steps": case["steps"]}}],
        "record": {"every_steps": 1, "contacts": true}
    })
}

#[track_caller]
fn assert_same(name: &str, found: &[f64], expected: &Value) {
    let expected: Vec<f64> = serde_json::from_value(expected.clone()).expect("three numbers");
    let largest = |most: f64, value: &f64| most.max(value.abs());
    let scale = expected.iter().fold(0.0, largest);
    for (found, expected) in found.iter().zip(&expected) {
        assert!(
            (found - expected).abs() <= SECOND_ORDER * scale,
            "{name}: {found:e} is not {expected:e}"
        );
    }
}

#[test]
fn impacts_of_spheres_that_resist_rolling_follow_yade() {
    for line in include_str!("rolling.jsonl").lines() {
        let case: Value = serde_json::from_str(line).expect("a line is a case");
        let name = case["name"].as_str().expect("a name");
        let (_, record) = run(&scene(&case));
        let rows = record.table("contacts.csv");
        assert_eq!(Some(rows.len() as u64), case["touched"].as_u64(), "{name}");
        let middle = &case["middle"];
        let step = middle["step"].as_f64().expect("a step");
        let row = rows.iter().find(|row| row[0].to_bits() == step.to_bits());
        let row = row.expect("they touch");
        assert_same(name, &row[7..10], &middle["fn"]);
        assert_same(name, &row[10..13], &middle["fs"]);
        // on the second body here, on the first there
        let moment: Vec<f64> = row[14..17].to_vec();
        assert_same(name, &moment, &middle["moment"]);
        for (number, state) in (0..).zip(case["states"].as_array().expect("states")) {
            let found = body(&record, case["steps"].as_u64().expect("steps"), number);
            for (part, found) in found.into_iter().enumerate() {
                assert_same(name, &found, &state[part]);
            }
        }
    }
}
