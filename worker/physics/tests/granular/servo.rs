//! Planes that follow the force on them, against closed forms.
use serde_json::{Value, json};

use super::{
    assert_close, codes,
    laws::{MODULUS, mass, scene},
    one, run, run_on, sphere,
};

const RADIUS: f64 = 0.01;
/// k_N of equal spheres of this stone, and of one and a plane [N/m].
const STIFFNESS: f64 = MODULUS * RADIUS;

/// Spheres above each other between a base and a servo; the lowest just touches, and the top too.
fn column(spheres: usize, fixed: &[&str], servo: &Value, step: f64, steps: u64) -> Value {
    let bodies: Vec<Value> = (0..spheres)
        .map(|number| {
            let height = RADIUS * (2 * number + 1) as f64;
            let mut body = sphere("stone", RADIUS, [0.0, 0.0, height], [0.0; 3]);
            body["fixed"] = json!(fixed);
            body
        })
        .collect();
    let mut spec = scene("linear", &json!({}), &bodies, step, steps);
    let plane = |name: &str, axis: &str, position: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": position, "facing": facing, "material": "stone"});
    spec["planes"] = json!([
        plane("base", "z", 0.0, 1),
        plane("top", "z", 2.0 * RADIUS * spheres as f64, -1)
    ]);
    spec["stages"] =
        json!([{"drive": {"walls": [{"name": "top", "servo": servo}], "steps": steps}}]);
    spec["record"] = json!({"every_steps": 1, "bodies": []});
    spec
}

/// Of a contact alone the missing force is (1 − gain)ⁿ of what it was.
#[test]
fn a_servo_makes_good_a_part_of_what_is_missing_in_every_step() {
    let (force, gain) = (40.0, 0.3);
    let servo = json!({"force_n": force, "largest_velocity_m_per_s": 100, "gain": gain});
    let held = ["x", "y", "z", "rx", "ry", "rz"];
    let spec = column(1, &held, &servo, 1e-6, 40);
    let (report, record) = run(&spec);
    let forces = record.column("top_force_z_n");
    // nothing presses at first: the first row is the state before
    for pair in forces[1..30].windows(2) {
        let [before, after] = [force - pair[0], force - pair[1]];
        assert_close(after, (1.0 - gain) * before, 1e-9 * force);
    }
    assert!(forces.iter().all(|found| *found <= force), "{forces:?}");
    assert!(report.quality["servo_force_error"].ok, "{report:?}");
}

/// A column under a wall at speed v carries v √(k m), twice that where the wave comes back: no more
/// than that is beyond the force asked for. At rest its 11 springs have given way by 11 F/k.
#[test]
fn a_column_of_spheres_comes_to_the_force_and_not_beyond_what_its_inertia_takes() {
    let (force, speed, spheres) = (100.0, 0.01, 10);
    let servo = json!({"force_n": force, "largest_velocity_m_per_s": speed});
    let mut spec = column(spheres, &["x", "y"], &servo, 2e-5, 15_000);
    spec["laws"]["local_damping"] = json!(0.3);
    let (report, record) = run(&spec);
    let forces = record.column("top_force_z_n");
    let largest = forces.iter().copied().fold(0.0, f64::max);
    let wave = speed * (STIFFNESS * mass(RADIUS)).sqrt();
    assert!(largest <= force + 2.0 * wave, "{largest} {wave}");
    assert_close(forces[forces.len() - 1], force, 1e-3 * force);
    let ways = record.column("top_displacement_z_m");
    let given = 11.0 * force / STIFFNESS;
    assert_close(-ways[ways.len() - 1], given, 2e-3 * given);
    assert!(report.quality["servo_force_error"].ok, "{report:?}");
}

#[test]
fn a_stress_acts_on_what_the_other_planes_enclose() {
    let (stress, sides) = (2e4, [0.03, 0.05]);
    let servo = json!({"stress_pa": stress, "largest_velocity_m_per_s": 0.1});
    let mut spec = column(1, &["x", "y"], &servo, 2e-5, 2000);
    spec["laws"]["local_damping"] = json!(0.3);
    for (axis, side) in ["x", "y"].into_iter().zip(sides) {
        for facing in [1, -1] {
            let plane = json!({"name": format!("{axis}_{}", if facing > 0 { "low" } else { "high" }), "axis": axis, "facing": facing,
                               "position_m": -0.5 * side * f64::from(facing), "material": "stone"});
            spec["planes"].as_array_mut().expect("planes").push(plane);
        }
    }
    let (_, record) = run(&spec);
    let forces = record.column("top_force_z_n");
    let force = stress * sides[0] * sides[1];
    assert_close(forces[forces.len() - 1], force, 1e-3 * force);
}

#[test]
fn a_servo_that_has_not_come_to_its_force_is_told() {
    let servo = json!({"force_n": 100, "largest_velocity_m_per_s": 0.01});
    let (report, _) = run(&column(10, &["x", "y"], &servo, 2e-5, 500));
    assert!(!report.quality["servo_force_error"].ok, "{report:?}");
    let mut warnings = report.warnings.iter();
    let told = warnings.find(|warning| warning.code == "servo_force_error");
    let told = told.expect("a warning");
    assert!(told.detail.contains("/stages/0/drive/steps"), "{told:?}");
}

#[test]
fn servos_have_the_same_bits_on_threads_and_resume() {
    let mut spec = super::determinism::rain(14, 0.5, 400, true);
    let servo = json!({"stress_pa": 2e3, "largest_velocity_m_per_s": 0.5});
    spec["stages"][1] = json!({"drive": {"walls": [{"name": "lid", "servo": servo}],
                                         "friction_factor": 0.2, "steps": 400}});
    let (expected, record) = run(&spec);
    let (report, other) = run_on(&spec, 3);
    assert_eq!(report, expected);
    assert!(other.files == record.files);
    super::determinism::assert_resumes(&spec, 3);
}

#[test]
fn servos_are_planes_with_one_aim_and_an_area() {
    let at = "/spec/stages/0/drive/walls/0/servo";
    for (servo, pointer, code) in [
        (
            json!({"largest_velocity_m_per_s": 1}),
            at.to_owned(),
            "not_one_aim",
        ),
        (
            json!({"force_n": 1, "stress_pa": 1, "largest_velocity_m_per_s": 1}),
            at.to_owned(),
            "not_one_aim",
        ),
        (
            json!({"stress_pa": 1, "largest_velocity_m_per_s": 1}),
            format!("{at}/stress_pa"),
            "no_area",
        ),
    ] {
        let spec = column(1, &["x"], &servo, 1e-6, 1);
        assert_eq!(codes(&spec), one(&pointer, code));
    }
    let servo = json!({"force_n": 1, "largest_velocity_m_per_s": 1});
    let mut spec = column(1, &["x"], &servo, 1e-6, 1);
    spec["stages"][0]["drive"]["walls"][0]["name"] = json!("gate");
    spec["facets"] = json!([{"name": "gate", "material": "stone", "triangles_m": [[[1, 0, 0], [2, 0, 0], [1, 1, 0]]]}]);
    assert_eq!(codes(&spec), one(at, "not_a_plane"));
}
