//! Chains of spheres with bonds that bend and twist against Yade 2023.02a.
//!
//! `beams.jsonl` is what `tests/granular/yade_beams.py` printed, whose bonds have the stiffnesses of the beams here;
//! the contact beside them, which Yade has not, is given no stiffness.
use serde_json::{Value, json};

use super::{body, run};

/// Yade's slip is over r_a + r_b, ours over the distance of the centres, which differ by the strain of the
/// bonds: v over the √(EAL/m) of 380 m/s at which it travels, of 0.003 m/s 8e-6.
const STRAIN: f64 = 8e-6;
/// A damping force turns where a product passes zero. A little more or less of a velocity lets it pass in
/// another step, which then keeps a part of one step's acceleration: 1e-5 of the velocities here, which
/// move the spheres until the end.
const TURNED: f64 = 1e-3;
/// What rounding leaves in Yade of a velocity that is nothing [m/s], and of places and spins.
const ROUND_OFF: f64 = 1e-11;

#[test]
fn chains_that_bend_and_twist_follow_yade() {
    for line in include_str!("beams.jsonl").lines() {
        let case: Value = serde_json::from_str(line).expect("a line is a case");
        let name = case["name"].as_str().expect("a name");
        let sphere = |place: u32| {
            json!({"sphere": {"radius_m": 0.01}, "material": "stone",
                   "position_m": [0.02 * f64::from(place), 0, 0]})
        };
        let mut bodies: Vec<Value> = (0..4).map(sphere).collect();
        bodies[3]["velocity_m_per_s"] = case["velocity"].clone();
        bodies[3]["angular_velocity_rad_per_s"] = case["spin"].clone();
        let spec = json!({
            "version": 1, "gravity_m_per_s2": [0, 0, 0],
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e-3,
                "friction_angle_rad": 0.5, "parallel_bond": {"radius_ratio": 0.5,
                "youngs_modulus_pa": 1e9, "stiffness_ratio": 0.4, "tensile_strength_pa": 1e15,
                "shear_strength_pa": 1e15}}},
            "bodies": bodies,
            "laws": {"local_damping": case["damping"], "convention": "yade"},
            "time_step_s": case["dt"],
            "stages": [{"run": {"steps": case["steps"]}}],
            "record": {"every_steps": 1000, "contacts": true}
        });
        let (_, record) = run(&spec);
        let is_damped = case["damping"]
            .as_f64()
            .is_some_and(|damping| damping > 0.0);
        let tolerance = if is_damped { TURNED } else { STRAIN };
        let scale = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0, |most: f64, value| most.max(value.abs()))
        };
        let triple = |value: &Value| -> [f64; 3] {
            serde_json::from_value(value.clone()).expect("three numbers")
        };
        // positions, velocities, spins; forces along and across, moments
        let states = case["states"].as_array().expect("states");
        for part in 0..3 {
            let expected: Vec<[f64; 3]> = states.iter().map(|state| triple(&state[part])).collect();
            let most = scale(&mut expected.iter().flatten().copied());
            for (number, expected) in (0..).zip(&expected) {
                let found = body(&record, 1000, number)[part];
                for (found, expected) in found.iter().zip(expected) {
                    assert!(
                        (found - expected).abs() <= tolerance * most + ROUND_OFF,
                        "{name} {part}: {found:e} {expected:e}"
                    );
                }
            }
        }
        let rows = record.table("contacts.csv");
        let rows: Vec<&Vec<f64>> = rows.iter().filter(|row| row[0] as u64 == 1000).collect();
        let bonds = case["bonds"].as_array().expect("bonds");
        assert_eq!(rows.len(), bonds.len());
        for (part, column) in [(0, 7), (1, 10), (2, 14)] {
            let expected: Vec<[f64; 3]> = bonds.iter().map(|bond| triple(&bond[part])).collect();
            let most = scale(&mut expected.iter().flatten().copied());
            for (row, expected) in rows.iter().zip(&expected) {
                for axis in 0..3 {
                    let found = row[column + axis];
                    // of forces along the bond round-off in the distance is left, 1e-17 m of 4e6 N/m
                    assert!(
                        (found.abs() - expected[axis].abs()).abs() <= tolerance * most + 1e-9,
                        "{name} {part}: {found:e} {expected:?}"
                    );
                }
            }
        }
    }
}
