//! Breakable grains: bonded within themselves only, crushed into fragments that add up.
#![allow(
    clippy::float_cmp,
    reason = "counts, and numbers that are handed through"
)]
use serde_json::{Value, json};

use super::{assert_close, determinism::assert_resumes, run, scene};

/// Balls of 48 mm of 135 members, as in the oedometer of the thesis, between two planes.
fn press(bodies: &Value, stages: &Value) -> Value {
    let plane = |name: &str, at: f64, facing: i32| json!({"name": name, "axis": "z", "position_m": at, "facing": facing, "material": "steel"});
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {
            "rock": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 5e8, "friction_angle_rad": 0.5,
                     "normal_cohesion_pa": 5e5, "shear_cohesion_pa": 5e5},
            "steel": {"density_kg_per_m3": 7850, "youngs_modulus_pa": 5e9, "friction_angle_rad": 0.3}},
        "bodies": bodies,
        "planes": [plane("base", -0.024, 1), plane("top", 0.024, -1)],
        "stages": stages,
        "record": {"every_steps": 500, "planes": ["top"]}
    })
}

fn ball(x: f64) -> Value {
    json!({"breakable": {"filled": {"shape": {"ellipsoid": {"semi_axes_m": [0.024, 0.024, 0.024]}}, "member_radius_m": 0.0036}},
           "material": "rock", "position_m": [x, 0, 0]})
}

#[test]
fn members_are_bonded_within_their_grain_only() {
    let stages = json!([{"run": {"steps": 1}}]);
    let (one, _) = run(&press(&json!([ball(0.0)]), &stages));
    assert_eq!(one.bodies.len(), 135);
    // every pair that touches, and each pair once
    let bodies = &one.bodies;
    let mut touching = 0;
    for (index, a) in bodies.iter().enumerate() {
        for b in &bodies[..index] {
            let square: f64 = (0..3)
                .map(|axis| (a.centre_m[axis] - b.centre_m[axis]).powi(2))
                .sum();
            touching += u32::from(square.sqrt() < 0.0072 * (1.0 + 1e-6));
        }
    }
    assert_eq!(one.summary["bonds"].value, Some(f64::from(touching)));
    // rows along x end at ±4 spacings or less, so that two balls touch in their outermost members
    let reach = bodies
        .iter()
        .map(|body| body.centre_m[0])
        .fold(0.0, f64::max);
    let (two, record) = run(&press(
        &json!([ball(0.0), ball(2.0 * reach + 0.0072)]),
        &stages,
    ));
    assert_eq!(two.summary["bonds"].value, Some(2.0 * f64::from(touching)));
    assert!(
        two.summary["contacts"].value > two.summary["bonds"].value,
        "the balls touch"
    );
    let first = &record.table("fragments.csv")[0];
    assert_eq!(first[3..8], [2.0, 2.0, 2.0, 135.0, 135.0]);
}

#[test]
fn a_crushed_ball_falls_into_ever_smaller_fragments() {
    let stages = json!([{"move_plane": {"name": "top", "velocity_m_per_s": -1, "time_s": 0.03}}]);
    let mut spec = press(&json!([ball(0.0)]), &stages);
    spec["record"]["snapshot_every_steps"] = json!(1_000_000);
    let (report, record) = run(&spec);
    let rows = record.table("fragments.csv");
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!(first[3..8], [1.0, 1.0, 1.0, 135.0, 135.0]);
    assert_eq!(first[13], 1.0, "all mass in pieces of 135 and more");
    assert_eq!(first[14], 1.0, "and whole");
    assert_eq!(last[14], 0.0, "nothing is whole");
    // the mass curve at the end has the fragments of the last row, and ends at all of the mass
    let sizes = record.table("fragment_sizes.csv");
    assert_close(sizes.iter().map(|size| size[1]).sum(), last[5], 1e-12);
    assert_close(
        sizes.iter().map(|size| size[0] * size[1]).sum(),
        135.0,
        1e-12,
    );
    let largest = &sizes[sizes.len() - 1];
    assert_eq!(largest[0], last[7]);
    assert_close(largest[3], 1.0, 1e-12);
    assert!(
        sizes
            .windows(2)
            .all(|pair| pair[0][0] < pair[1][0] && pair[0][3] < pair[1][3])
    );
    assert!(last[4] < 0.5 && last[6] < 20.0, "{last:?}");
    let mass = 135.0 * 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.0036_f64.powi(3);
    for pair in rows.windows(2) {
        // bonds do not heal
        assert!(pair[1][6] <= pair[0][6], "{pair:?}");
    }
    for row in &rows {
        assert_close(row[8], mass, 1e-12 * mass);
        assert_close(row[9..14].iter().sum(), 1.0, 1e-12);
        assert_close(row[6] * row[5], 135.0, 1e-9);
    }
    let broken = record.column("broken_bonds");
    assert!(broken.windows(2).all(|pair| pair[0] <= pair[1]));
    assert_eq!(broken.last().copied(), report.summary["broken_bonds"].value);
    // each break has its place in the press, and its time
    let map = record.table("broken_bonds.csv");
    assert_eq!(Some(map.len() as f64), report.summary["broken_bonds"].value);
    assert!(map.windows(2).all(|pair| pair[0][1] <= pair[1][1]));
    for row in &map {
        assert!(
            row[3].hypot(row[4]) < 0.1 && row[5].abs() < 0.024,
            "{row:?}"
        );
        assert!(row[7] < row[8] && row[8] < 135.0, "{row:?}");
    }
    let stages = scene::array(&record.files["broken_bonds.vtp"], "stage");
    assert_eq!(stages.len(), 4 * map.len());
    // the picture shows the same pieces
    let names: Vec<&String> = record
        .files
        .keys()
        .filter(|name| name.starts_with("snapshots/step"))
        .collect();
    let numbers = |name: &str, file: &str| -> Vec<i32> {
        let bytes = scene::array(&record.files[file], name);
        bytes
            .chunks_exact(4)
            .map(|bytes| i32::from_le_bytes(bytes.try_into().expect("four bytes")))
            .collect()
    };
    let mut fragments = numbers("fragment", names[names.len() - 1]);
    assert!(numbers("grain", names[0]).iter().all(|grain| *grain == 0));
    fragments.sort_unstable();
    fragments.dedup();
    assert_eq!(fragments.len() as f64, last[5]);
}

#[test]
fn grains_that_are_poured_are_bonded_when_they_come() {
    let grain = json!({"breakable": {"members": [{"offset_m": [0, 0, 0], "radius_m": 0.005}, {"offset_m": [0.01, 0, 0], "radius_m": 0.005},
                                                 {"offset_m": [0, 0.01, 0], "radius_m": 0.005}]}});
    let mut spec = press(&json!([ball(0.0)]), &json!([]));
    spec["gravity_m_per_s2"] = json!([0, 0, -9.81]);
    spec["planes"] = json!([spec["planes"][0]]);
    spec["record"] = json!({"every_steps": 500});
    spec["stages"] = json!([
        {"insert": {"every_s": 0.01, "time_s": 1, "batch": 4, "bodies": {"material": "rock", "grain": grain, "count": 10,
            "region": {"cylinder": {"base_m": [0, 0, 0.05], "radius_m": 0.05, "height_m": 0.05}}}}},
        {"cut": {"axis": "z", "above_m": 0.06}}, {"run": {"steps": 100}}]);
    let (report, record) = run(&spec);
    let of = |name: &str| report.summary[name].value.expect("a value");
    let rows = record.table("fragments.csv");
    let poured = rows
        .iter()
        .rfind(|row| row[2] == 1.0)
        .expect("the end of the first stage");
    assert_eq!(poured[3], 11.0);
    let last = &rows[rows.len() - 1];
    assert!(last[3] < 11.0, "the cut took whole grains");
    assert_eq!(last[3], last[4], "and tore none");
    assert_eq!(of("removed_bodies") + of("bodies"), 165.0);
    assert_eq!(of("broken_bonds"), 0.0);
    assert!(
        !record.files.contains_key("broken_bonds.csv"),
        "taken out, not broken"
    );
    assert_resumes(&spec, 1);
}
