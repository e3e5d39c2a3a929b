//! A bond carries what it should and breaks at its strength, in pull and in shear.
use serde_json::{Value, json};

use super::{assert_close, codes, contact, determinism::assert_resumes, one, run, sphere};

const RADIUS: f64 = 0.01;
const STEP: f64 = 1e-6;
/// c r² with c = 1 MPa and 2 MPa.
const NORMAL_STRENGTH: f64 = 100.0;
const SHEAR_STRENGTH: f64 = 200.0;
/// E r, and the same with ν = 0.3.
const NORMAL_STIFFNESS: f64 = 1e6;
const SHEAR_STIFFNESS: f64 = 3e5;

/// Two bonded spheres along x, `overlap` deep, the second driven away at `velocity` without turning.
fn driven(overlap: f64, velocity: [f64; 3], steps: u64) -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": 0.5,
                                "normal_cohesion_pa": 1e6, "shear_cohesion_pa": 2e6}},
        "bodies": [
            {"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, 0], "fixed": ["x", "y", "z", "rx", "ry", "rz"]},
            // one free rotation, which nothing drives: pairs that cannot move are not looked at
            {"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [2.0 * RADIUS - overlap, 0, 0],
             "velocity_m_per_s": velocity, "fixed": ["x", "y", "z", "ry", "rz"]}],
        "time_step_s": STEP,
        "stages": [{"run": {"steps": steps}}],
        "record": {"every_steps": 1, "contacts": true}
    })
}

#[test]
fn a_bond_breaks_at_its_tensile_strength() {
    for overlap in [0.0, 0.004] {
        let speed = 0.1;
        let (report, record) = run(&driven(overlap, [speed, 0.0, 0.0], 2000));
        // F = k v t reaches a_N in the middle of the run
        let breaks = (NORMAL_STRENGTH / (NORMAL_STIFFNESS * speed) / STEP) as u64;
        let (_, [normal, force, shear]) = contact(&record, breaks - 1, [0, 1]).expect("it holds");
        assert_close(normal[0], 1.0, 1e-12);
        // pulled back; the first step does not move yet
        assert_close(
            force[0],
            -NORMAL_STIFFNESS * speed * STEP * (breaks - 2) as f64,
            1e-6,
        );
        assert_close(shear[1], 0.0, 1e-12);
        let later = contact(&record, breaks + 3, [0, 1]);
        match later {
            None => assert!(overlap == 0.0, "they are still inside each other"),
            // broken inside each other: without force, and not thrown apart
            Some((_, [_, force, _])) => assert_close(force[0], 0.0, 0.0),
        }
        assert_eq!(report.summary["bonds"].value, Some(1.0));
        assert_eq!(report.summary["broken_bonds"].value, Some(1.0));
    }
}

#[test]
fn a_soft_bond_holds_over_several_diameters() {
    let (speed, step, steps) = (0.5, 1e-4, 1200);
    let mut spec = driven(0.0, [speed, 0.0, 0.0], steps);
    spec["materials"]["stone"]["youngs_modulus_pa"] = json!(1e4);
    spec["time_step_s"] = json!(step);
    let (report, record) = run(&spec);
    let (_, [_, force, _]) = contact(&record, steps, [0, 1]).expect("it holds");
    let stretch = speed * step * (steps - 1) as f64;
    assert!(stretch > 5.0 * RADIUS, "{stretch}");
    assert_close(force[0], -1e4 * RADIUS * stretch, 1e-6);
    assert_eq!(report.summary["broken_bonds"].value, Some(0.0));
}

#[test]
fn a_bond_pulls_as_before_when_moduli_grow() {
    let (speed, steps, growing) = (1e-3, 10_000, 320);
    let mut spec = driven(0.0, [speed, 0.0, 0.0], steps);
    spec["stages"] =
        json!([{"run": {"steps": steps}}, {"stiffen": {"factor": 100, "steps": growing}}]);
    let (report, record) = run(&spec);
    assert_eq!(report.summary["broken_bonds"].value, Some(0.0));
    let pull = |step| contact(&record, step, [0, 1]).expect("it holds").1[1][0];
    let before = -NORMAL_STIFFNESS * speed * STEP * (steps - 1) as f64;
    assert_close(pull(steps), before, 1e-6);
    // what the way adds meanwhile, at springs between the old and the new
    let way = speed * STEP * growing as f64;
    let added = before - pull(steps + growing);
    assert!(added > NORMAL_STIFFNESS * way && added < 100.0 * NORMAL_STIFFNESS * way);
}

#[test]
fn a_bond_breaks_at_its_shear_strength() {
    let speed = 0.5;
    let (report, record) = run(&driven(0.0, [0.0, speed, 0.0], 2000));
    let rows = record.table("contacts.csv");
    let shear = |row: &Vec<f64>| row[10..13].iter().map(|f| f * f).sum::<f64>().sqrt();
    let strongest = rows
        .iter()
        .filter(|row| row[13] > 0.5)
        .map(shear)
        .fold(0.0, f64::max);
    // moving across, the spheres also part by d²/4r, and F_N tan φ is taken off
    let way = SHEAR_STRENGTH / SHEAR_STIFFNESS;
    let pull = NORMAL_STIFFNESS * way * way / (4.0 * RADIUS);
    let expected = SHEAR_STRENGTH - pull * 0.5_f64.tan();
    assert_close(strongest, expected, 0.02 * expected);
    assert_eq!(report.summary["broken_bonds"].value, Some(1.0));
}

#[test]
fn a_loaded_bond_below_its_strength_holds() {
    let (report, _) = run(&driven(0.002, [0.05, 0.0, 0.0], 1000));
    assert_eq!(report.summary["broken_bonds"].value, Some(0.0));
    assert_eq!(report.summary["contacts"].value, Some(1.0));
}

/// Two spheres whose bond rests where they just touch, made 4 a_N/K inside each other: they are thrown
/// apart, come to rest, and are pulled apart.
fn pressed_together(raised: Option<f64>) -> Value {
    let mut spec = driven(0.0, [0.0; 3], 1);
    let overlap = 4.0 * NORMAL_STRENGTH / NORMAL_STIFFNESS;
    spec["bodies"] = json!([
        sphere("stone", RADIUS, [0.0; 3], [0.0; 3]),
        sphere(
            "stone",
            RADIUS,
            [2.0 * RADIUS - overlap, 0.0, 0.0],
            [0.0; 3]
        )
    ]);
    spec["laws"] = json!({"bond_rest_length": "touching", "local_damping": 0.3});
    if let Some(factor) = raised {
        spec["laws"]["raised_cohesion"] = json!({"factor": factor, "until_stage": 1});
    }
    let pull = |body: u32, velocity: f64| json!({"body": body, "velocity": {"velocity_m_per_s": [velocity, 0, 0]}});
    spec["stages"] = json!([{"run": {"steps": 4000}},
        {"drive": {"bodies": [pull(0, -0.05), pull(1, 0.05)], "steps": 2000}}]);
    spec
}

#[test]
fn cohesion_that_is_raised_at_first_holds_an_overlap_and_is_set_back() {
    // the swing keeps (1 − λ)/(1 + λ) = 0.54 of 4 a_N: 2.2 a_N tear what is not raised
    let broken = |spec: &Value| run(spec).0.summary["broken_bonds"].value;
    let mut spec = pressed_together(None);
    spec["stages"] = json!([spec["stages"][0]]);
    assert_eq!(broken(&spec), Some(1.0));
    let (report, record) = run(&pressed_together(Some(3.0)));
    let rows = record.table("contacts.csv");
    let pulls = |from: f64, to: f64| {
        let rows = rows.iter().filter(|row| row[13] > 0.5);
        let rows = rows.filter(|row| row[0] > from && row[0] <= to);
        rows.map(|row| -row[7]).fold(0.0, f64::max)
    };
    let first = pulls(0.0, 4000.0);
    assert!(
        first > NORMAL_STRENGTH && first < 3.0 * NORMAL_STRENGTH,
        "{first}"
    );
    // at rest when it is set back; then 0.1 N a step more until it has a_N
    assert_close(pulls(4000.0, 6000.0), NORMAL_STRENGTH, 0.15);
    assert_eq!(report.summary["broken_bonds"].value, Some(1.0));
    assert_resumes(&pressed_together(Some(3.0)), 2);
}

/// Cohesion is raised by a stage in between: the pair is pulled beyond a_N there, and tears when the
/// stage after it sets it back.
#[test]
fn cohesion_is_raised_by_a_later_stage_and_set_back_by_the_next() {
    let mut spec = pressed_together(Some(3.0));
    spec["laws"]["bond_rest_length"] = json!("initial");
    let pull = |body: u32, velocity: f64| json!({"body": body, "velocity": {"velocity_m_per_s": [velocity, 0, 0]}});
    let apart = |velocity: f64, force: f64| {
        // both ends move
        let time = force / NORMAL_STIFFNESS / (2.0 * velocity);
        json!({"drive": {"bodies": [pull(0, -velocity), pull(1, velocity)], "time_s": time}})
    };
    spec["laws"]["raised_cohesion"] = json!({"factor": 3.0, "from_stage": 1, "until_stage": 2});
    spec["stages"] = json!([
        apart(0.05, 0.5 * NORMAL_STRENGTH),
        apart(0.05, 1.5 * NORMAL_STRENGTH),
        apart(0.05, 0.01 * NORMAL_STRENGTH)
    ]);
    let (report, record) = run(&spec);
    let rows = record.table("contacts.csv");
    let pulled = rows.iter().filter(|row| row[13] > 0.5);
    let strongest = pulled.map(|row| -row[7]).fold(0.0, f64::max);
    // 0.1 N a step
    assert_close(strongest, 2.0 * NORMAL_STRENGTH, 0.15);
    assert_eq!(report.summary["broken_bonds"].value, Some(1.0));
    // as long as it stays raised, it holds
    let mut held = spec.clone();
    held["stages"] = json!([spec["stages"][0], spec["stages"][1]]);
    held["stages"][1]["drive"]["bodies"] = spec["stages"][1]["drive"]["bodies"].clone();
    held["laws"]["raised_cohesion"] = json!({"factor": 3.0, "from_stage": 0, "until_stage": 1});
    let torn = |spec: &Value| run(spec).0.summary["broken_bonds"].value;
    assert_eq!(torn(&held), Some(1.0));
    held["stages"] = json!([spec["stages"][0], spec["stages"][1], {"run": {"steps": 1}}]);
    held["laws"]["raised_cohesion"] = json!({"factor": 3.0, "from_stage": 1, "until_stage": 2});
    held["laws"]["raised_cohesion"]["from_stage"] = json!(2);
    let pointer = "/spec/laws/raised_cohesion/from_stage";
    assert_eq!(codes(&held), one(pointer, "out_of_order"));
}

#[test]
fn what_cannot_be_raised_or_is_never_set_back_is_refused() {
    let mut spec = pressed_together(Some(3.0));
    spec["laws"]["raised_cohesion"]["until_stage"] = json!(2);
    let pointer = "/spec/laws/raised_cohesion/until_stage";
    assert_eq!(codes(&spec), one(pointer, "no_such_stage"));
    let mut spec = pressed_together(Some(3.0));
    spec["materials"]["stone"]["normal_cohesion_pa"] = json!(0);
    spec["materials"]["stone"]["shear_cohesion_pa"] = json!(0);
    let pointer = "/spec/laws/raised_cohesion/factor";
    assert_eq!(codes(&spec), one(pointer, "not_together"));
}
