//! Stages end when they should, and planes do what they are told.
use serde_json::{Value, json};

use super::{assert_close, body, run, submission};

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

#[test]
fn rows_and_snapshots_can_begin_with_a_stage() {
    let mut spec = json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -1],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7}},
        "bodies": [{"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, 0]}],
        "time_step_s": 1e-5,
        "stages": [{"run": {"steps": 25}}, {"run": {"steps": 25}}, {"run": {"steps": 25}}],
        "record": {"every_steps": 10, "from_stage": 2, "snapshot_every_steps": 10}
    });
    let (_, record) = run(&spec);
    assert_eq!(record.column("step"), [0.0, 25.0, 50.0, 60.0, 70.0, 75.0]);
    let series = std::str::from_utf8(&record.files["snapshots.pvd"]).expect("text");
    assert_eq!(series.matches("<DataSet").count(), 6, "{series}");
    spec["record"]["from_stage"] = json!(3);
    let refused = submission(&spec).expect_err("three stages");
    assert_eq!(refused[0].pointer, "/spec/record/from_stage");
}

/// A free sphere follows the table's acceleration: v = A/ω (1 − cos ωt) along x, then along y.
#[test]
fn vibration_takes_turns_along_its_axes() {
    let (amplitude, frequency) = (3.0, 50.0);
    let omega = std::f64::consts::TAU * frequency;
    let spec = json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -1],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7}},
        "bodies": [{"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, 0]}],
        "laws": {"local_damping": 0.0},
        "time_step_s": 1e-5,
        "stages": [{"vibrate": {"acceleration_m_per_s2": amplitude, "frequency_hz": frequency, "time_s": 0.05}},
                   {"run": {"time_s": 0.01}}],
        "record": {"every_steps": 500}
    });
    let (_, record) = run(&spec);
    let mean = amplitude / omega;
    // velocities are those of half steps, and sums over steps: both first order
    let tolerance = 2.0 * amplitude * 1e-5;
    for (step, along_x, along_y) in [
        (500, 1.0 - (omega * 0.005).cos(), 0.0),
        (1000, 2.0, 0.0),
        (2000, 0.0, 0.0),
        (3000, 0.0, 2.0),
        (4000, 0.0, 0.0),
        (5000, 2.0, 0.0),
        (6000, 2.0, 0.0),
    ] {
        let [_, velocity, _] = body(&record, step, 0);
        assert_close(velocity[0], mean * along_x, tolerance);
        assert_close(velocity[1], mean * along_y, tolerance);
        assert_close(velocity[2], -(step as f64) * 1e-5, 1e-12);
    }
}

/// A sphere that may not turn, on a floor that is tilted through gravity: it holds, slides while
/// friction is reduced, and is stopped again when it is restored.
#[test]
fn friction_is_reduced_while_vibrating_and_restored_after() {
    let friction: f64 = 0.5;
    let (along, down) = (1.0, 9.0);
    let (factor, damping) = (0.1, 0.3);
    let spec = json!({
        "version": 1, "gravity_m_per_s2": [along, 0, -down],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "friction_angle_rad": friction}},
        "bodies": [{"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, RADIUS], "fixed": ["rx", "ry", "rz"]}],
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
        "laws": {"local_damping": damping},
        "time_step_s": 1e-5,
        "stages": [{"run": {"steps": 20_000}},
                   {"vibrate": {"acceleration_m_per_s2": 0, "frequency_hz": 10, "friction_factor": factor, "time_s": 0.2}},
                   {"run": {"time_s": 0.2}}],
        "record": {"every_steps": 2000, "contacts": true}
    });
    let (report, record) = run(&spec);
    let at = |step: u64| body(&record, step, 0);
    assert_close(at(20_000)[1][0], 0.0, 1e-6);
    let slides = (1.0 - damping) * (along - factor * friction.tan() * down);
    assert_close(at(40_000)[1][0], slides * 0.2, 1e-3 * slides * 0.2);
    assert_close(at(60_000)[1][0], 0.0, 1e-6);
    assert!(report.quality["created_energy_ratio"].ok, "{report:?}");
    super::determinism::assert_resumes(&spec, 40);
}
