//! Beds that are beaten by their plate, or shaken by their base.
use loadframe_api::{JobSpec, spec::ballast::Phase};
use serde_json::{Value, json};

use super::{run, small_oedometer, submission};

const FREQUENCY: f64 = 25.0;
const AMPLITUDE: f64 = 1e-3;

/// An oedometer that is only tamped.
fn tamped(by: &str) -> Value {
    let mut job = small_oedometer();
    // three whole swings, for two and a half are asked for
    job["spec"]["preparation"] = json!({"compaction": null, "tamping": {"by": by,
        "frequency_hz": FREQUENCY, "amplitude_m": AMPLITUDE, "time_s": 0.1}});
    job
}

#[test]
fn a_plate_follows_its_sine_down_and_back_and_a_base_up_and_down_and_both_make_the_bed_denser() {
    for (by, wall) in [("plate", "plate"), ("base", "base")] {
        let JobSpec::BallastOedometer(spec) = submission(&tamped(by)).expect("a valid job") else {
            panic!("another kind");
        };
        // its scene until the bed has come to rest again, told from the start
        let script = spec.script();
        let tamp = script.phases.iter().position(|phase| *phase == Phase::Tamp);
        let tamp = tamp.expect("it is tamped");
        let mut scene = script.scene;
        scene.stages.truncate(tamp + 2);
        scene.record.from_stage = 0;
        scene.record.walls.push("plate".to_owned());
        let (_, record) = run(&json!({"kind": "granular_scene", "spec": scene}));
        let [time, stages, way, plate] = [
            "time_s",
            "stage",
            &format!("{wall}_displacement_z_m"),
            "plate_displacement_z_m",
        ]
        .map(|name| record.column(name));
        let rows: Vec<usize> = (0..time.len())
            .filter(|row| stages[*row] as usize == tamp + 1)
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
        // the plate comes to rest deeper than it lay before
        let deeper = plate[first] - plate[plate.len() - 1];
        assert!(deeper > 0.2e-3, "{by}: {deeper}");
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
