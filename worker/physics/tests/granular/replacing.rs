//! Spheres that a stage replaces by clumps.
use serde_json::{Value, json};

use super::{codes, determinism::assert_resumes, one, run, run_on};

/// A sphere that flies and turns, one that is held in part, and one of another material; those of stone are
/// replaced by pairs.
fn flying(equal: &str) -> Value {
    let material = json!({"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
        "stiffness_ratio": 0.3, "friction_angle_rad": 0.5});
    json!({"version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": material, "other": material},
        "bodies": [
            {"sphere": {"radius_m": 0.02}, "material": "stone", "position_m": [0, 0, 0],
                "velocity_m_per_s": [1, 2, 3], "angular_velocity_rad_per_s": [0, 0, 5]},
            {"sphere": {"radius_m": 0.02}, "material": "stone", "position_m": [9, 0, 0],
                "fixed": ["x"]},
            {"sphere": {"radius_m": 0.02}, "material": "other", "position_m": [0, 9, 0]}],
        "laws": {"local_damping": 0},
        "stages": [{"run": {"time_s": 0.1}},
            {"replace": {"material": "stone", "equal": equal, "clump": {"members": [
                {"offset_m": [0.3, 0, 0.005], "radius_m": 0.01},
                {"offset_m": [0.3, 0, -0.005], "radius_m": 0.01}]}}},
            {"run": {"time_s": 0.1}}],
        "record": {"every_steps": 1_000_000}})
}

#[test]
fn a_clump_goes_on_as_its_sphere_flew_and_what_is_held_or_of_another_material_stays() {
    let (report, record) = run(&flying("size"));
    assert_eq!(report.summary["replaced_spheres"].value, Some(1.0));
    assert_eq!(report.summary["bodies"].value, Some(3.0));
    assert_eq!(report.summary["particles"].value, Some(4.0));
    // two balls of 1 at ±½ within a ball of 1.5
    let [before, after] = ["mass_before_replacing", "mass_after_replacing"]
        .map(|name| report.summary[name].value.expect("a mass"));
    let share = (8.0 / 3.0 - 2.0 * 5.0 / 24.0) / (4.0 / 3.0 * 1.5_f64.powi(3));
    assert!((after / before - share).abs() < 1e-6, "{after} {before}");
    let rows = record.table("bodies.csv");
    let last = &rows[rows.len() - 1];
    // the clump has the number after those of all bodies, and its centre of mass flew 0.2 s
    assert_eq!(last[2] as u32, 3);
    for (found, expected) in last[3..6].iter().zip([0.2, 0.4, 0.6]) {
        assert!((found - expected).abs() < 1e-9, "{last:?}");
    }
    // |L| stays, and it began to turn as the sphere did: energy is ½ m v² + ½ ω·Iω
    let kinetic = report.summary["kinetic_energy"].value.expect("an energy");
    let moving = 0.5 * after * 14.0;
    assert!(
        kinetic > moving && kinetic < 1.001 * moving,
        "{kinetic} {moving}"
    );
}

#[test]
fn what_is_not_there_or_would_stand_in_its_neighbours_is_refused() {
    let stage = "/spec/stages/1/replace";
    let mut none = flying("size");
    none["stages"][1]["replace"]["material"] = json!("stones");
    assert_eq!(
        codes(&none),
        one(&format!("{stage}/material"), "no_such_material")
    );
    let mut held = flying("size");
    held["bodies"][0]["fixed"] = json!(["z"]);
    assert_eq!(
        codes(&held),
        one(&format!("{stage}/material"), "no_such_body")
    );
    // a second stage finds none that the first left
    let mut twice = flying("size");
    twice["stages"][2] = twice["stages"][1].clone();
    let pointer = "/spec/stages/2/replace/material";
    assert_eq!(codes(&twice), one(pointer, "no_such_body"));
    assert_eq!(
        codes(&flying("mass")),
        one(&format!("{stage}/equal"), "not_together")
    );
    let mut relaxed = flying("mass");
    relaxed["stages"][2] = json!({"relax": {"steps": 10}});
    run(&relaxed);
    let mut alone = flying("size");
    alone["stages"][1]["replace"]["clump"] =
        json!({"members": [{"offset_m": [0, 0, 0], "radius_m": 0.1}]});
    assert_eq!(
        codes(&alone),
        one(&format!("{stage}/clump"), "clump_of_one")
    );
    let mut bonded = flying("size");
    bonded["materials"]["stone"]["normal_cohesion_pa"] = json!(1e6);
    assert_eq!(
        codes(&bonded),
        one(&format!("{stage}/material"), "not_together")
    );
}

/// Spheres fall into a box, some of them later, and all become pairs.
fn bed(seed: u64) -> Value {
    let wall = |name: &str, axis: &str, at: f64, facing: i32| {
        json!({"name": name, "axis": axis, "position_m": at, "facing": facing,
            "material": "stone"})
    };
    let spheres = |count: u32, low: f64| {
        json!({"grain": "sphere", "sizes": {"uniform": {"smallest_radius_m": 0.015,
            "largest_radius_m": 0.02}}, "material": "stone", "count": count,
            "region": {"box": {"lower_m": [0, 0, low], "upper_m": [0.12, 0.12, low + 0.2]}}})
    };
    json!({"version": 1, "seed": seed,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
            "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "planes": [wall("base", "z", 0.0, 1), wall("left", "x", 0.0, 1), wall("right", "x", 0.12, -1),
            wall("front", "y", 0.0, 1), wall("back", "y", 0.12, -1)],
        "generate": [spheres(20, 0.0)],
        "stages": [
            {"insert": {"bodies": spheres(10, 0.2), "every_s": 0.05, "time_s": 0.1}},
            {"settle": {"time_s": 0.3}},
            {"replace": {"material": "stone", "equal": "mass", "clump": {"members": [
                {"offset_m": [0, 0, 0.005], "radius_m": 0.01},
                {"offset_m": [0, 0, -0.005], "radius_m": 0.01}]}}},
            {"relax": {"largest_overlap_ratio": 0.05, "steps": 2000}},
            {"settle": {"time_s": 2}}],
        "accuracy": "draft",
        "record": {"every_steps": 100}})
}

#[test]
fn a_bed_is_taken_apart_and_comes_to_rest_with_the_same_bytes_on_any_threads_and_after_a_pause() {
    let first = bed(1);
    let (report, record) = run(&first);
    assert_eq!(report.summary["replaced_spheres"].value, Some(30.0));
    assert_eq!(report.summary["particles"].value, Some(60.0));
    assert_eq!(report.summary["escaped_bodies"].value, Some(0.0));
    let overlap = report.summary["overlap_after_replacing"]
        .value
        .expect("it was measured");
    assert!(overlap > 0.1, "{overlap}");
    // at rest: what they overlap by is their weight's, and no energy came from nowhere
    let unbalanced = report.summary["unbalanced_force_ratio"]
        .value
        .expect("it rests");
    assert!(unbalanced < 0.02, "{unbalanced}");
    for name in ["largest_overlap_ratio", "created_energy_ratio"] {
        let check = &report.quality[name];
        assert!(check.value < check.bound, "{name} {check:?}");
    }
    let (_, shared) = run_on(&first, 2);
    assert_eq!(record.points, shared.points);
    assert!(record.files == shared.files);
    assert_resumes(&first, 5);
    let (other, _) = run(&bed(2));
    assert_ne!(
        other.summary["overlap_after_replacing"].value,
        Some(overlap)
    );
}
