//! A block on a slope: it stays below the angle of friction and slides above it.
use serde_json::{Value, json};

use super::{assert_close, body, run};

const SLOPE: f64 = 0.4;

/// A clump of four spheres, too low to tip or roll, on a plane with gravity inclined by [`SLOPE`].
fn block(friction: f64, damping: f64) -> Value {
    let foot = |x: f64, y: f64| json!({"offset_m": [x, y, 0], "radius_m": 0.01});
    let (s, c) = SLOPE.sin_cos();
    json!({
        "version": 1, "gravity_m_per_s2": [9.81 * s, 0, -9.81 * c],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": friction}},
        "bodies": [{"clump": {"members": [foot(-0.1, -0.1), foot(0.1, -0.1), foot(-0.1, 0.1), foot(0.1, 0.1)]},
                    "material": "stone", "position_m": [0, 0, 0.01]}],
        "planes": [{"name": "slope", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
        "laws": {"local_damping": damping},
        "time_step_s": 1e-5,
        "stages": [{"run": {"steps": 50_000}}],
        "record": {"every_steps": 10_000, "planes": ["slope"]}
    })
}

#[test]
fn a_block_slides_above_the_angle_of_friction() {
    let friction: f64 = 0.3;
    let (_, record) = run(&block(friction, 0.0));
    let time = 0.5;
    let acceleration = 9.81 * (SLOPE.sin() - friction.tan() * SLOPE.cos());
    let [position, velocity, _] = body(&record, 50_000, 0);
    // it starts without load on its feet and bounces a little: friction follows the load
    assert_close(velocity[0], acceleration * time, 0.01 * acceleration * time);
    assert_close(
        position[0],
        0.5 * acceleration * time * time,
        0.01 * time * time,
    );
}

#[test]
fn a_block_stays_below_the_angle_of_friction() {
    let (_, record) = run(&block(0.5, 0.3));
    let [position, velocity, _] = body(&record, 50_000, 0);
    // it slips while its first bounces on its feet die away, by less than the springs give
    assert!(position[0].abs() < 2e-5, "{position:?}");
    assert!(velocity[0].abs() < 1e-9, "{velocity:?}");
}
