//! A free clump keeps energy and angular momentum however long it tumbles.
use serde_json::{Value, json};

use super::run;

fn tumbling(convention: &str, spin: [f64; 3], steps: u64, step: f64) -> Value {
    let member = |offset: [f64; 3]| json!({"offset_m": offset, "radius_m": 0.01});
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8}},
        "bodies": [{"clump": {"members": [member([-0.02, 0.0, 0.0]), member([0.02, 0.0, 0.0]),
                                          member([0.0, 0.012, 0.0]), member([0.0, -0.012, 0.0])]},
                    "material": "stone", "position_m": [0, 0, 0], "angular_velocity_rad_per_s": spin}],
        "laws": {"local_damping": 0.0, "convention": convention},
        "time_step_s": step,
        "stages": [{"run": {"steps": steps}}],
        "record": {"every_steps": steps / 100}
    })
}

/// Largest relative change of energy, and of angular momentum, over the recorded rows.
fn drift(spec: &Value) -> [f64; 2] {
    let (report, record) = run(spec);
    let rows = record.table("bodies.csv");
    // inertia at the end, turned back by the orientation there, is that of the body
    let last = rows.last().expect("rows");
    let turn = |row: &[f64]| {
        nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(
            row[12], row[13], row[14], row[15],
        ))
        .to_rotation_matrix()
        .into_inner()
    };
    let inertia = nalgebra::Matrix3::from(report.bodies[0].inertia_kg_m2).transpose();
    let own = turn(last).transpose() * inertia * turn(last);
    let invariants = |row: &Vec<f64>| {
        let spin = nalgebra::Vector3::new(row[9], row[10], row[11]);
        let momentum = turn(row) * own * turn(row).transpose() * spin;
        (0.5 * spin.dot(&momentum), momentum)
    };
    let (energy, momentum) = invariants(&rows[1]);
    let mut worst = [0.0_f64; 2];
    for row in &rows[1..] {
        let (energy_now, momentum_now) = invariants(row);
        worst[0] = worst[0].max((energy_now / energy - 1.0).abs());
        worst[1] = worst[1].max((momentum_now - momentum).norm() / momentum.norm());
    }
    worst
}

/// Rounding of 1e6 steps.
const ROUND_OFF: f64 = 1e-9;

#[test]
fn a_clump_tumbles_a_million_steps_without_drift() {
    // about an axis in between, and about the middle axis, where it turns over and over
    for spin in [[3.0, 5.0, 7.0], [1e-3, 10.0, 1e-3]] {
        let [energy, momentum] = drift(&tumbling("loadframe", spin, 1_000_000, 1e-4));
        // it swings by (ω Δt)² about its value and does not drift
        assert!(energy < 1e-6, "{energy}");
        assert!(momentum < ROUND_OFF, "{momentum}");
    }
}
