//! Planes with a stiffness of their own, and clumps on them that are pushed beside their middle.
use serde_json::{Value, json};

use super::{assert_close, codes, one, run, scene::Record, sphere};

/// K of the plane [N/m].
const MAT: f64 = 1e6;
/// Stones are so stiff that the plane alone gives way: E 2r is 2e4 and more times K.
const MODULUS: f64 = 1e12;
const FORCE: f64 = 100.0;
/// ω Δt = 0.2 of the lightest stone on the mat.
const STEP: f64 = 2e-5;

/// `bodies` on a mat, of which the first is pushed down at a place.
fn scene(bodies: &Value, at: &Value) -> Value {
    let mut force = json!({"force_n": [0, 0, -FORCE]});
    if !at.is_null() {
        force["at_m"] = at.clone();
    }
    json!({
        "version": 1,
        "gravity_m_per_s2": [0, 0, 0],
        "materials": {
            "stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": MODULUS, "friction_angle_rad": 0},
            // a modulus that does not count
            "rubber": {"density_kg_per_m3": 1000, "youngs_modulus_pa": 1e3, "friction_angle_rad": 0}
        },
        "bodies": bodies,
        "planes": [{"name": "mat", "axis": "z", "position_m": 0, "facing": 1, "material": "rubber",
            "contact_stiffness_n_per_m": MAT}],
        "laws": {"local_damping": 0.5},
        // an automatic one would fear stone on stone
        "time_step_s": STEP,
        "stages": [{"drive": {"bodies": [{"body": 0, "force": force}], "time_s": 0.5}}],
        "record": {"every_steps": 1000}
    })
}

/// K and the stone's E 2r in series [N/m].
fn stiffness(radius: f64) -> f64 {
    let stone = MODULUS * 2.0 * radius;
    MAT * stone / (MAT + stone)
}

fn last(record: &Record, column: &str) -> f64 {
    *record.column(column).last().expect("rows")
}

/// A clump of two spheres 2a apart along x, free to sink and to turn about y.
fn beam(arm: f64) -> Value {
    let member = |x: f64| json!({"offset_m": [x, 0, 0], "radius_m": 0.01});
    json!([{"clump": {"members": [member(-arm), member(arm)]}, "material": "stone",
        "position_m": [0, 0, 0.01], "fixed": ["x", "y", "rx", "rz"]}])
}

#[test]
fn a_mat_gives_way_by_force_over_stiffness_whatever_the_radius() {
    for radius in [0.01, 0.03] {
        let bodies = json!([sphere("stone", radius, [0.0, 0.0, radius], [0.0; 3])]);
        let (report, record) = run(&scene(&bodies, &Value::Null));
        let way = last(&record, "body_0_displacement_z_m");
        let expected = -FORCE / stiffness(radius);
        assert_close(way, expected, 1e-9 * expected.abs());
        // K alone, but for what the stone gives way
        assert_close(way, -FORCE / MAT, 1e-4 * FORCE / MAT);
        assert_close(last(&record, "body_0_force_z_n"), FORCE, 1e-7 * FORCE);
        assert!(report.quality["step_over_critical"].ok);
    }
}

#[test]
fn a_moduli_change_reaches_a_mat_too() {
    let bodies = json!([sphere("stone", 0.01, [0.0, 0.0, 0.01], [0.0; 3])]);
    let mut spec = scene(&bodies, &Value::Null);
    let stages = spec["stages"].as_array_mut().expect("stages");
    stages.insert(0, json!({"stiffen": {"factor": 4, "steps": 100}}));
    let (_, record) = run(&spec);
    let expected = -FORCE / (4.0 * stiffness(0.01));
    assert_close(
        last(&record, "body_0_displacement_z_m"),
        expected,
        1e-9 * expected.abs(),
    );
}

/// Two springs K at ±a under a force F at e: u = F/2K, θ = F e/(2 K a²).
#[test]
fn a_beam_on_two_springs_tilts_by_the_moment_of_its_load() {
    let arm = 0.1;
    for place in [0.0, 0.05, -0.02] {
        let mut spec = scene(&beam(arm), &json!([place, 0, 0]));
        spec["record"]["turns"] = json!([0]);
        let (_, record) = run(&spec);
        let spring = stiffness(0.01);
        let sunk = -FORCE / (2.0 * spring);
        let turn = FORCE * place / (2.0 * spring * arm * arm);
        assert_close(
            last(&record, "body_0_displacement_z_m"),
            sunk,
            1e-7 * sunk.abs(),
        );
        // the arm of the springs shortens by a part θ²/2
        assert_close(
            last(&record, "body_0_turn_y_rad"),
            turn,
            1e-6 * turn.abs() + 1e-15,
        );
        assert_close(last(&record, "body_0_turn_x_rad"), 0.0, 1e-15);
    }
}

#[test]
fn what_has_no_orientation_or_no_springs_is_refused() {
    let ball = json!([sphere("stone", 0.01, [0.0, 0.0, 0.01], [0.0; 3])]);
    let spec = scene(&ball, &json!([0.001, 0, 0]));
    let pointer = "/spec/stages/0/drive/bodies/0/force/at_m";
    assert_eq!(codes(&spec), one(pointer, "not_a_clump"));
    let mut spec = scene(&ball, &Value::Null);
    spec["record"]["turns"] = json!([0]);
    assert_eq!(codes(&spec), one("/spec/record/turns/0", "not_a_clump"));
    let mut spec = scene(&beam(0.1), &Value::Null);
    spec["record"]["turns"] = json!([1]);
    assert_eq!(codes(&spec), one("/spec/record/turns/0", "no_such_body"));
    let mut spec = scene(&ball, &Value::Null);
    spec["laws"]["contact"] = json!("hertz_mindlin");
    let pointer = "/spec/planes/0/contact_stiffness_n_per_m";
    assert_eq!(codes(&spec), one(pointer, "not_together"));
}
