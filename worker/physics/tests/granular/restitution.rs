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

/// A body that a sphere hits from above, its highest point at the origin of heights.
fn partner(members: &[f64], radius: f64, fixed: &[&str]) -> Value {
    let shape = match members {
        [] => json!({"sphere": {"radius_m": radius}}),
        _ => json!({"clump": {"members": members.iter().map(|height|
            json!({"offset_m": [0, 0, height], "radius_m": radius})).collect::<Vec<_>>()}}),
    };
    let top = members.iter().copied().fold(0.0, f64::max);
    let mut body =
        json!({"material": "g", "position_m": [3e-4, 1e-4, -radius - top], "fixed": fixed});
    let (body_fields, shape) = (body.as_object_mut().expect("a body"), shape);
    body_fields.extend(shape.as_object().expect("a shape").clone());
    body
}

/// What the partner of an impact cannot follow counts as infinitely heavy, whatever else it can do.
#[test]
fn what_is_held_along_the_normal_is_infinitely_heavy() {
    let (asked, of_one) = (0.1, BOUNDS[2].2);
    let dumbbell = [-4e-4, 4e-4];
    for (members, radius, fixed) in [
        (&[][..], RADIUS, &["z"][..]),
        (&[], RADIUS, &["y", "z"]),
        (&[], RADIUS, &["x", "y", "z"]),
        // a tenth of the mass
        (&[], 0.46 * RADIUS, &["z"]),
        (&dumbbell, 0.46 * RADIUS, &["z"]),
    ] {
        let mut spec = bounce("", "linear", asked, "reference", 3e-5);
        let bodies = spec["bodies"].as_array_mut().expect("bodies");
        bodies.push(partner(members, radius, fixed));
        let (report, record) = run(&spec);
        assert!(
            report.quality["step_over_critical"].ok,
            "{fixed:?}: {report:?}"
        );
        let found = record.table("bodies.csv").last().expect("a row")[8] / SPEED;
        assert_close(found, asked, of_one);
    }
}

/// The same of one that a stage holds to a velocity, after it was free: what it hits leaves it at this part of
/// the speed at which it comes.
#[test]
fn what_a_stage_drives_is_infinitely_heavy_while_it_does() {
    let (asked, of_one) = (0.3, BOUNDS[2].2);
    for members in [&[][..], &[-4e-4, 4e-4]] {
        let mut spec = bounce("", "linear", asked, "reference", 3e-5);
        spec["bodies"][0]["velocity_m_per_s"] = json!([0, 0, 0]);
        let bodies = spec["bodies"].as_array_mut().expect("bodies");
        bodies.push(partner(members, 0.46 * RADIUS, &[]));
        spec["stages"] = json!([
            {"run": {"steps": 3}},
            {"drive": {"time_s": 4e-4, "flow": true, "bodies": [
                {"body": 1, "velocity": {"velocity_m_per_s": [0, 0, SPEED]}}]}}]);
        let (_, record) = run(&spec);
        let found = record.table("bodies.csv").last().expect("a row")[8] / SPEED - 1.0;
        assert_close(found, asked, of_one);
    }
}

/// Two that slide without friction, hit between the axes: along the normal they part at the speed that is
/// asked, with 0.36 of 1/m left of the one that moves along x alone.
#[test]
fn what_is_held_in_part_counts_with_what_is_left_along_the_normal() {
    let (asked, of_one) = (0.5, BOUNDS[2].2);
    let mut spec = bounce("", "linear", asked, "reference", 0.0);
    let normal = [0.6, 0.8];
    let mut rail = partner(&[], RADIUS, &["y", "z", "rx", "ry", "rz"]);
    // 10 µm along the normal before they touch
    let way = 2.0 * RADIUS + 1e-5;
    rail["position_m"] = json!([3e-4 - normal[0] * way, 1e-4, RADIUS - normal[1] * way]);
    spec["bodies"][0]["velocity_m_per_s"] = json!([-normal[0] * SPEED, 0, -normal[1] * SPEED]);
    spec["bodies"].as_array_mut().expect("bodies").push(rail);
    spec["record"]["bodies"] = json!([0, 1]);
    let (_, record) = run(&spec);
    let rows = record.table("bodies.csv");
    let [grain, rail] = [2, 1].map(|back| &rows[rows.len() - back]);
    let parting = normal[0] * (grain[6] - rail[6]) + normal[1] * (grain[8] - rail[8]);
    assert_close(parting / SPEED, asked, of_one);
    assert!(rail[6] < 0.0 && rail[8].abs() < 1e-15, "{rail:?}");
}

/// A light wall that follows forces across the normal alone stands along it.
#[test]
fn a_plate_has_its_mass_along_what_it_follows_alone() {
    let (asked, of_one) = (0.1, BOUNDS[2].2);
    for at in ["plane", "facets"] {
        let mut spec = bounce(at, "linear", asked, "reference", 3e-5);
        let force = json!({"mass_kg": 1e-6, "force_n": [0, 0, 0], "free": ["x"]});
        spec["stages"] = json!([{"drive": {"time_s": 4e-4, "flow": true,
            "walls": [{"name": "floor", "force": force}]}}]);
        let (_, record) = run(&spec);
        assert_close(rebound(&record), asked, of_one);
    }
}
