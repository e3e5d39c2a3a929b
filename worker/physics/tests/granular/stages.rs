//! Stages end when they should, and planes do what they are told.
use serde_json::{Value, json};

use super::{assert_close, body, run};

const RADIUS: f64 = 0.01;
/// E r: sphere and plane in series.
const STIFFNESS: f64 = 1e5;

/// A sphere between a base and a lid that just touches it, without gravity.
fn press(stages: &Value) -> Value {
    let plane = |name: &str, at: f64, facing: i32| json!({"name": name, "axis": "z", "position_m": at, "facing": facing, "material": "stone"});
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7}},
        "bodies": [{"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, RADIUS]}],
        "planes": [plane("base", 0.0, 1), plane("lid", 2.0 * RADIUS, -1)],
        "laws": {"local_damping": 0.5},
        "stages": stages,
        "record": {"every_steps": 10, "planes": ["lid", "base"]}
    })
}

#[test]
fn a_loaded_plane_comes_to_rest_where_the_springs_carry_it() {
    let force = 20.0;
    let stages = json!([{"load_plane": {"name": "lid", "mass_kg": 0.01, "force_n": -force, "steps": 20_000}}]);
    let (_, record) = run(&press(&stages));
    let last = record.points.len() - 1;
    // two springs of stiffness K, one above the other
    assert_close(
        record.column("lid_displacement_m")[last],
        -2.0 * force / STIFFNESS,
        1e-9,
    );
    assert_close(record.column("lid_force_n")[last], force, 1e-6);
    assert_close(record.column("base_force_n")[last], -force, 1e-6);
}

#[test]
fn a_swinging_load_returns_to_where_it_began() {
    let stages = json!([
        {"load_plane": {"name": "lid", "mass_kg": 0.01, "force_n": -5, "time_s": 0.1}},
        {"load_plane": {"name": "lid", "mass_kg": 0.01, "force_n": -5, "peak_force_n": -25, "period_s": 0.2, "time_s": 0.2}}]);
    let (_, record) = run(&press(&stages));
    let displacement = record.column("lid_displacement_m");
    let deepest = displacement
        .iter()
        .fold(0.0_f64, |most, value| most.min(*value));
    // quasi-static: the swing is a hundred times slower than the spring
    assert_close(deepest, -50.0 / STIFFNESS, 0.01 * 50.0 / STIFFNESS);
    assert_close(
        displacement[displacement.len() - 1],
        -10.0 / STIFFNESS,
        0.01 * 50.0 / STIFFNESS,
    );
}

#[test]
fn a_moved_plane_presses_by_its_way() {
    let stages = json!([{"move_plane": {"name": "lid", "velocity_m_per_s": -1e-3, "time_s": 0.1}}, {"run": {"time_s": 0.05}}]);
    let (_, record) = run(&press(&stages));
    let last = record.points.len() - 1;
    let moved = record.column("lid_displacement_m")[last];
    assert_close(moved, -1e-4, 1e-7);
    assert_close(
        record.column("lid_force_n")[last],
        -0.5 * STIFFNESS * moved,
        1e-3,
    );
}

#[test]
fn settling_ends_at_rest_and_says_when_it_does_not() {
    let scene = |steps: u64| {
        json!({
            "version": 1,
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.5}},
            "bodies": [{"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, 0.02]},
                       {"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0.03, 0, 0.015]}],
            "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
            "stages": [{"settle": {"unbalanced_force_ratio": 1e-4, "steps": steps}}, {"run": {"steps": 10}}]
        })
    };
    let (report, record) = run(&scene(1_000_000));
    let steps = report.summary["steps"].value.expect("steps are counted");
    assert!(steps < 100_000.0, "{steps}");
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let [position, _, _] = body(&record, steps as u64, 0);
    // the weight of a sphere on its spring
    let weight = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 9.81;
    assert_close(
        position[2],
        RADIUS - weight / STIFFNESS,
        1e-3 * weight / STIFFNESS,
    );
    let (report, _) = run(&scene(100));
    assert_eq!(report.warnings[0].code, "not_settled");
}
