//! Sheets that are given.
use serde_json::{Value, json};

use super::{codes, go, pulp, value};

/// E A = 30 GPa × π 2 (28 − 2) µm² [mN].
const EA_MN: f64 = 30.0 * std::f64::consts::PI * 2.0 * 26.0;

/// Two fibres of which each reaches 600 µm into a gap of 1 mm, bonded where their middles meet.
fn lap() -> Value {
    json!({
        "version": 1, "seed": 1, "pulp": pulp(),
        "specimen": {"explicit": {
            "length_mm": 1.0, "width_mm": 0.1,
            "fibres": [
                {"pulp": "softwood", "centre_line_um": [[0, 0, 0], [600, 0, 0]]},
                {"pulp": "softwood", "centre_line_um": [[400, 0, 0], [1000, 0, 0]]},
            ],
            "bonds": [{"fibres": [0, 1], "at_um": [500, 100], "area_um2": 400, "shear_strength_n": 0.004}],
        }},
        "bond": {"normal_strength_mpa": 100, "shear_strength_mpa": 1, "stiffness_n_per_m_per_um2": 250},
        "test": {"max_strain": 0.05},
    })
}

#[test]
fn a_lap_shears_though_its_arc_lengths_are_rounded() {
    // its points are half a micrometre apart along both fibres: no force opens it
    let mut spec = lap();
    let bond = &mut spec["specimen"]["explicit"]["bonds"][0];
    bond["at_um"][1] = json!(99.5);
    bond["normal_strength_n"] = json!(0.001);
    let (report, _) = go(&spec, 1);
    assert!((value(&report, "max_force") / 0.004 - 1.0).abs() < 1e-9);
    assert_eq!(value(&report, "broken_bonds_opened"), 0.0);
    // as far beyond the end as is let in: 1e-6 of 600 µm
    let bond = &mut spec["specimen"]["explicit"]["bonds"][0];
    bond["at_um"] = json!([600.0005, 200]);
    let (report, _) = go(&spec, 1);
    assert!((value(&report, "max_force") / 0.004 - 1.0).abs() < 1e-9);
}

#[test]
fn a_lap_of_two_fibres_is_three_springs_in_series_until_its_bond_shears() {
    let (report, record) = go(&lap(), 1);
    // 250 N/m/µm² × 400 µm² = 1e5 N/m = 100 mN/µm; each fibre 500 µm long
    let softness_um_per_mn = 500.0 / EA_MN + 1.0 / 100.0 + 500.0 / EA_MN;
    // its own 4 mN, not the 1 MPa × 400 µm² = 0.4 mN of all bonds
    let strain = 4.0 * softness_um_per_mn / 1000.0;
    let near = |name: &str, expected: f64| {
        let found = value(&report, name);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{name}: {found}, not {expected}"
        );
    };
    near("max_force", 0.004);
    near("tensile_strength", 0.004 / 0.1);
    near("stretch", strain);
    near(
        "tensile_stiffness",
        1e-3 * 1000.0 / softness_um_per_mn / 0.1,
    );
    // half of 4 mN over the elongation, in nJ, over 1 mm × 0.1 mm
    near(
        "energy_absorption",
        0.5 * 4.0 * 1000.0 * strain * 1e-9 / 1e-7,
    );
    // 1200 µm of 0.245 mg/m over 1e5 µm²
    let grammage = 1.2e-3 * 0.245e-3 / (1e-3 * 1e-4);
    near("grammage", grammage);
    near("tensile_index", 40.0 / grammage);
    near("breaking_length", 40.0 / grammage / 9.80665);
    near(
        "tensile_stiffness_index",
        1e-3 * 1000.0 / softness_um_per_mn / 0.1 / grammage,
    );
    near("broken_bonds", 1.0);
    near("broken_bonds_sheared", 1.0);
    assert_eq!(report.stop_reason, "parted");
    assert_eq!(codes(&report), Vec::<&str>::new());
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );

    // the curve: nothing, the largest force, and its fall at the same strain
    assert_eq!(record.points, record.table("curve.csv"));
    let strains: Vec<f64> = record.points.iter().map(|point| point[0]).collect();
    let forces: Vec<f64> = record.points.iter().map(|point| point[1]).collect();
    assert_eq!(strains.len(), 3);
    assert!((strains[1] / strain - 1.0).abs() < 1e-9 && strains[2] == strains[1]);
    assert!(forces[0] == 0.0 && (forces[1] / 0.004 - 1.0).abs() < 1e-9 && forces[2] == 0.0);
    let event = &record.table("events.csv")[0];
    assert_eq!(event[..2], [1.0, 1.0]);
    assert_eq!((event[3], event[6]), (0.0, 2.0));
    assert!((event[4] / 0.004 - 1.0).abs() < 1e-9);
    // all that was stored, in N mm
    let stored = 0.5 * 0.004 * strain;
    assert!((event[5] / stored - 1.0).abs() < 1e-9, "{}", event[5]);
    let pictures = [
        "snapshots/sheet_00001.vtp",
        "snapshots/sheet_00002.vtp",
        "snapshots.pvd",
    ];
    assert!(pictures.iter().all(|name| record.files.contains_key(*name)));
}

#[test]
fn a_bond_takes_strength_and_stiffness_by_its_area_and_says_what_was_assumed() {
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = Value::Null;
    body["bond"] = json!({"shear_strength_mpa": 5});
    let (report, _) = go(&body, 1);
    // 5 MPa × 400 µm² = 2 mN
    assert!((value(&report, "max_force") / 0.002 - 1.0).abs() < 1e-9);
    // two halves of a wall of π 2 × 26/28 µm and 3 GPa: 3/t GPa/µm, and 1 GPa/µm = 1000 N/m/µm²
    let thickness_um = std::f64::consts::PI * 2.0 * 26.0 / 28.0;
    let bond_mn_per_um = 3.0 / thickness_um * 400.0;
    let softness = 1000.0 / EA_MN + 1.0 / bond_mn_per_um;
    let expected = 1e-3 * 1000.0 / softness / 0.1;
    assert!((value(&report, "tensile_stiffness") / expected - 1.0).abs() < 1e-9);
    assert_eq!(codes(&report), ["assumed_bond_stiffness"]);
    let told = format!("{:.4}", 1000.0 * 3.0 / thickness_um);
    assert!(
        report.warnings[0].detail.contains(&told),
        "{}",
        report.warnings[0].detail
    );
}

#[test]
fn a_fibre_breaks_where_it_is_stressed_most_and_the_order_of_a_sheet_does_not_matter() {
    // side by side: one straight fibre that breaks at 1 %, and the lap, which holds on
    let mut body = lap();
    body["pulp"][0]["strength_mpa"] = json!(300);
    body["bond"]["shear_strength_mpa"] = json!(1000);
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = json!(0.5);
    let straight =
        json!({"pulp": "softwood", "centre_line_um": [[0, 50, 0], [300, 50, 0], [1000, 50, 0]]});
    body["specimen"]["explicit"]["fibres"]
        .as_array_mut()
        .unwrap()
        .push(straight.clone());
    let (report, record) = go(&body, 1);
    let softness = 1000.0 / EA_MN + 1.0 / 100.0;
    let forces = [EA_MN * 0.01, 10.0 / softness];
    assert!((value(&report, "max_force") / (1e-3 * (forces[0] + forces[1])) - 1.0).abs() < 1e-9);
    assert!((value(&report, "stretch") / 0.01 - 1.0).abs() < 1e-9);
    let event = &record.table("events.csv")[0];
    assert!(event[3].is_nan() && event[4].is_nan());
    assert_eq!((event[6], event[9]), (3.0, 2.0));
    assert!((event[11] / 300.0 - 1.0).abs() < 1e-9);
    assert!((event[12] / (1e-3 * forces[1]) - 1.0).abs() < 1e-9);
    assert_eq!(value(&report, "broken_fibres"), 2.0);

    // the same in another order, and the bond named from its other side
    let explicit = &mut body["specimen"]["explicit"];
    explicit["fibres"] = json!([straight, explicit["fibres"][1], explicit["fibres"][0]]);
    explicit["bonds"] =
        json!([{"fibres": [1, 2], "at_um": [100, 500], "area_um2": 400, "shear_strength_n": 0.5}]);
    let (turned, _) = go(&body, 1);
    for (name, quantity) in &report.summary {
        let (one, other) = (quantity.value.unwrap(), value(&turned, name));
        assert!(
            (one - other).abs() <= 1e-9 * one.abs(),
            "{name}: {one} and {other}"
        );
    }
}

#[test]
fn nothing_that_ties_the_jaws_is_a_force_of_zero_and_a_sentence() {
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"] = json!([]);
    let (report, record) = go(&body, 1);
    assert_eq!(report.stop_reason, "no_load_path");
    assert_eq!(codes(&report), ["no_load_path"]);
    assert_eq!(value(&report, "max_force"), 0.0);
    assert_eq!(value(&report, "tensile_index"), 0.0);
    assert_eq!(record.points.len(), 1);
    // a bond without strength is none
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = json!(0);
    body["bond"]["normal_strength_mpa"] = json!(0);
    let (report, _) = go(&body, 1);
    assert_eq!(report.stop_reason, "no_load_path");
    assert_eq!(value(&report, "void_bonds"), 1.0);
}

/// Both fibres are held at both ends and do not turn there. Where they cross they move alike, and turn
/// against one another, which the bond resists.
#[test]
fn two_crossed_fibres_are_two_built_in_beams_and_break_by_tension_and_bending() {
    let mut body = lap();
    body["pulp"][0]["strength_mpa"] = json!(600);
    body["specimen"]["explicit"]["fibres"] = json!([
        {"pulp": "softwood", "centre_line_um": [[0, 0, 0], [400, 300, 0]]},
        {"pulp": "softwood", "centre_line_um": [[0, 300, 0], [400, 0, 0]]},
    ]);
    body["specimen"]["explicit"]["length_mm"] = json!(0.4);
    body["specimen"]["explicit"]["bonds"] =
        json!([{"fibres": [0, 1], "at_um": [250, 250], "area_um2": 400}]);
    body["bond"] = json!({"stiffness_n_per_m_per_um2": 250});
    let (report, record) = go(&body, 1);
    let (length_um, cos, sin) = (500.0, 0.8, 0.6);
    let area = std::f64::consts::PI * 2.0 * 26.0;
    let inertia = std::f64::consts::PI / 64.0 * (28_f64.powi(4) - 24_f64.powi(4));
    // halves of a length h, of 12 E I/(κ G A h²) = Φ; the bond has s a²/12 against turning
    let half_um = 0.5 * length_um;
    let shear_mn = 2.6 / 4.9 * 2.5 * area;
    let phi = 12.0 * 30.0 * inertia / (shear_mn * half_um * half_um);
    let bending = 30.0 * inertia / (1.0 + phi);
    let bond_mn_um = 0.25 * 400.0 * 400.0 / 12.0;
    // per elongation of the jaws: half a beam moves by w across at its middle and turns there by t
    let w = 0.5 * sin;
    let turn = 6.0 * bending / half_um.powi(2) * w / ((4.0 + phi) * bending / half_um + bond_mn_um);
    let across = 12.0 * bending / half_um.powi(3) * w - 6.0 * bending / half_um.powi(2) * turn;
    let moment = 6.0 * bending / half_um.powi(2) * w - (2.0 - phi) * bending / half_um * turn;
    let tension = 30.0 * area / length_um * cos;
    let stiffness_mn_per_um = 2.0 * (tension * cos + across * sin);
    let expected = stiffness_mn_per_um * 400.0 * 1e-3 / 0.1;
    let found = value(&report, "tensile_stiffness");
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    let elongation = 0.6 / (tension / area + moment * 14.0 / inertia);
    let found = value(&report, "stretch") * 400.0;
    assert!(
        (found / elongation - 1.0).abs() < 1e-9,
        "{found} {elongation}"
    );
    assert!((record.table("events.csv")[0][11] / 600.0 - 1.0).abs() < 1e-9);
}

#[test]
fn bonds_that_do_not_break_leave_a_straight_line() {
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = Value::Null;
    body["bond"] = json!({"stiffness_n_per_m_per_um2": 250});
    let (report, record) = go(&body, 1);
    assert_eq!(codes(&report), ["nothing_broke"]);
    assert_eq!(report.stop_reason, "max_strain");
    assert_eq!(record.points.len(), 2);
    assert!((record.points[1][0] - 0.05).abs() < 1e-12);
}
