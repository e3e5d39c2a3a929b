//! Sheets of fibres that yield.
use serde_json::json;

use super::made::{goes_on, made};
use super::{codes, go, pulp, value};

/// π 2 (28 − 2) µm².
const AREA_UM2: f64 = std::f64::consts::PI * 2.0 * 26.0;

/// Two fibres that reach half of 1 mm each, bonded end to end: both yield before the bond shears.
#[test]
fn a_lap_whose_fibres_yield_tells_what_was_lost_and_what_stays() {
    let mut pulps = pulp();
    pulps[0]["yielding"] = json!({"stress_mpa": 60, "hardening_modulus_gpa": 2});
    let body = json!({
        "version": 1, "seed": 1, "pulp": pulps,
        "specimen": {"explicit": {
            "length_mm": 1.0, "width_mm": 0.1,
            "fibres": [
                {"pulp": "softwood", "centre_line_um": [[0, 0, 0], [500, 0, 0]]},
                {"pulp": "softwood", "centre_line_um": [[500, 0, 0], [1000, 0, 0]]},
            ],
            "bonds": [{"fibres": [0, 1], "at_um": [500, 0], "area_um2": 400, "shear_strength_n": 0.016}],
        }},
        "bond": {"normal_strength_mpa": 100, "shear_strength_mpa": 1, "stiffness_n_per_m_per_um2": 250},
        "test": {"max_strain": 0.2},
    });
    let (report, record) = go(&body, 1);
    let near = |name: &str, expected: f64| {
        let found = value(&report, name);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{name}: {found}, not {expected}"
        );
    };
    // GPa, µm, mN: 250 N/m/µm² × 400 µm² = 100 mN/µm
    let carried = 16.0 / AREA_UM2;
    let strain = 0.06 / 30.0 + (carried - 0.06) / 2.0;
    let stretch = strain + 16.0 / 100.0 / 1000.0;
    near("max_force", 0.016);
    near("stretch", stretch);
    near("yielded_share", 1.0);
    near("residual_strain", strain - carried / 30.0);
    // nJ over 1 mm × 0.1 mm
    let lost = 0.5 * (0.06 + carried) * (strain - carried / 30.0) * 1000.0 * AREA_UM2;
    near("plastic_work", lost * 1e-9 / 1e-7);
    let elastic = 0.5 * 16.0 * (1000.0 * carried / 30.0 + 16.0 / 100.0);
    near("energy_absorption", (lost + elastic) * 1e-9 / 1e-7);
    assert_eq!(report.stop_reason, "parted");
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );
    assert!(value(&report, "max_force") > 0.0 && codes(&report).is_empty());
    // points on both lines, the last before the fall
    let before = &record.points[record.points.len() - 2];
    assert!((before[0] / stretch - 1.0).abs() < 1e-9);
    let lines = |strain: f64| {
        let elastic = 1.0 / (1000.0 / (30.0 * AREA_UM2) + 0.01);
        let flowing = 1.0 / (1000.0 / (2.0 * AREA_UM2) + 0.01);
        let yields_at = 0.06 * AREA_UM2;
        let kink = yields_at / elastic;
        let at = 1000.0 * strain;
        (elastic * at).min(yields_at + flowing * (at - kink))
    };
    for point in &record.points[..record.points.len() - 1] {
        let expected = 1e-3 * lines(point[0]);
        assert!((point[1] - expected).abs() < 1e-11, "{point:?} {expected}");
    }
}

fn yielding() -> serde_json::Value {
    let mut body = made();
    body["specimen"]["sheet"]["length_mm"] = json!(0.3);
    body["specimen"]["sheet"]["width_mm"] = json!(0.15);
    body["pulp"][0]["yielding"] = json!({"stress_mpa": 40, "hardening_modulus_gpa": 3});
    body["bond"]["stiffness_n_per_m_per_um2"] = json!(250);
    body["test"] = json!({"max_strain": 0.2});
    body
}

#[test]
fn yielding_adds_stretch_and_energy_and_the_sum_of_energies_holds() {
    let mut elastic = yielding();
    elastic["pulp"][0]
        .as_object_mut()
        .unwrap()
        .remove("yielding");
    let (elastic, _) = go(&elastic, 1);
    let (report, record) = go(&yielding(), 1);
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );
    assert!(report.quality["energy_balance_error"].value < 1e-9);
    for name in ["stretch", "energy_absorption"] {
        let [with, without] = [&report, &elastic].map(|report| value(report, name));
        assert!(with > 1.2 * without, "{name}: {with} {without}");
    }
    let stiffness = [&report, &elastic].map(|report| value(report, "tensile_stiffness"));
    assert!((stiffness[0] / stiffness[1] - 1.0).abs() < 1e-9);
    let [lost, all] = ["plastic_work", "energy_absorption"].map(|name| value(&report, name));
    assert!(lost > 0.1 * all && lost < all, "{lost} of {all}");
    let [stays, stretch] = ["residual_strain", "stretch"].map(|name| value(&report, name));
    assert!(stays > 0.0 && stays < stretch);
    let share = value(&report, "yielded_share");
    assert!(share > 0.1 && share < 1.0, "{share}");
    // the area under the curve up to its largest force, whose points miss some kinks
    let peak = value(&report, "max_force");
    let end = record
        .points
        .iter()
        .position(|point| point[1] == peak)
        .unwrap();
    let mut area = 0.0;
    for pair in record.points[..=end].windows(2) {
        area += 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]);
    }
    // N over 0.15 mm of width; chords lie below a curve that bends down
    let share = 1e3 * area / 0.15 / all;
    assert!(share > 0.99 && share < 1.0 + 1e-9, "{share}");
}

#[test]
fn fibres_that_yield_write_the_same_bytes_however_they_are_run() {
    // one thread, and two that go on from one
    goes_on(&yielding(), &[9]);
}
