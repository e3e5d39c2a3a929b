//! Restitution at the presets: what is asked, and what the raster of steps leaves of it.
//!
//! The guide has the table (`tests/figures granular_restitution`); here its bounds are held.
use serde_json::{Value, json};

use super::{Record, assert_close, run};

const SPEED: f64 = 0.5;
const RADIUS: f64 = 0.001;
/// Places of the first touch in the raster of steps.
const PHASES: u32 = 20;

/// A sphere flies at a plane, a heavier sphere that is held in part, or two triangles.
fn bounce(at: &str, law: &str, asked: f64, accuracy: &str, gap: f64) -> Value {
    let material =
        json!({"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "restitution": asked});
    let grain = |height: f64, speed: f64, fixed: &[&str]| {
        json!({"sphere": {"radius_m": RADIUS}, "material": "g", "position_m": [3e-4, 1e-4, height],
               "velocity_m_per_s": [0, 0, speed], "fixed": fixed})
    };
    let mut bodies = vec![grain(RADIUS + gap, -SPEED, &[])];
    if at == "sphere" {
        bodies.push(grain(-RADIUS, 0.0, &["x", "y", "z", "rx", "ry", "rz"]));
    }
    let [a, b, c, d] = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]];
    let plane =
        json!({"name": "floor", "axis": "z", "position_m": 0, "facing": 1, "material": "g"});
    let facets = json!({"name": "floor", "material": "g", "triangles_m": [[a, b, c], [a, c, d]]});
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"g": material}, "bodies": bodies,
        "planes": if at == "plane" { json!([plane]) } else { json!([]) },
        "facets": if at == "facets" { json!([facets]) } else { json!([]) },
        "laws": {"contact": law}, "accuracy": accuracy, "stages": [{"run": {"time_s": 4e-4}}],
        "record": {"every_steps": 1_000_000, "bodies": [0]}
    })
}

fn rebound(record: &Record) -> f64 {
    let rows = record.table("bodies.csv");
    rows.last().expect("a row")[8] / SPEED
}

/// Least, mean and largest over the places of the first touch.
fn found(at: &str, law: &str, asked: f64, accuracy: &str) -> [f64; 3] {
    let mut found = [f64::INFINITY, 0.0, f64::NEG_INFINITY];
    // a step of the largest preset is about a tenth of this way
    let way = 2e-5;
    for phase in 0..PHASES {
        let gap = way * (1.0 + (f64::from(phase) + 0.5) / f64::from(PHASES));
        let (report, record) = run(&bounce(at, law, asked, accuracy, gap));
        assert_eq!(report.summary["contacts"].value, Some(0.0), "it left");
        assert!(report.quality["created_energy_ratio"].ok);
        let found_now = rebound(&record);
        found[0] = found[0].min(found_now);
        found[1] += found_now / f64::from(PHASES);
        found[2] = found[2].max(found_now);
    }
    found
}

/// Largest error of the mean and of any one impact, at each preset: those of the guide's table, rounded up.
const BOUNDS: [(&str, f64, f64); 3] = [
    ("draft", 0.05, 0.12),
    ("standard", 0.01, 0.04),
    ("reference", 0.002, 0.015),
];

#[test]
fn an_impact_gives_back_what_is_asked_at_every_preset() {
    for (accuracy, of_mean, of_one) in BOUNDS {
        for asked in [0.1, 0.5, 0.9] {
            let [least, mean, most] = found("plane", "linear", asked, accuracy);
            assert_close(mean, asked, of_mean);
            assert!(
                asked - least <= of_one && most - asked <= of_one,
                "{accuracy} {asked}: {least} {most}"
            );
        }
    }
}

#[test]
fn it_is_so_for_every_law_and_partner() {
    let (accuracy, of_mean, of_one) = BOUNDS[1];
    for at in ["plane", "sphere", "facets"] {
        for law in ["linear", "hertz_mindlin"] {
            for asked in [0.1, 0.5] {
                let [least, mean, most] = found(at, law, asked, accuracy);
                assert_close(mean, asked, of_mean);
                assert!(
                    asked - least <= of_one && most - asked <= of_one,
                    "{at} {law} {asked}: {least} {most}"
                );
            }
        }
    }
}

/// The dashpot of a contact at rest carries nothing, whatever the step.
#[test]
fn a_sphere_at_rest_overlaps_by_its_weight_alone() {
    for accuracy in ["draft", "reference"] {
        let mut spec = bounce("plane", "linear", 0.1, accuracy, 0.0);
        spec["gravity_m_per_s2"] = json!([0, 0, -9.81]);
        spec["bodies"][0]["velocity_m_per_s"] = json!([0, 0, 0]);
        spec["stages"] = json!([{"run": {"time_s": 0.02}}]);
        let (_, record) = run(&spec);
        let height = record.table("bodies.csv").last().expect("a row")[5];
        let weight = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 9.81;
        // k = E r; round-off of a height over an overlap of a nanometre
        assert_close((RADIUS - height) / (weight / (1e8 * RADIUS)), 1.0, 1e-8);
    }
}

/// A plate that is dropped on spheres that are held comes back at the speed that is asked of its mass.
#[test]
fn a_plate_bounces_on_what_is_held_as_it_is_asked() {
    let mut spec = bounce("sphere", "linear", 0.5, "reference", 0.0);
    spec["bodies"].as_array_mut().expect("bodies").remove(0);
    spec["planes"] =
        json!([{"name": "plate", "axis": "z", "position_m": 1e-3, "facing": -1, "material": "g"}]);
    // 5 m/s² over a millimetre: 0.1 m/s, against which its load is nothing while it touches
    let load = json!({"name": "plate", "mass_kg": 1e-3, "force_n": -5e-3, "time_s": 0.03});
    spec["stages"] = json!([{"load_plane": load}]);
    spec["record"] = json!({"every_steps": 1, "walls": ["plate"]});
    let (_, record) = run(&spec);
    let time = record.column("time_s");
    let way = record.column("plate_displacement_z_m");
    let speed = |row: usize| (way[row] - way[row - 1]) / (time[row] - time[row - 1]);
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for (row, place) in way.iter().enumerate().skip(1) {
        least = least.min(speed(row));
        if *place > -1e-3 {
            // it has left: before, the dashpot pulls
            most = most.max(speed(row));
        }
    }
    assert_close(least, -0.1, 1e-3);
    assert_close(most, 0.05, 1e-3);
}
