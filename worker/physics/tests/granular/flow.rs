//! Bodies that come and go during a test.
#![allow(
    clippy::float_cmp,
    reason = "counts, and numbers that are handed through"
)]
use serde_json::{Value, json};

use super::{assert_close, body, determinism::assert_resumes, run, run_on, sphere};

/// Grains poured on a base between four walls, `more` stages after that.
fn poured(count: u32, grain: &Value, time_s: f64, more: &[Value]) -> Value {
    let plane = |name: &str, axis: &str, at: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": at, "facing": facing, "material": if name == "base" {"stone"} else {"glass"}});
    let mut stages = vec![
        json!({"insert": {"every_s": 0.03, "time_s": time_s, "bodies": {
        "material": "stone", "grain": grain, "count": count, "velocity_m_per_s": [0, 0, -1],
        "sizes": {"uniform": {"smallest_radius_m": 0.008, "largest_radius_m": 0.012}},
        "region": {"box": {"lower_m": [0, 0, 0.2], "upper_m": [0.1, 0.1, 0.28]}}}}}),
    ];
    stages.extend_from_slice(more);
    json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.4},
                      // walls that carry no weight
                      "glass": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0}},
        "planes": [plane("base", "z", 0.0, 1), plane("left", "x", 0.0, 1), plane("right", "x", 0.1, -1),
                   plane("front", "y", 0.0, 1), plane("back", "y", 0.1, -1)],
        "stages": stages,
        "record": {"every_steps": 500, "planes": ["base"]}
    })
}

fn pair() -> Value {
    json!({"clump": {"members": [{"offset_m": [0, 0, 0], "radius_m": 1}, {"offset_m": [1, 0, 0], "radius_m": 1}]}})
}

#[test]
fn grains_are_poured_until_all_are_in() {
    let settle = json!({"settle": {"time_s": 1.0}});
    let mut spec = poured(150, &json!("sphere"), 5.0, &[settle]);
    // δ/r = v √(4π ρ/3E) of the fastest impact stays below a twentieth
    spec["materials"]["stone"]["youngs_modulus_pa"] = json!(4e7);
    let (report, record) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(report.summary["bodies"].value, Some(150.0));
    assert_eq!(report.bodies.len(), 150);
    assert!(report.quality["largest_overlap_ratio"].ok);
    // the stage ended long before its time, one interval after the last batch
    let stage = record.column("stage");
    let time = record.column("time_s");
    let end = time[stage
        .iter()
        .position(|stage| *stage > 1.5)
        .expect("a second stage")];
    assert!(end < 1.5, "{end}");
    // what came in rests on the base
    let mass = report.summary["total_mass"].value.expect("a mass");
    let force = *record.column("base_force_n").last().expect("a row");
    assert_close(force, -9.81 * mass, 0.02 * 9.81 * mass);
}

#[test]
fn a_stage_that_ends_too_early_tells_what_it_left() {
    let (report, _) = run(&poured(
        150,
        &json!("sphere"),
        0.05,
        &[json!({"run": {"steps": 10}})],
    ));
    let warning = report
        .warnings
        .iter()
        .find(|warning| warning.code == "not_inserted");
    let inserted = report.summary["bodies"].value.expect("a number");
    assert!(inserted > 20.0 && inserted < 150.0, "{inserted}");
    let text = &warning.expect("a warning").detail;
    assert!(
        text.contains(&format!("stage 1 ended before {} of", 150.0 - inserted)),
        "{text}"
    );
}

#[test]
fn pouring_and_cutting_give_the_same_bytes_in_pieces_and_on_threads() {
    let more = [
        json!({"run": {"steps": 400}}),
        json!({"cut": {"axis": "z", "above_m": 0.03, "below_m": 0.009}}),
        json!({"run": {"steps": 400}}),
    ];
    for grain in [json!("sphere"), pair()] {
        let spec = poured(80, &grain, 5.0, &more);
        let (report, record) = run(&spec);
        assert!(report.summary["removed_bodies"].value > Some(10.0));
        let (on_threads, other) = run_on(&spec, 3);
        assert_eq!(on_threads, report);
        assert!(other.files == record.files);
        assert_resumes(&spec, 1);
    }
}

#[test]
fn a_cut_takes_what_is_above_and_leaves_the_rest_as_it_was() {
    let bodies: Vec<Value> = (0..4)
        .map(|number| {
            sphere(
                "stone",
                0.01,
                [0.0, 0.0, 0.1 * f64::from(number)],
                [0.1, 0.2, 0.3 * f64::from(number)],
            )
        })
        .collect();
    let mut spec = poured(1, &json!("sphere"), 1.0, &[]);
    spec["bodies"] = json!(bodies);
    spec["planes"] = json!([]);
    spec["record"] = json!({"every_steps": 1, "bodies": [0, 1, 2, 3]});
    spec["time_step_s"] = json!(1e-5);
    let stages = |with_cut: bool| {
        let cut = json!({"cut": {"axis": "z", "above_m": 0.25, "below_m": 0.05}});
        let run = json!({"run": {"steps": 50}});
        if with_cut {
            json!([run, cut, run])
        } else {
            json!([run, run])
        }
    };
    spec["stages"] = stages(false);
    let (whole, uncut) = run(&spec);
    spec["stages"] = stages(true);
    let (report, cut) = run(&spec);
    for number in [1, 2] {
        assert_eq!(body(&cut, 100, number), body(&uncut, 100, number));
    }
    let rows = cut.table("bodies.csv");
    let last = |number: f64| {
        rows.iter()
            .filter(|row| row[2] == number)
            .map(|row| row[0])
            .fold(0.0, f64::max)
    };
    assert_eq!([0.0, 1.0, 2.0, 3.0].map(last), [50.0, 100.0, 100.0, 50.0]);
    let of =
        |report: &loadframe_api::Report, name: &str| report.summary[name].value.expect("a value");
    assert_eq!(of(&report, "removed_bodies"), 2.0);
    assert_close(
        of(&report, "removed_mass") + of(&report, "total_mass"),
        of(&whole, "total_mass"),
        1e-15,
    );
    let numbers: Vec<u32> = report.bodies.iter().map(|body| body.body).collect();
    assert_eq!(numbers, [1, 2]);
}

/// A pile under its own weight loses its upper half: what is left springs back, and no energy comes
/// from nowhere.
#[test]
fn energy_stays_sound_over_a_cut() {
    let more = [
        json!({"settle": {"time_s": 1.0, "unbalanced_force_ratio": 0.001}}),
        json!({"cut": {"axis": "z", "above_m": 0.04}}),
        json!({"settle": {"time_s": 1.0, "unbalanced_force_ratio": 0.001}}),
    ];
    let (report, record) = run(&poured(150, &json!("sphere"), 5.0, &more));
    let created = &report.quality["created_energy_ratio"];
    assert!(created.value < 1e-3, "{created:?}");
    assert!(report.bodies.iter().all(|body| body.centre_m[2] <= 0.041));
    let (stage, elastic) = (record.column("stage"), record.column("elastic_energy_j"));
    let before = stage.iter().rposition(|stage| *stage < 2.5).expect("a row");
    // what carries half the height stores far less
    assert!(*elastic.last().expect("a row") < 0.5 * elastic[before]);
    let mass = report.summary["total_mass"].value.expect("a mass");
    let force = *record.column("base_force_n").last().expect("a row");
    assert_close(force, -9.81 * mass, 0.02 * 9.81 * mass);
}

#[test]
fn a_cut_without_height_is_refused() {
    let spec = poured(5, &json!("sphere"), 1.0, &[json!({"cut": {"axis": "z"}})]);
    let violations = super::submission(&spec).expect_err("no height");
    assert_eq!(
        (violations[0].pointer.as_str(), violations[0].code.as_str()),
        ("/spec/stages/1/cut", "no_height")
    );
}
