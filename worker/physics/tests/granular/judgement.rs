//! What a run says of itself: not more than is true, and not less.
#![allow(clippy::float_cmp, reason = "stages are counted by whole numbers")]
use serde_json::{Value, json};

use super::{assert_close, codes, failure, one, run};

fn scene(bodies: &Value, stages: &Value) -> Value {
    json!({
        "version": 1,
        "materials": {"g": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.5}},
        "bodies": bodies,
        "planes": [{"name": "floor", "axis": "z", "position_m": 0, "facing": 1, "material": "g"}],
        "stages": stages, "record": {"every_steps": 1_000_000}
    })
}

fn sphere(position: [f64; 3], velocity: [f64; 3]) -> Value {
    json!({"sphere": {"radius_m": 0.01}, "material": "g", "position_m": position, "velocity_m_per_s": velocity})
}

/// ½ g t², though a place there is known to a picometre only and a step is less.
#[test]
fn a_sphere_falls_freely_ten_kilometres_up() {
    for (height, floor) in [(1e4, 0.0), (1e4, 9e3), (-1e4, -2e4)] {
        for every in [1, 1_000_000] {
            let mut spec = scene(
                &json!([sphere([0.0, 0.0, height], [0.0; 3])]),
                &json!([{"run": {"steps": 3000}}]),
            );
            spec["planes"][0]["position_m"] = json!(floor);
            spec["time_step_s"] = json!(1e-7);
            spec["laws"] = json!({"local_damping": 0});
            spec["record"] = json!({"every_steps": every});
            let (report, _) = run(&spec);
            let created = &report.quality["created_energy_ratio"];
            assert!(created.ok, "{created:?}");
            let [_, _, z] = report.bodies[0].centre_m;
            // places are rounded by a picometre in each step
            assert_close(z - height, -0.5 * 9.81 * 3e-4_f64.powi(2), 3000.0 * 2e-12);
        }
    }
}

/// What is made by too large a step is still found there.
#[test]
fn energy_that_is_made_ten_kilometres_up_is_seen() {
    let mut spec = scene(
        &json!([sphere([0.0, 0.0, 1e4 + 0.0101], [0.0, 0.0, -1.0])]),
        &json!([{"run": {"steps": 3000}}]),
    );
    spec["planes"][0]["position_m"] = json!(1e4);
    spec["laws"] = json!({"local_damping": 0});
    // 1.3 of 2 √(m/K), K = E r and Coulomb's 1.05 of it
    let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    spec["time_step_s"] = json!(1.3 * 2.0 * (mass / 1.05e5_f64).sqrt());
    assert_eq!(codes(&spec), one("/spec/time_step_s", "unstable"));
    spec["allow_unstable"] = json!(true);
    let (report, _) = run(&spec);
    assert!(!report.quality["step_over_critical"].ok);
    assert!(
        !report.quality["created_energy_ratio"].ok,
        "{:?}",
        report.quality
    );
}

#[test]
fn a_sphere_that_rolls_on_a_plane_has_not_left() {
    let run_time = json!([{"run": {"time_s": 1.0}}]);
    let rolling = scene(
        &json!([sphere([0.0, 0.0, 0.01], [0.5, 0.0, 0.0])]),
        &run_time,
    );
    // and down a slope
    let mut sloping = scene(&json!([sphere([0.0, 0.0, 0.01], [0.0; 3])]), &run_time);
    sloping["gravity_m_per_s2"] = json!([3.0, 0, -9.0]);
    for mut spec in [rolling, sloping] {
        spec["laws"] = json!({"local_damping": 0});
        let (report, _) = run(&spec);
        let [x, ..] = report.bodies[0].centre_m;
        assert!(x > 0.13, "{x}");
        assert_eq!(report.summary["escaped_bodies"].value, Some(0.0));
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    }
    // one that flies off, or beside triangles into the depth, has
    for (velocity, has_floor) in [([0.0, 0.0, 10.0], true), ([1.0, 0.0, 0.0], false)] {
        let mut spec = scene(&json!([sphere([0.0, 0.0, 0.011], velocity)]), &run_time);
        if !has_floor {
            let square = json!([[[-0.1, -0.1, 0], [0.1, -0.1, 0], [0, 0.1, 0]]]);
            spec["planes"] = json!([]);
            spec["facets"] = json!([{"name": "table", "material": "g", "triangles_m": square}]);
        }
        spec["laws"] = json!({"local_damping": 0});
        let (report, _) = run(&spec);
        assert_eq!(
            report.summary["escaped_bodies"].value,
            Some(1.0),
            "{velocity:?}"
        );
    }
}

/// A plate of a kilogram set down on a sphere between it and the floor.
fn under_a_plate(stages: &[Value]) -> Value {
    let mut all = vec![
        json!({"settle": {"time_s": 1.0}}),
        json!({"place": {"wall": "plate", "mass_kg": 1}}),
    ];
    all.extend_from_slice(stages);
    let mut spec = scene(&json!([sphere([0.0, 0.0, 0.01], [0.0; 3])]), &json!(all));
    let plate =
        json!({"name": "plate", "axis": "z", "position_m": 0.05, "facing": -1, "material": "g"});
    spec["planes"].as_array_mut().expect("planes").push(plate);
    spec["record"] = json!({"every_steps": 1, "planes": ["plate"], "from_stage": 2});
    spec
}

#[test]
fn a_plate_that_bounces_is_not_at_rest() {
    // it is set down just touching, and sinks in: without damping it bounces for ever
    let mut spec = under_a_plate(&[json!({"settle": {"time_s": 0.3}})]);
    spec["stages"][0] = json!({"run": {"time_s": 1e-3}});
    spec["laws"] = json!({"local_damping": 0.001});
    let (report, _) = run(&spec);
    let warning = report
        .warnings
        .iter()
        .find(|warning| warning.code == "not_settled");
    let detail = &warning.expect("it bounces").detail;
    assert!(
        detail.contains("stage 3") && detail.contains("/stages/2/settle/time_s"),
        "{detail}"
    );
    spec["laws"] = json!({"local_damping": 0.5});
    let (report, record) = run(&spec);
    assert!(
        report
            .warnings
            .iter()
            .all(|warning| warning.code != "not_settled")
    );
    let force = record.column("plate_force_n");
    assert_close(*force.last().expect("a row"), 9.81, 0.0981);
}

#[test]
fn a_plate_alone_on_bodies_that_are_held_comes_to_rest() {
    let mut spec = under_a_plate(&[json!({"settle": {"time_s": 1.0}})]);
    spec["stages"][0] = json!({"run": {"steps": 1}});
    spec["bodies"][0]["fixed"] = json!(["x", "y", "z", "rx", "ry", "rz"]);
    let (report, record) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let force = record.column("plate_force_n");
    assert_close(*force.last().expect("a row"), 9.81, 0.0981);
    let time = report.summary["simulated_time"].value.expect("a time");
    assert!(time < 0.9, "it ends when it rests: {time}");
}

/// Slowly beside its own 35 Hz, the force follows m (g + A sin 2πft).
#[test]
fn a_plate_is_shaken_with_everything() {
    let vibrate = json!({"vibrate": {"acceleration_m_per_s2": 5, "frequency_hz": 1, "axes": ["z"], "time_s": 1.0}});
    let spec = under_a_plate(&[
        json!({"settle": {"time_s": 1.0, "unbalanced_force_ratio": 1e-4}}),
        vibrate,
        json!({"settle": {"time_s": 1.0}}),
    ]);
    let (_, record) = run(&spec);
    let (stage, force) = (record.column("stage"), record.column("plate_force_n"));
    let shaken: Vec<f64> = (stage.iter().zip(&force))
        .filter(|(stage, _)| **stage == 4.0)
        .map(|(_, force)| *force)
        .collect();
    let least = shaken.iter().copied().fold(f64::INFINITY, f64::min);
    let most = shaken.iter().copied().fold(0.0, f64::max);
    assert_close(least, 4.81, 0.05);
    assert_close(most, 14.81, 0.05);
    assert_close(*force.last().expect("a row"), 9.81, 0.1);
    // across the plate it feels nothing
    let mut spec = spec;
    spec["stages"][3]["vibrate"]["axes"] = json!(["x", "y"]);
    let (_, record) = run(&spec);
    let (stage, force) = (record.column("stage"), record.column("plate_force_n"));
    let shaken = stage.iter().zip(&force).filter(|(stage, _)| **stage == 4.0);
    for (_, force) in shaken {
        assert_close(*force, 9.81, 0.02);
    }
}

#[test]
fn warnings_name_the_field_and_the_stage() {
    let mut spec = under_a_plate(&[
        json!({"settle": {"time_s": 1.0}}),
        json!({"load_plane": {"name": "plate", "mass_kg": 1, "force_n": -200, "time_s": 0.01}}),
        json!({"move_plane": {"name": "plate", "velocity_m_per_s": -2, "time_s": 0.001}}),
    ]);
    spec["accuracy"] = json!({"critical_step_fraction": 0.8});
    let (report, _) = run(&spec);
    let detail = |code: &str| {
        let found = report.warnings.iter().find(|warning| warning.code == code);
        let found = found.unwrap_or_else(|| panic!("{code}: {:?}", report.warnings));
        found.detail.clone()
    };
    for (code, all) in [
        (
            "largest_overlap_ratio",
            [
                "in stage 5",
                "/materials/g/youngs_modulus_pa",
                "/stages/4/move_plane",
            ],
        ),
        (
            "step_over_critical",
            [
                "/accuracy/critical_step_fraction",
                "in stage",
                "set by body 0",
            ],
        ),
    ] {
        for words in all {
            assert!(detail(code).contains(words), "{words}: {}", detail(code));
        }
    }
}

/// Rail beds that ask for 0.6 of it come to more than 0.77 for a moment, and are a third off; here nothing
/// stiffens, and what is asked for is what is seen.
#[test]
fn more_than_seven_tenths_of_the_critical_step_are_not_called_fine() {
    for (fraction, is_fine) in [(0.4, true), (0.69, true), (0.71, false), (0.8, false)] {
        let mut spec = under_a_plate(&[json!({"settle": {"time_s": 1.0}})]);
        spec["accuracy"] = json!({"critical_step_fraction": fraction});
        let (report, _) = run(&spec);
        assert_eq!(
            report.quality["step_over_critical"].ok, is_fine,
            "{fraction}: {:?}",
            report.quality["step_over_critical"]
        );
    }
}

#[test]
fn a_given_step_that_scenes_outgrow_is_told_with_the_stage_of_its_failure() {
    // a heavy plate presses two spheres; alone each contact allows the step, together they do not
    let mut spec = under_a_plate(&[json!({"settle": {"time_s": 1.0}})]);
    spec["bodies"]
        .as_array_mut()
        .expect("bodies")
        .push(sphere([0.0, 0.0, 0.03], [0.0; 3]));
    let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    spec["time_step_s"] = json!(0.99 * 2.0 * (mass / 1.05e5_f64).sqrt() / 2.0_f64.sqrt());
    let error = failure(&spec).to_string();
    assert!(error.contains("beyond the critical step"), "{error}");
}
