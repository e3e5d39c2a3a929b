//! Walls and bodies that are set down, and moduli that change.
use serde_json::{Value, json};

use super::{assert_close, body, contact, failure, run, submission};

const RADIUS: f64 = 0.01;
const DENSITY: f64 = 2600.0;

/// A sphere that rests on a floor and that nothing turns.
fn resting(stages: Value) -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -10],
        "materials": {"stone": {"density_kg_per_m3": DENSITY, "youngs_modulus_pa": 1e6, "friction_angle_rad": 0.5}},
        "bodies": [{"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, RADIUS]}],
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"},
                   {"name": "lid", "axis": "z", "position_m": 1, "facing": -1, "material": "stone"}],
        "laws": {"local_damping": 0.5},
        "stages": stages,
        "record": {"every_steps": 1000, "contacts": true, "stage_ends": true, "walls": ["lid"]}
    })
}

/// m g of the sphere [N].
fn weight() -> f64 {
    10.0 * DENSITY * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3)
}

#[test]
fn an_overlap_shrinks_as_the_modulus_grows_and_the_force_stays() {
    let spec = resting(json!([
        {"run": {"time_s": 0.5}},
        {"stiffen": {"factor": 100, "steps": 4000}},
        {"run": {"time_s": 0.2}}
    ]));
    let (report, record) = run(&spec);
    let steps = report.summary["steps"].value.expect("steps") as u64;
    let (overlap, [_, force, _]) = contact(&record, steps, [0, 1]).expect("it rests on the floor");
    assert_close(force[2].abs(), weight(), 1e-6 * weight());
    // k = E r of two springs E 2r in series
    assert_close(overlap, weight() / (1e8 * RADIUS), 1e-6 * overlap);
    // what it was before
    let stages = record
        .column("stage")
        .into_iter()
        .zip(record.column("step"));
    let first = stages.rev().find(|(stage, _)| *stage < 1.5);
    let (_, first) = first.expect("rows of the first stage");
    let (first, _) = contact(&record, first as u64, [0, 1]).expect("it rests on the floor");
    assert_close(first / overlap, 100.0, 1e-3);
    // a step follows the root of the stiffness
    let step = report.summary["time_step"].value.expect("a step");
    let mut soft = spec.clone();
    soft["stages"] = json!([{"run": {"time_s": 0.5}}]);
    let before = run(&soft).0.summary["time_step"].value.expect("a step");
    assert_close(before / step, 10.0, 0.1);
    super::determinism::assert_resumes(&spec, 3);
}

#[test]
fn a_plane_is_set_down_on_the_highest_sphere() {
    let spec = resting(json!([
        {"run": {"time_s": 0.5}},
        {"place": {"wall": "lid"}},
        {"run": {"steps": 10}}
    ]));
    let (report, record) = run(&spec);
    let steps = report.summary["steps"].value.expect("steps") as u64;
    let way = *record.column("lid_displacement_z_m").last().expect("rows");
    let top = body(&record, steps, 0)[0][2] + RADIUS;
    assert_close(1.0 + way, top, 1e-12);
    assert_close(
        *record.column("lid_force_z_n").last().expect("rows"),
        0.0,
        1e-6,
    );
}

#[test]
fn a_plane_with_a_mass_rests_on_what_it_was_set_down_on() {
    let spec = resting(json!([
        {"run": {"time_s": 0.5}},
        {"place": {"wall": "lid", "mass_kg": 0.2}},
        {"run": {"time_s": 3}}
    ]));
    let (_, record) = run(&spec);
    let force = *record.column("lid_force_z_n").last().expect("rows");
    assert_close(force, 2.0, 1e-6);
}

/// A side that is pressed presses alone: the lid above keeps m g = 2 N, in the stage and after it.
#[test]
fn a_plate_keeps_its_weight_while_another_is_loaded() {
    let mut spec = resting(json!([
        {"run": {"time_s": 0.5}},
        {"place": {"wall": "lid", "mass_kg": 0.2}},
        {"run": {"time_s": 1}},
        {"load_plane": {"name": "right", "mass_kg": 0.05, "force_n": -8, "time_s": 1}},
        {"run": {"time_s": 1}}
    ]));
    let side = |name: &str, at: f64, facing: i32| json!({"name": name, "axis": "x", "position_m": at, "facing": facing, "material": "stone"});
    let planes = spec["planes"].as_array_mut().expect("planes");
    planes.extend([side("left", -RADIUS, 1), side("right", RADIUS, -1)]);
    spec["record"]["walls"] = json!(["lid", "right"]);
    let (_, record) = run(&spec);
    let [stages, lid, right] =
        ["stage", "lid_force_z_n", "right_force_x_n"].map(|name| record.column(name));
    for stage in [4.0, 5.0] {
        let last = stages.iter().rposition(|row| (row - stage).abs() < 0.5);
        let last = last.expect("rows of the stage");
        assert_close(lid[last], 2.0, 1e-6);
        // it presses while its stage lasts, and stays where that left it
        assert_close(right[last], 8.0, 1e-3);
    }
    super::determinism::assert_resumes(&spec, 3);
}

#[test]
fn a_body_that_hangs_is_set_down_and_let_go() {
    let mut spec = resting(json!([
        {"run": {"time_s": 0.5}},
        {"place": {"body": 1}},
        {"run": {"time_s": 0.5}}
    ]));
    // a disc of four spheres beside each other, over the one on the floor
    let members: Vec<Value> = [[-1, -1], [-1, 1], [1, -1], [1, 1]]
        .map(|[x, y]| json!({"offset_m": [f64::from(x) * 0.005, f64::from(y) * 0.005, 0], "radius_m": 0.005}))
        .to_vec();
    spec["bodies"].as_array_mut().expect("bodies").push(json!({
        "clump": {"members": members}, "material": "stone", "position_m": [0, 0, 0.5],
        "fixed": ["x", "y", "z", "rx", "ry", "rz"]
    }));
    spec["bodies"][0]["fixed"] = json!(["x", "y", "rx", "ry", "rz"]);
    // free along z once it is placed; turning and sliding stay fixed
    spec["bodies"][1]["fixed"] = json!(["x", "y", "z", "rx", "ry"]);
    let (report, record) = run(&spec);
    let steps = report.summary["steps"].value.expect("steps") as u64;
    let [lower, upper] = [0, 1].map(|number| body(&record, steps, number)[0][2]);
    // members touch it √(0.015² − 2 · 0.005²) above its centre
    let apart = (0.015_f64.powi(2) - 2.0 * 0.005_f64.powi(2)).sqrt();
    assert_close(upper - lower, apart, 1e-5);
    assert!(
        upper - lower < apart,
        "it presses: {}",
        upper - lower - apart
    );
}

#[test]
fn a_body_behind_a_plane_ends_a_run_that_forbids_it() {
    let mut spec = resting(json!([{"run": {"time_s": 0.5}}]));
    spec["stop_when_pushed_through"] = json!(true);
    spec["gravity_m_per_s2"] = json!([0, 0, -1e6]);
    let error = failure(&spec).to_string();
    assert!(error.contains("\"base\""), "{error}");
}

#[test]
fn what_cannot_be_set_down_or_stiffened_is_refused() {
    let refused = |stage: Value, code: &str| {
        let violations = submission(&resting(json!([stage]))).expect_err("not a valid stage");
        assert!(
            violations.iter().any(|violation| violation.code == code),
            "{violations:#?}"
        );
    };
    refused(json!({"place": {"wall": "roof"}}), "no_such_wall");
    refused(json!({"place": {"body": 7}}), "no_such_body");
    refused(json!({"place": {"wall": "lid", "body": 0}}), "not_one_of");
    refused(json!({"place": {}}), "not_one_of");
    refused(json!({"place": {"body": 0, "mass_kg": 1}}), "not_together");
    refused(
        json!({"stiffen": {"factor": 0, "steps": 10}}),
        "out_of_range",
    );
    let mut hertz = resting(json!([{"stiffen": {"factor": 2, "steps": 10}}]));
    hertz["laws"]["contact"] = json!("hertz_mindlin");
    let violations = submission(&hertz).expect_err("Hertz's contacts keep their modulus");
    assert_eq!(violations[0].code, "not_together");
}

/// Step of plates that fall [s].
const STEP_S: f64 = 1e-5;

/// What a plate of 0.2 kg on a sphere does in these stages after it was set down, in steps of [`STEP_S`].
fn plate(stages: &[Value]) -> Value {
    let placed = json!({"place": {"wall": "lid", "mass_kg": 0.2}});
    let stages: Vec<Value> = std::iter::once(placed)
        .chain(stages.iter().cloned())
        .collect();
    let mut spec = resting(json!(stages));
    spec["laws"]["local_damping"] = json!(0.0);
    spec["time_step_s"] = json!(STEP_S);
    spec
}

/// How far the plate came from where it was set down [m].
fn plate_way(spec: &Value) -> f64 {
    let (report, record) = run(spec);
    let created = &report.quality["created_energy_ratio"];
    assert!(created.ok, "{created:?}");
    *record.column("lid_displacement_z_m").last().expect("rows") + 1.0 - 2.0 * RADIUS
}

/// Free fall over so many steps from rest [m]: the velocity of a step is that after it, so g Δt² Σ n.
fn fall(steps: f64) -> f64 {
    0.5 * 10.0 * STEP_S * STEP_S * steps * (steps + 1.0)
}

/// The floor drops away at 3 m/s, and all falls freely, whatever the stages are called on the way.
#[test]
fn a_plate_falls_through_stages_as_through_one() {
    let away = |steps: u32| json!({"move_plane": {"name": "base", "velocity_m_per_s": -3, "steps": steps}});
    let waits = json!({"run": {"steps": 2500}});
    let several = plate(&[
        away(5000),
        away(5000),
        waits.clone(),
        json!({"cut": {"axis": "z", "above_m": 10}}),
        json!({"stiffen": {"factor": 2, "steps": 2500}}),
        waits.clone(),
        waits,
    ]);
    for spec in [plate(&[away(20_000)]), several.clone()] {
        assert_close(plate_way(&spec), -fall(20_000.0), 1e-11);
    }
    super::determinism::assert_resumes(&several, 3);
    // set down anew it stands, and falls from there
    let anew = json!({"place": {"wall": "lid", "mass_kg": 0.2}});
    let spec = plate(&[away(10_000), anew, json!({"run": {"steps": 100}})]);
    assert_close(plate_way(&spec), -fall(10_000.0) - fall(100.0), 1e-11);
    // what was moved stands when it is let go
    let up = json!({"move_plane": {"name": "lid", "velocity_m_per_s": 1, "steps": 30_000}});
    let spec = plate(&[up, json!({"run": {"steps": 10_000}})]);
    assert_close(plate_way(&spec), 0.3 - fall(10_000.0), 1e-11);
}

/// A plate on a sphere that is held is a mass on the spring k = E r, x = mg/k (1 − cos ωt).
#[test]
fn a_plate_swings_through_stages_as_through_one() {
    let omega = (1e6 * RADIUS / 0.2_f64).sqrt();
    let steps = (std::f64::consts::PI / (omega * STEP_S)).round() as u32;
    let quarter = steps / 4;
    let rest = json!({"run": {"steps": steps - 3 * quarter}});
    let part = json!({"run": {"steps": quarter}});
    let deepest = -2.0 * 0.2 * 10.0 / (1e6 * RADIUS);
    let whole = json!({"run": {"steps": steps}});
    for stages in [vec![whole], vec![part.clone(), part.clone(), part, rest]] {
        let mut spec = plate(&stages);
        spec["bodies"][0]["fixed"] = json!(["x", "y", "z", "rx", "ry", "rz"]);
        // a step is 1/450 of the swing
        assert_close(plate_way(&spec), deepest, 1e-4 * -deepest);
    }
}
