//! The same bytes on any number of threads, and across checkpoint and resume.
use loadframe_physics::{Ending, Interrupt, Uninterrupted};
use serde_json::{Value, json};

use super::{
    job, run, run_on,
    scene::{AtLook, Record, run_job},
};

/// Grains in a box that fall on each other: more than two patches of them.
pub(super) fn rain(side: usize, friction: f64, steps: u64, with_clumps: bool) -> Value {
    let mut bodies = Vec::new();
    for number in 0..side * side * side {
        let place = [number % side, number / side % side, number / side / side];
        // some tenth of a radius off the raster, without a random stream
        let jitter = |axis: usize| ((number * 7919 + axis * 104_729) % 1000) as f64 * 1e-6;
        let position: Vec<f64> = (0..3)
            .map(|axis| 0.012 + place[axis] as f64 * 0.0215 + jitter(axis))
            .collect();
        let shape = if with_clumps && number % 5 == 0 {
            json!({"clump": {"members": [{"offset_m": [-0.003, 0, 0], "radius_m": 0.007}, {"offset_m": [0.003, 0, 0], "radius_m": 0.007}]}})
        } else {
            json!({"sphere": {"radius_m": 0.009 + 0.001 * (number % 3) as f64 / 3.0}})
        };
        let mut body = json!({"material": "stone", "position_m": position, "velocity_m_per_s": [0.3 - place[0] as f64 * 0.1, 0.0, -1.0]});
        for (key, value) in shape.as_object().expect("an object") {
            body[key] = value.clone();
        }
        bodies.push(body);
    }
    let width = 0.0215 * side as f64 + 0.003;
    let plane = |name: &str, axis: &str, position: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": position, "facing": facing, "material": "stone"});
    json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "stiffness_ratio": 0.3, "friction_angle_rad": friction}},
        "bodies": bodies,
        "planes": [plane("base", "z", 0.0, 1), plane("left", "x", 0.0, 1), plane("right", "x", width, -1),
                   plane("front", "y", 0.0, 1), plane("back", "y", width, -1), plane("lid", "z", width + 0.01, -1)],
        "stages": [{"run": {"steps": steps}}, {"move_plane": {"name": "lid", "velocity_m_per_s": -0.5, "steps": steps}}],
        "record": {"every_steps": 100, "planes": ["lid", "base"], "contacts": true, "bodies": [0, 1, 2, 3, 4, 5, 6, 7]}
    })
}

/// Multiplies all places by a factor, so that neighbours touch.
pub(super) fn draw_together(spec: &mut Value, factor: f64) {
    for body in spec["bodies"].as_array_mut().expect("bodies") {
        for place in body["position_m"].as_array_mut().expect("a place") {
            *place = json!(factor * place.as_f64().expect("a number"));
        }
    }
}

#[test]
fn results_have_the_same_bits_on_any_number_of_threads() {
    for (friction, with_clumps) in [(0.5, true), (0.0, false)] {
        let spec = rain(17, friction, 400, with_clumps);
        let (expected, record) = run(&spec);
        assert!(
            expected.summary["contacts"].value > Some(300.0),
            "{:?}",
            expected.summary["contacts"]
        );
        for threads in [2, 3, 8] {
            let (report, other) = run_on(&spec, threads);
            assert_eq!(report, expected, "{threads} threads");
            assert!(other.files == record.files, "{threads} threads");
        }
    }
}

/// So many patches that two threads work through them in waves.
#[test]
fn a_large_bed_has_the_same_bits_on_any_number_of_threads() {
    let mut spec = rain(33, 0.5, 20, false);
    draw_together(&mut spec, 0.92);
    spec["record"]["every_steps"] = json!(10);
    let (expected, record) = run(&spec);
    assert!(
        expected.summary["contacts"].value > Some(5000.0),
        "{:?}",
        expected.summary["contacts"]
    );
    for threads in [2, 3] {
        let (report, other) = run_on(&spec, threads);
        assert_eq!(report, expected, "{threads} threads");
        assert!(other.files == record.files, "{threads} threads");
    }
}

/// Contacts are put in order for files that list them, sums over them do not depend on it.
#[test]
fn a_curve_does_not_depend_on_what_else_is_recorded() {
    let mut spec = rain(9, 0.5, 300, true);
    spec["record"]["regions"] = json!([{"name": "all"}]);
    let (_, listed) = run(&spec);
    spec["record"]["contacts"] = json!(false);
    let (_, alone) = run(&spec);
    spec["record"]["snapshot_every_steps"] = json!(100);
    let (_, pictured) = run(&spec);
    let curve = |record: &Record| record.files["curve.csv"].clone();
    assert!(!curve(&alone).is_empty());
    assert!(curve(&listed) == curve(&alone), "with contacts");
    assert!(curve(&pictured) == curve(&alone), "with snapshots");
}

#[test]
fn a_run_in_pieces_gives_the_same_bytes() {
    let spec = rain(9, 0.5, 500, true);
    let checkpoint = assert_resumes(&spec, 3);
    let other = {
        let mut other = spec.clone();
        other["seed"] = json!(2);
        super::job(&other)
    };
    let foreign = run_job(
        &other,
        &mut Record::default(),
        &Uninterrupted,
        Some(&checkpoint),
        1,
    );
    assert!(foreign.is_err());
}

/// A run that is suspended every so many looks gives the bytes of one that is not. Returns its last
/// checkpoint.
pub(super) fn assert_resumes(spec: &Value, looks: u64) -> Vec<u8> {
    let (expected, whole) = run(spec);
    let job = job(spec);
    let mut record = Record::default();
    let mut checkpoint: Option<Vec<u8>> = None;
    let mut pieces = 0;
    let report = loop {
        pieces += 1;
        let interrupt = AtLook::new(Interrupt::Suspend, looks);
        let ending = run_job(
            &job,
            &mut record,
            &interrupt,
            checkpoint.as_deref(),
            1 + pieces % 2,
        );
        match ending.expect("the scene can be run") {
            Ending::Finished(report) => break report,
            Ending::Suspended => checkpoint = record.checkpoint.take(),
            Ending::Cancelled => panic!("nobody cancelled"),
        }
    };
    assert!(pieces > 3, "{pieces}");
    assert_eq!(report, expected);
    assert!(record.files == whole.files);
    assert_eq!(record.points, whole.points);
    checkpoint.expect("it was suspended")
}
