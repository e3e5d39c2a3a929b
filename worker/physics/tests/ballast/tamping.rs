//! Beds that are beaten by their plate, or shaken by their base.
use serde_json::{Value, json};

use super::{run, scene::Record, small_oedometer, submission};

const FREQUENCY: f64 = 25.0;
const AMPLITUDE: f64 = 1e-3;

/// An oedometer that is only tamped, with a touch of load.
fn tamped(by: &str) -> Value {
    let mut job = small_oedometer();
    // three whole swings, for two and a half are asked for
    job["spec"]["preparation"] = json!({"compaction": null, "tamping": {"by": by,
        "frequency_hz": FREQUENCY, "amplitude_m": AMPLITUDE, "time_s": 0.1}});
    job["spec"]["test"] = json!({"smallest_force_n": 50, "peak_force_n": 100});
    job
}

/// Stage, from 1, and porosity at the end of a phase, and of the one before.
fn around(record: &Record, phase: &str) -> [(f64, f64); 2] {
    let text = std::str::from_utf8(&record.files["preparation.csv"]).expect("text");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let found = rows.iter().position(|row| row[1] == phase);
    let found = found.unwrap_or_else(|| panic!("no {phase} in {text}"));
    let number = |row: usize, column: usize| rows[row][column].parse().expect("a number");
    [found - 1, found].map(|row| (number(row, 0), number(row, 3)))
}

#[test]
fn a_plate_follows_its_sine_down_and_back_and_a_base_up_and_down() {
    for (by, wall) in [("plate", "plate"), ("base", "base")] {
        let (_, record) = run(&tamped(by));
        let [_, (stage, _)] = around(&record, "tamp");
        // the same scene, told from the start
        let mut scene: Value = serde_json::from_slice(&record.files["scene.json"]).expect("JSON");
        scene["spec"]["record"]["from_stage"] = json!(0);
        let (_, record) = run(&scene);
        let [time, stages, way] = ["time_s", "stage", &format!("{wall}_displacement_z_m")]
            .map(|name| record.column(name));
        let rows: Vec<usize> = (0..time.len())
            .filter(|row| stages[*row].to_bits() == stage.to_bits())
            .collect();
        let (first, last) = (rows[0] - 1, rows[rows.len() - 1]);
        let lasted = time[last] - time[first];
        assert!((lasted * FREQUENCY - 3.0).abs() < 1e-9, "{lasted}");
        for row in rows {
            let phase = std::f64::consts::TAU * FREQUENCY * (time[row] - time[first]);
            let expected = match by {
                "plate" => AMPLITUDE * (phase.cos() - 1.0),
                _ => AMPLITUDE * phase.sin(),
            };
            let moved = way[row] - way[first];
            assert!((moved - expected).abs() < 1e-10, "{by} {moved} {expected}");
        }
        // it ends where it began
        assert!((way[last] - way[first]).abs() < 1e-10);
    }
}

#[test]
fn a_bed_that_is_tamped_is_denser_than_one_that_is_not() {
    let porosity = |job: &Value| super::value(&run(job).0, "initial_porosity");
    let mut poured = tamped("plate");
    let preparation = poured["spec"]["preparation"].as_object_mut();
    preparation.expect("a part").remove("tamping");
    let poured = porosity(&poured);
    for by in ["plate", "base"] {
        let tamped = porosity(&tamped(by));
        assert!(tamped < poured - 0.003, "{by}: {tamped} {poured}");
    }
}

#[test]
fn a_sleeper_of_spheres_beats_nothing() {
    let mut job = json!({"kind": "ballast_box", "spec": tamped("plate")["spec"]});
    job["spec"]["apparatus"] = json!({"sleeper": {"member_radius_m": 0.01}});
    let violations = submission(&job).expect_err("it is a body");
    assert_eq!(violations[0].pointer, "/spec/preparation/tamping/by");
    job["spec"]["preparation"]["tamping"]["by"] = json!("base");
    submission(&job).expect("its base may swing");
}
