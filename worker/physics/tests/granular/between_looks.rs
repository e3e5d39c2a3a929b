//! What happens between two looks is told all the same: quality figures have seen every step.
use serde_json::{Value, json};

use super::{Record, assert_close, determinism::assert_resumes, run, run_on, sphere};

const RADIUS: f64 = 0.01;
const STEP: f64 = 2e-5;
/// Nothing is looked at between the first step and the last of so many.
const STEPS: u64 = 240;
/// One ratio reckoned from rows with all digits, relative.
const ROUND_OFF: f64 = 1e-12;

/// Fixed as a whole but for a turn that nothing drives: contacts of bodies that cannot move are none.
fn target(speed: f64) -> Value {
    json!({"sphere": {"radius_m": RADIUS}, "material": "stone", "position_m": [0, 0, -RADIUS],
           "velocity_m_per_s": [0, 0, speed], "fixed": ["x", "y", "z", "rx", "ry"]})
}

/// A sphere that flies at a plane, a sphere or two triangles, bounces once and leaves.
fn bounce(at: &str, law: &str, friction: f64) -> Value {
    let corners = [
        [-0.1, -0.1, 0.0],
        [0.1, -0.1, 0.0],
        [0.1, 0.1, 0.0],
        [-0.1, 0.1, 0.0],
    ];
    let [a, b, c, d] = corners;
    let height = RADIUS + 5e-4;
    let ball = match at {
        // straight: rows of a contact along an axis are its own frequency
        "sphere" => sphere("stone", RADIUS, [0.0, 0.0, height], [0.0, 0.0, -1.0]),
        // off the common edge of the triangles
        _ => sphere("stone", RADIUS, [2e-3, -1e-3, height], [0.1, 0.0, -1.0]),
    };
    let mut material = json!({"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
                              "stiffness_ratio": 0.3, "friction_angle_rad": friction});
    if law == "bonded" {
        material["normal_cohesion_pa"] = json!(1e6);
        material["shear_cohesion_pa"] = json!(1e6);
    }
    let law = if law == "bonded" { "linear" } else { law };
    let mut bodies = vec![ball];
    if at == "sphere" {
        bodies.push(target(0.0));
    }
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": material}, "bodies": bodies,
        "planes": if at == "plane" { json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}]) } else { json!([]) },
        "facets": if at == "facets" { json!([{"name": "floor", "material": "stone", "triangles_m": [[a, b, c], [a, c, d]]}]) } else { json!([]) },
        "laws": {"local_damping": 0.0, "contact": law},
        "time_step_s": STEP,
        "stages": [{"run": {"steps": STEPS}}],
        "record": {"every_steps": 1_000_000}
    })
}

/// Largest size of an overlap over the radius in `contacts.csv`.
fn deepest(record: &Record) -> f64 {
    let rows = record.table("contacts.csv");
    rows.iter().fold(0.0, |most, row| row[3].abs().max(most)) / RADIUS
}

/// The two figures of a run that hardly looks are those of one that looks at every step.
#[track_caller]
fn assert_seen(spec: &Value) {
    let mut looking = spec.clone();
    looking["record"] = json!({"every_steps": 1, "contacts": true});
    let (_, record) = run(&looking);
    let deepest = deepest(&record);
    let critical = record.column("step_over_critical");
    let critical = critical.iter().copied().fold(0.0, f64::max);
    assert!(deepest > 0.01 && critical > 0.01, "{deepest} {critical}");
    for threads in [1, 2] {
        let (report, record) = run_on(spec, threads);
        assert_eq!(record.points.len(), 2, "{:?}", record.points);
        let value = |name: &str| report.quality[name].value;
        assert_close(value("largest_overlap_ratio") / deepest, 1.0, ROUND_OFF);
        assert_close(value("step_over_critical") / critical, 1.0, ROUND_OFF);
    }
}

#[test]
fn a_bounce_between_two_looks_is_seen() {
    for at in ["plane", "sphere", "facets"] {
        for law in ["linear", "logarithmic", "hertz_mindlin", "bonded"] {
            for friction in [0.0, 0.4] {
                let spec = bounce(at, law, friction);
                let (report, record) = run(&spec);
                // it came and went unobserved
                assert_eq!(report.summary["contacts"].value, Some(0.0), "{at} {law}");
                assert_eq!(record.points.len(), 2);
                assert_seen(&spec);
            }
        }
    }
}

#[test]
fn a_bond_that_is_pulled_between_two_looks_is_seen() {
    for rest in ["touching", "initial"] {
        let mut spec = bounce("sphere", "bonded", 0.4);
        spec["laws"]["bond_rest_length"] = json!(rest);
        spec["materials"]["stone"]["normal_cohesion_pa"] = json!(1e9);
        spec["materials"]["stone"]["shear_cohesion_pa"] = json!(1e9);
        spec["bodies"][0] = sphere("stone", RADIUS, [0.0, 0.0, RADIUS], [0.0, 0.0, 1.0]);
        // a swing and a quarter
        spec["stages"] = json!([{"run": {"steps": 130}}]);
        assert_seen(&spec);
    }
}

#[test]
fn a_hard_bounce_that_nobody_saw_is_warned_of() {
    let mut spec = bounce("plane", "logarithmic", 0.0);
    spec["bodies"][0]["velocity_m_per_s"] = json!([0, 0, -10.0]);
    let (report, _) = run(&spec);
    let check = &report.quality["largest_overlap_ratio"];
    assert!(!check.ok && check.value > 0.2, "{check:?}");
    let critical = &report.quality["step_over_critical"];
    let words = "set by body 0 and its contact with plane \"base\"";
    assert!(critical.description.contains(words), "{critical:?}");
    let energy = &report.quality["created_energy_ratio"];
    let words = format!("looks in {STEPS} steps");
    assert!(energy.description.contains(&words), "{energy:?}");
}

/// To and fro between two planes, harder at first: what was worst is in the checkpoint.
#[test]
fn the_worst_survives_a_run_in_pieces() {
    let mut spec = bounce("plane", "hertz_mindlin", 0.4);
    let lid =
        json!({"name": "lid", "axis": "z", "position_m": 0.025, "facing": -1, "material": "stone"});
    spec["planes"].as_array_mut().expect("planes").push(lid);
    spec["materials"]["stone"]["restitution"] = json!(0.9);
    spec["stages"] = json!([{"run": {"steps": 20_000}}]);
    assert_resumes(&spec, 3);
}

/// What a scene is relaxed from is not the scene that is asked about.
#[test]
fn overlaps_that_are_relaxed_do_not_count() {
    let mut spec = bounce("sphere", "linear", 0.4);
    spec["bodies"][0] = sphere("stone", RADIUS, [0.0, 0.0, 0.9 * RADIUS], [0.0; 3]);
    spec["stages"] = json!([{"relax": {"largest_overlap_ratio": 0.01, "steps": 100_000}}, {"run": {"steps": 10}}]);
    let (report, _) = run(&spec);
    let overlap = report.quality["largest_overlap_ratio"].value;
    assert!(overlap > 0.0 && overlap <= 0.01, "{overlap}");
}
