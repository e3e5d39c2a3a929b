//! Scenes at the ends of what may be asked for.
use serde_json::{Value, json};

use super::{assert_close, body, run, sphere};

fn scene(material: Value, bodies: &[Value], steps: u64) -> Value {
    json!({
        "version": 1,
        "materials": {"stone": material},
        "bodies": bodies,
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
        "stages": [{"run": {"steps": steps}}],
        "record": {"every_steps": steps, "planes": ["base"], "contacts": true, "snapshot_every_steps": steps}
    })
}

fn stone(density: f64, modulus: f64, friction_angle: f64) -> Value {
    json!({"density_kg_per_m3": density, "youngs_modulus_pa": modulus, "friction_angle_rad": friction_angle})
}

/// One above the other, not touching: light and stiff grains would fly off an overlap.
fn two() -> Vec<Value> {
    vec![
        sphere("stone", 0.01, [0.0, 0.0, 0.01], [0.0; 3]),
        sphere("stone", 0.01, [0.001, 0.0, 0.0302], [0.1, 0.0, 0.0]),
    ]
}

#[test]
fn a_scene_without_bodies_runs() {
    let (report, record) = run(&scene(stone(2600.0, 1e8, 0.5), &[], 1000));
    assert_eq!(report.summary["steps"].value, Some(1000.0));
    assert_eq!(record.column("base_force_n"), [0.0, 0.0]);
}

#[test]
fn everything_fixed_stays() {
    let mut bodies = two();
    for body in &mut bodies {
        body["fixed"] = json!(["x", "y", "z", "rx", "ry", "rz"]);
        body["velocity_m_per_s"] = json!([0, 0, 0]);
    }
    let (report, record) = run(&scene(stone(2600.0, 1e8, 0.5), &bodies, 1000));
    let [position, velocity, _] = body(&record, 1000, 1);
    assert_close(position[2], 0.0302, 0.0);
    assert_close(velocity[2], 0.0, 0.0);
    assert_eq!(report.summary["contacts"].value, Some(0.0));
}

#[test]
fn a_fixed_body_with_a_velocity_moves_at_it() {
    let mut moving = sphere("stone", 0.01, [0.0, 0.0, 0.1], [0.5, 0.0, 0.0]);
    moving["fixed"] = json!(["x", "z"]);
    let mut spec = scene(stone(2600.0, 1e8, 0.5), &[moving], 1000);
    spec["time_step_s"] = json!(1e-6);
    spec["gravity_m_per_s2"] = json!([0, -1, -9.81]);
    spec["laws"] = json!({"local_damping": 0.0});
    let (_, record) = run(&spec);
    let [position, velocity, _] = body(&record, 1000, 0);
    assert_close(position[0], 0.5e-3, 1e-15);
    assert_close(velocity[1], -1e-3, 1e-15);
    assert_close(position[2], 0.1, 0.0);
}

#[test]
fn materials_from_foam_to_rigid_and_from_air_to_lead_do_not_explode() {
    for density in [1e-3, 2600.0, 1e6] {
        for modulus in [1e6, 1e9, 1e12] {
            for friction in [0.0, 0.5, 1.570_795_3] {
                let (report, record) =
                    run(&scene(stone(density, modulus, friction), &two(), 20_000));
                let case = format!("{density} {modulus} {friction}");
                for number in [0, 1] {
                    let [_, velocity, _] = body(&record, 20_000, number);
                    let speed = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
                    assert!(speed < 2.0, "{case}: {speed}");
                }
                assert!(
                    report.quality["created_energy_ratio"].ok,
                    "{case}: {:?}",
                    report.quality
                );
            }
        }
    }
}

/// E 1e3 Pa carries grains of a centimetre only when they are light.
#[test]
fn a_soft_grain_rests_where_its_spring_carries_it() {
    let grain = sphere("stone", 0.01, [0.0, 0.0, 0.01], [0.0; 3]);
    let (_, record) = run(&scene(stone(10.0, 1e3, 0.5), &[grain], 20_000));
    let weight = 10.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 9.81;
    let [position, _, _] = body(&record, 20_000, 0);
    // E r = 10 N/m
    assert_close(position[2], 0.01 - weight / 10.0, 1e-8);
}

/// A pile of grains in a corner, damped, for a million steps.
#[test]
fn a_bed_at_rest_does_not_drift() {
    let mut bodies = Vec::new();
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let [x, y] = [x, y].map(|place: i32| 0.01 + 0.02 * f64::from(place));
        bodies.push(sphere("stone", 0.01, [x, y, 0.01], [0.0; 3]));
    }
    bodies.push(sphere(
        "stone",
        0.01,
        [0.02, 0.02, 0.01 + 0.02 / 2.0_f64.sqrt()],
        [0.0; 3],
    ));
    let mut spec = scene(stone(2600.0, 1e8, 0.5), &bodies, 1_100_000);
    let plane = |name: &str, axis: &str, at: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": at, "facing": facing, "material": "stone"});
    spec["planes"] = json!([
        plane("base", "z", 0.0, 1),
        plane("left", "x", 0.0, 1),
        plane("right", "x", 0.04, -1),
        plane("front", "y", 0.0, 1),
        plane("back", "y", 0.04, -1)
    ]);
    spec["record"]["every_steps"] = json!(100_000);
    let (report, record) = run(&spec);
    for number in 0..5 {
        let (early, late) = (
            body(&record, 100_000, number),
            body(&record, 1_100_000, number),
        );
        for axis in 0..3 {
            // overlaps are of the order of 1e-7 m
            assert_close(late[0][axis], early[0][axis], 1e-12);
            assert_close(late[1][axis], 0.0, 1e-9);
        }
    }
    assert!(report.summary["unbalanced_force_ratio"].value < Some(1e-6));
}

#[test]
fn steps_from_a_nanosecond_to_a_millisecond() {
    let grain = sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3]);
    for (step, modulus) in [(1e-9, 1e8), (1e-3, 1e4)] {
        let mut spec = scene(
            stone(2600.0, modulus, 0.5),
            std::slice::from_ref(&grain),
            1000,
        );
        spec["time_step_s"] = json!(step);
        let (report, _) = run(&spec);
        assert_close(
            report.summary["simulated_time"].value.expect("time"),
            1000.0 * step,
            1e-12,
        );
    }
}

/// Grains a hundred times smaller than others are found, and carry them.
#[test]
fn dust_under_a_grain_carries_it() {
    let mut bodies = vec![sphere("stone", 0.05, [0.0, 0.0, 0.051], [0.0; 3])];
    for (x, y) in [(-1, -1), (-1, 1), (1, -1), (1, 1), (0, 0)] {
        let [x, y] = [x, y].map(|place: i32| 0.002 * f64::from(place));
        let mut grain = sphere("stone", 0.0005, [x, y, 0.0005], [0.0; 3]);
        grain["fixed"] = json!(["x", "y", "rx", "ry", "rz"]);
        bodies.push(grain);
    }
    let (report, record) = run(&scene(stone(2600.0, 1e8, 0.5), &bodies, 50_000));
    let [position, _, _] = body(&record, 50_000, 0);
    assert!(position[2] > 0.0505, "{position:?}");
    assert!(report.summary["escaped_bodies"].value == Some(0.0));
}
