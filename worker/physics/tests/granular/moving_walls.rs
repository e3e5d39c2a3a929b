//! Walls that move: what they touch, how large a step they allow, when they stop.
use serde_json::{Value, json};

use super::{Record, assert_close, codes, determinism::assert_resumes, failure, one, run};

const HELD: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

fn material(modulus: f64) -> Value {
    json!({"density_kg_per_m3": 2600, "youngs_modulus_pa": modulus})
}

fn grain(radius: f64, position: [f64; 3], fixed: &[&str]) -> Value {
    json!({"sphere": {"radius_m": radius}, "material": "g", "position_m": position, "fixed": fixed})
}

fn plane(name: &str, axis: &str, position: f64, facing: i32) -> Value {
    json!({"name": name, "axis": axis, "position_m": position, "facing": facing, "material": "g"})
}

/// Two triangles across z.
fn square(name: &str, half: f64, height: f64) -> Value {
    let [a, b, c, d] =
        [[-half, -half], [half, -half], [half, half], [-half, half]].map(|[x, y]| [x, y, height]);
    json!({"name": name, "material": "g", "triangles_m": [[a, b, c], [a, c, d]]})
}

/// Spheres of 1 cm in a square of this many a side, held as a whole.
fn held_floor(side: usize) -> Vec<Value> {
    let place = |number: usize| 0.04 * (number as f64 - 0.5 * (side as f64 - 1.0));
    let places = (0..side * side).map(|number| [place(number / side), place(number % side), 0.0]);
    places.map(|place| grain(0.01, place, &HELD)).collect()
}

/// Pressed on by 10 N through a plate of this mass.
fn plate(bodies: &[Value], wall: &Value, mass: f64, accuracy: &str) -> Value {
    let is_plane = wall["axis"].is_string();
    let stage = if is_plane {
        json!({"load_plane": {"name": "plate", "mass_kg": mass, "force_n": -10, "time_s": 0.3}})
    } else {
        json!({"drive": {"time_s": 0.3, "walls": [{"name": "plate", "force":
            {"mass_kg": mass, "force_n": [0, 0, -10], "free": ["z"]}}]}})
    };
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"g": material(1e7)}, "bodies": bodies,
        "planes": if is_plane { json!([wall]) } else { json!([]) },
        "facets": if is_plane { json!([]) } else { json!([wall]) },
        "laws": {"local_damping": 0.7}, "accuracy": accuracy, "stages": [stage],
        "record": {"every_steps": 1_000_000, "walls": ["plate"]}
    })
}

fn last(record: &Record, column: &str) -> f64 {
    *record.column(column).last().expect("a row")
}

/// n springs of E r each carry 10 N at 10 N/(n E r), behind a gap of 0.1 mm.
#[test]
fn a_plate_rests_on_spheres_that_are_held() {
    for side in [2, 10] {
        let bodies = held_floor(side);
        for wall in [
            plane("plate", "z", 0.0101, -1),
            square("plate", 0.3, 0.0101),
        ] {
            for (mass, accuracy) in [(1.0, "standard"), (0.1, "draft"), (0.02, "draft")] {
                let (report, record) = run(&plate(&bodies, &wall, mass, accuracy));
                let springs = bodies.len() as f64 * 1e7 * 0.01;
                let way = last(&record, "plate_displacement_z_m");
                // what swings is damped to nothing in 0.3 s
                assert_close(way, -1e-4 - 10.0 / springs, 1e-9);
                assert_close(last(&record, "plate_force_z_n"), 10.0, 1e-4);
                let created = &report.quality["created_energy_ratio"];
                assert!(created.ok, "{side} {mass}: {created:?}");
                let step = &report.quality["step_over_critical"];
                assert!(step.value <= 0.4 * (1.0 + 1e-9), "{side} {mass}: {step:?}");
            }
        }
    }
}

#[test]
fn what_a_plate_weighs_sets_the_step_where_only_it_moves() {
    let spec = plate(
        &held_floor(2),
        &plane("plate", "z", 0.0101, -1),
        0.1,
        "draft",
    );
    let (report, record) = run(&spec);
    // four springs on 0.1 kg: 2 √(0.1 kg/(4 · 10⁵ N/m))
    let critical = 2.0 * (0.1 / 4e5_f64).sqrt();
    assert_close(last(&record, "step_over_critical"), 0.4, 1e-9);
    let step = report.summary["time_step"].value.expect("a step");
    assert_close(step / critical, 0.4, 1e-9);
    let words = "set by plane \"plate\" and its contact with body";
    let limit = &report.quality["step_over_critical"].description;
    assert!(limit.contains(words), "{limit}");
}

#[test]
fn a_given_step_that_a_plate_does_not_allow_is_refused_with_the_right_one() {
    // one contact allows 2 √(0.1/10⁵) = 2 ms, four of them 1 ms
    let mut spec = plate(
        &held_floor(2),
        &plane("plate", "z", 0.0101, -1),
        0.1,
        "draft",
    );
    spec["time_step_s"] = json!(3e-3);
    assert_eq!(codes(&spec), one("/spec/time_step_s", "unstable"));
    spec["time_step_s"] = json!(1.2e-3);
    let error = failure(&spec).to_string();
    assert!(error.contains("beyond the critical step 1e-3 s"), "{error}");
    assert!(error.contains("plane \"plate\""), "{error}");
}

#[test]
fn neighbours_that_are_held_do_not_touch() {
    // halves of each other, standing and moving as one, on a plane whose force is told
    for velocity in [0.0, 0.5] {
        let mut bodies = Vec::new();
        for place in [0.0, 0.01] {
            let mut body = grain(0.01, [place, 0.0, 0.005], &HELD);
            body["velocity_m_per_s"] = json!([velocity, 0, 0]);
            bodies.push(body);
        }
        let spec = json!({
            "version": 1, "materials": {"g": material(1e7)}, "bodies": bodies,
            "stages": [{"run": {"steps": 100}}], "record": {"every_steps": 100}
        });
        let (report, _) = run(&spec);
        assert_eq!(report.summary["contacts"].value, Some(0.0));
        let overlap = report.quality["largest_overlap_ratio"].value;
        assert_close(overlap, 0.0, 0.0);
    }
}

#[test]
fn a_body_that_is_pressed_into_one_that_is_held_tells_the_force() {
    let bodies = [
        grain(0.01, [0.0; 3], &HELD),
        grain(0.01, [0.0, 0.0, 0.0205], &HELD),
    ];
    let drive = json!({"body": 1, "velocity": {"velocity_m_per_s": [0, 0, -0.01]}});
    let spec = json!({
        "version": 1, "materials": {"g": material(1e7)}, "bodies": bodies,
        "stages": [{"drive": {"time_s": 0.1, "bodies": [drive]}}],
        "record": {"every_steps": 1_000_000}
    });
    let (_, record) = run(&spec);
    assert_close(last(&record, "body_1_displacement_z_m"), -1e-3, 1e-12);
    // E r δ, with δ that of the last step's start: a millisecond before the end, where nothing can move
    assert_close(last(&record, "body_1_force_z_n"), 1e5 * (5e-4 - 1e-5), 1e-9);
}

#[test]
fn three_stages_of_a_millisecond_move_three_millimetres() {
    let walls = [
        (json!([plane("w", "z", 0.0, 1)]), json!([])),
        (json!([]), json!([square("w", 0.1, 0.0)])),
    ];
    for (planes, facets) in walls {
        for step in [json!("auto"), json!(3e-4), json!(7e-5)] {
            let drive = json!({"name": "w", "velocity_m_per_s": [0, 0, 1]});
            let stage = json!({"drive": {"walls": [drive], "flow": true, "time_s": 0.001}});
            let mut spec = json!({
                "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"g": material(1e5)},
                "bodies": [grain(0.01, [0.0, 0.0, 0.05], &[])], "planes": planes, "facets": facets,
                "stages": [stage, stage, stage],
                "record": {"every_steps": 1, "stage_ends": true}
            });
            spec["time_step_s"] = step.clone();
            let (report, record) = run(&spec);
            assert_close(last(&record, "w_displacement_z_m"), 3e-3, 1e-15);
            assert_close(
                report.summary["simulated_time"].value.expect("a time"),
                3e-3,
                1e-15,
            );
            // stages count from 1
            let stages = record.column("stage");
            assert_close(stages[0], 1.0, 0.0);
            assert_close(*stages.last().expect("a row"), 3.0, 0.0);
        }
    }
}

/// A last step that is shorter is the same in one run and in pieces.
#[test]
fn stages_that_end_at_their_time_resume() {
    let mut bodies = held_floor(2);
    bodies.push(grain(0.01, [0.02, 0.02, 0.03], &[]));
    let mut spec = plate(&bodies, &plane("plate", "z", 0.06, -1), 0.1, "reference");
    spec["materials"]["g"]["restitution"] = json!(0.3);
    spec["materials"]["g"]["friction_angle_rad"] = json!(0.3);
    spec["stages"][0]["load_plane"]["time_s"] = json!(0.300_01);
    let stage = spec["stages"][0].clone();
    spec["stages"] = json!([stage, stage, stage]);
    assert_resumes(&spec, 4);
}

#[test]
fn a_fast_wall_meets_a_small_grain_in_its_first_step() {
    // a linear spring of E r stops it in v √(m/k): 0.3 mm, or 3 mm, which is through
    for (modulus, law, holds) in [
        (1e8, "linear", true),
        (1e8, "hertz_mindlin", true),
        (1e6, "linear", false),
    ] {
        let drive = json!({"name": "w", "velocity_m_per_s": [0, 0, 30]});
        let spec = json!({
            "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"g": material(modulus)},
            "bodies": [grain(0.001, [0.0, 0.0, 0.00126], &[])], "facets": [square("w", 1.0, 0.0)],
            "laws": {"local_damping": 0, "contact": law}, "accuracy": "draft",
            "stages": [{"run": {"time_s": 1e-3}}, {"drive": {"walls": [drive], "flow": true, "time_s": 1e-4}}],
            "record": {"every_steps": 1_000_000, "bodies": [0], "walls": ["w"]}
        });
        let (report, record) = run(&spec);
        let way = last(&record, "w_displacement_z_m");
        assert_close(way, 3e-3, 1e-15);
        let rows = record.table("bodies.csv");
        let row = rows.last().expect("a row");
        assert_eq!(
            row[5] > way,
            holds,
            "{law}: the grain at {}, the wall at {way}",
            row[5]
        );
        // what it goes through pushes it up, and down again
        assert!((row[5] - 0.00126).abs() > 1e-5, "it was met");
        let is_told = report
            .warnings
            .iter()
            .any(|warning| warning.code == "passed_through");
        assert_eq!(is_told, !holds, "{:?}", report.warnings);
    }
}

#[test]
fn a_plane_that_moves_faster_than_anything_is_limited_or_refused() {
    let mut spec = json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"g": material(1e6)},
        "bodies": [grain(0.001, [0.0, 0.0, 0.05], &[])], "planes": [plane("w", "z", 0.0, 1)],
        "stages": [{"run": {"steps": 1}}, {"move_plane": {"name": "w", "velocity_m_per_s": 5000, "time_s": 1e-6}}],
        "record": {"every_steps": 1, "planes": ["w"]}, "accuracy": "draft"
    });
    let (_, record) = run(&spec);
    let ways = record.column("w_displacement_m");
    let longest = ways
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(0.0, f64::max);
    assert!(longest > 0.0 && longest <= 1e-4, "{longest}");
    spec["time_step_s"] = json!(1e-7);
    assert_eq!(
        codes(&spec),
        one("/spec/stages/1/move_plane/velocity_m_per_s", "too_fast")
    );
    // a plate that its force makes too fast on the way
    spec["stages"] =
        json!([{"load_plane": {"name": "w", "mass_kg": 1e-3, "force_n": 1e7, "steps": 10}}]);
    let error = failure(&spec).to_string();
    assert!(
        error.contains("wall \"w\" moves more than a tenth"),
        "{error}"
    );
}

#[test]
fn a_hertz_step_is_judged_at_the_compression_that_it_comes_to() {
    // two spheres pressed together by a plane: the step is fine at 10⁻³ of the radius, and not at 10⁻¹
    let bodies = [
        grain(0.01, [0.0, 0.0, 0.01], &[]),
        grain(0.01, [0.0, 0.0, 0.03], &[]),
    ];
    let mut spec = json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"g": material(1e8)},
        "bodies": bodies, "planes": [plane("base", "z", 0.0, 1), plane("top", "z", 0.04, -1)],
        "laws": {"contact": "hertz_mindlin", "local_damping": 0.5},
        "stages": [{"move_plane": {"name": "top", "velocity_m_per_s": -0.5, "time_s": 0.008}}],
        "record": {"every_steps": 1_000_000}
    });
    let (report, _) = run(&spec);
    let step = report.summary["time_step"].value.expect("a step");
    // twice the critical step where the automatic one ended
    spec["time_step_s"] = json!(10.0 * step);
    let error = failure(&spec).to_string();
    assert!(error.contains("allow as they are pressed now"), "{error}");
    spec["time_step_s"] = json!(step);
    let (report, _) = run(&spec);
    assert!(report.quality["created_energy_ratio"].ok);
}

/// A soft floor loses spheres: each is told, with the wall that it went through.
#[test]
fn what_goes_through_a_wall_is_named() {
    let walls = [
        (
            json!([plane("floor", "z", 0.0, 1)]),
            json!([]),
            "plane \"floor\" once",
        ),
        (
            json!([]),
            json!([square("floor", 0.1, 0.0)]),
            "facets \"floor\" once",
        ),
    ];
    for (planes, facets, words) in walls {
        for law in ["linear", "hertz_mindlin"] {
            let spec = json!({
                "version": 1, "materials": {"g": material(1e3), "soft": material(1e2)},
                "bodies": [
                    {"sphere": {"radius_m": 0.01}, "material": "g", "position_m": [0.02, 0.01, 0.2]},
                    // one that stays outside has nothing to tell
                    {"sphere": {"radius_m": 0.01}, "material": "g", "position_m": [0.02, 0.04, 0.2], "fixed": ["z"]}],
                "planes": planes, "facets": facets, "laws": {"contact": law, "local_damping": 0},
                "stages": [{"run": {"time_s": 0.24}}], "record": {"every_steps": 1_000_000}
            });
            let (report, _) = run(&spec);
            let warning = report
                .warnings
                .iter()
                .find(|warning| warning.code == "passed_through");
            let detail = &warning.expect("it fell through").detail;
            assert!(
                detail.contains(words) && detail.contains("first body 0 in step"),
                "{detail}"
            );
            assert!(
                detail.contains("/materials/g/youngs_modulus_pa"),
                "{detail}"
            );
        }
    }
}
