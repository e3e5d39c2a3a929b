//! Sheets of tubes through the whole job, beside beams and bars.
use loadframe_api::{Calibration, Spec as _};
use serde_json::{Value, json};

use super::made::{goes_on, made};
use super::{codes, go, pulp, value};

/// The same at another level.
fn at(level: &str, body: &Value) -> Value {
    let mut body = body.clone();
    body["model"] = json!({"level": level});
    body
}

#[test]
fn two_crossed_tubes_are_two_built_in_beams_of_their_own_bending_stiffness() {
    let mut body = json!({
        "version": 1, "pulp": pulp(), "model": {"level": "tube"},
        "specimen": {"explicit": {
            "length_mm": 0.8, "width_mm": 0.6,
            "fibres": [
                {"pulp": "softwood", "centre_line_um": [[0, 0, 0], [800, 600, 0]]},
                {"pulp": "softwood", "centre_line_um": [[0, 600, 0], [800, 0, 0]]},
            ],
            "bonds": [{"fibres": [0, 1], "at_um": [500, 500], "area_um2": 784}],
        }},
        "bond": {"stiffness_n_per_m_per_um2": 250},
        "test": {"max_strain": 0.1},
    });
    body["pulp"][0]["strength_mpa"] = json!(600);
    let (report, record) = go(&body, 1);
    // the closed form of the test of beams, twice as long, with the tube's E I in place of the wall's
    let (cos, sin, half_um) = (0.8, 0.6, 500.0_f64);
    let area = std::f64::consts::PI * 2.0 * 26.0;
    // 1 N m² is 10¹⁵ mN µm²
    let flexural = 1e15 * value(&report, "bending_stiffness");
    let shear_mn = 2.6 / 4.9 * 2.5 * area;
    let phi = 12.0 * flexural / (shear_mn * half_um * half_um);
    let bending = flexural / (1.0 + phi);
    let bond_mn_um = 0.25 * 784.0 * 784.0 / 12.0;
    let w = 0.5 * sin;
    let turn = 6.0 * bending / half_um.powi(2) * w / ((4.0 + phi) * bending / half_um + bond_mn_um);
    let across = 12.0 * bending / half_um.powi(3) * w - 6.0 * bending / half_um.powi(2) * turn;
    let tension = 30.0 * area / (2.0 * half_um) * cos;
    let expected = 2.0 * (tension * cos + across * sin) * 800.0 * 1e-3 / 0.6;
    let found = value(&report, "tensile_stiffness");
    // glued ends of the tubes, which do not contract
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    let stress = record.table("events.csv")[0][11];
    assert!((stress / 600.0 - 1.0).abs() < 1e-9, "{stress}");
    assert_eq!(value(&report, "broken_fibres"), 2.0);
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );
}

#[test]
fn a_sheet_of_tubes_breaks_beside_the_same_sheet_of_beams() {
    let body = made();
    let (tubes, record) = go(&at("tube", &body), 1);
    let (beams, _) = go(&at("beam", &body), 1);
    for same in ["grammage", "fibres", "bonds", "cox_stiffness_index"] {
        assert_eq!(value(&tubes, same), value(&beams, same), "{same}");
    }
    // tubes are as much too stiff as they say, beams have nothing of it
    let [told, beside] = [&tubes, &beams].map(|report| {
        let error = report.summary["tensile_stiffness"].error.as_ref();
        let mut parts = error.into_iter().flat_map(|error| &error.parts);
        let part = parts.find(|part| part.source == "bonds_between_rings");
        part.map(|part| part.value)
    });
    let apart = value(&tubes, "tensile_stiffness") - value(&beams, "tensile_stiffness");
    let told = told.unwrap();
    assert!(
        apart > 0.0 && apart < 3.0 * told && told < 3.0 * apart,
        "{apart} {told}"
    );
    assert_eq!(beside, None);
    // E A and G J are those of the beam, E I is less; nothing else differs but where bonds hold
    let share = value(&tubes, "bending_stiffness") / value(&tubes, "bending_stiffness_of_wall");
    assert!((0.7..1.0).contains(&share), "{share}");
    for (result, least, most) in [("tensile_stiffness", 0.8, 1.1), ("tensile_index", 0.7, 1.3)] {
        let ratio = value(&tubes, result) / value(&beams, result);
        assert!((least..most).contains(&ratio), "{result}: {ratio}");
    }
    assert!(value(&tubes, "broken_bonds") > 10.0);
    assert!(
        tubes.quality.values().all(|check| check.ok),
        "{:?}",
        tubes.quality
    );
    assert!(["force_dropped", "parted"].contains(&tubes.stop_reason.as_str()));
    // the same columns, and pictures of the walls
    let picture = String::from_utf8_lossy(&record.files["snapshots/sheet_00002.vtp"]);
    assert!(picture.contains("is_bond") && record.files.contains_key("events.csv"));
}

#[test]
fn two_threads_write_the_same_bytes_as_one_and_a_suspended_test_goes_on() {
    let mut body = at("tube", &made());
    body["specimen"]["sheet"]["length_mm"] = json!(0.2);
    assert_eq!(go(&body, 1), go(&body, 2));
    goes_on(&body, &[0, 7]);
}

#[test]
fn tubes_are_pulled_along_and_across_with_every_seed() {
    let mut body = at("tube", &made());
    body["specimen"]["sheet"]["length_mm"] = json!(0.2);
    body["test"] = json!({"direction": "both", "repeats": 2, "max_strain": 0.01});
    let (report, record) = go(&body, 2);
    for name in [
        "tensile_index",
        "tensile_index_along_cd",
        "anisotropy_of_tensile_index",
    ] {
        assert!(value(&report, name).is_finite(), "{name}");
    }
    assert!(record.files.contains_key("along_cd/curve.csv"));
}

#[test]
fn pieces_that_are_too_short_for_the_window_are_told() {
    let mut body = at("tube", &made());
    body["specimen"]["sheet"]["length_mm"] = json!(0.2);
    let (report, _) = go(&body, 1);
    assert!(
        codes(&report).contains(&"robust_springs"),
        "{:?}",
        codes(&report)
    );
    body["model"]["segment_um"] = json!(100);
    let (report, _) = go(&body, 1);
    assert!(
        codes(&report).contains(&"refined_segment"),
        "{:?}",
        codes(&report)
    );
    body["model"]["on_inadmissible"] = json!("robust");
    let (report, _) = go(&body, 1);
    assert!(
        !codes(&report).contains(&"refined_segment"),
        "{:?}",
        codes(&report)
    );
    assert!(value(&report, "shear_modulus") < value(&report, "shear_modulus_given"));
}

#[test]
fn extremes_of_tubes_have_a_result_that_balances() {
    let mut small = at("tube", &made());
    small["specimen"]["sheet"]["length_mm"] = json!(0.2);
    small["specimen"]["sheet"]["width_mm"] = json!(0.1);
    let set = |pointer: &str, value: Value| {
        let mut body = small.clone();
        *body.pointer_mut(pointer).unwrap() = value;
        body
    };
    for (name, body) in [
        ("5 g/m2", set("/specimen/sheet/grammage_g_per_m2", json!(5))),
        ("curls", set("/pulp/0/shape_factor", json!(0.5))),
        ("no lumen", set("/pulp/0/wall_um", json!(14))),
        (
            "soft in shear",
            set("/pulp/0/shear_modulus_gpa", json!(0.3)),
        ),
        (
            "stiff in shear",
            set("/pulp/0/shear_modulus_gpa", json!(15)),
        ),
        (
            "no bonds",
            set(
                "/bond",
                json!({"normal_strength_mpa": 0, "shear_strength_mpa": 0}),
            ),
        ),
        ("bonds that hold", set("/bond", json!({}))),
        (
            "fibres that break first",
            set("/pulp/0/strength_mpa", json!(20)),
        ),
        (
            "rings of four",
            set("/model", json!({"level": "tube", "points_on_ring": 4})),
        ),
        (
            "rings of twelve",
            set("/model", json!({"level": "tube", "points_on_ring": 12})),
        ),
        (
            "the patent's ring",
            set("/model", json!({"level": "tube", "ring": "patent"})),
        ),
        (
            "at random",
            set(
                "/specimen/sheet",
                json!({"length_mm": 0.2, "width_mm": 0.1, "grammage_g_per_m2": 20,
                "placement": {"random": {"thickness_um": 30}}}),
            ),
        ),
    ] {
        let (report, _) = go(&body, 1);
        let held = report.quality.values().all(|check| check.ok);
        assert!(held, "{name}: {:?}", report.quality);
        for result in ["max_force", "tensile_index", "stretch", "energy_absorption"] {
            let found = value(&report, result);
            assert!(
                found.is_finite() && found >= 0.0,
                "{name}: {result} {found}"
            );
        }
    }
}

/// Small sheets on all levels, beside one another: `cargo test -p loadframe-paper --lib levels_beside -- --ignored --nocapture`.
#[test]
#[ignore = "measures: minutes"]
#[allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "this prints a table of times"
)]
fn levels_beside_one_another() {
    let mut short = made();
    short["pulp"][0]["length_mm"] = json!(0.5);
    short["bond"]["stiffness_n_per_m_per_um2"] = json!(250);
    short["specimen"]["sheet"] =
        json!({"length_mm": 0.3, "width_mm": 0.2, "grammage_g_per_m2": 20});
    short["test"] = json!({"max_strain": 0.1});
    let mut flat = short.clone();
    flat["pulp"][0]["length_mm"] = json!(5);
    flat["pulp"][0]["length_variation"] = json!(0);
    flat["pulp"][0]["shape_factor"] = json!(1);
    flat["specimen"]["sheet"]["orientation"] = json!({"von_mises": {"concentration": 4}});
    flat["specimen"]["sheet"]["placement"] = json!({"random": {"thickness_um": 40}});
    let mut larger = short.clone();
    larger["specimen"]["sheet"] =
        json!({"length_mm": 0.6, "width_mm": 0.4, "grammage_g_per_m2": 20});
    larger["test"] = json!({"max_strain": 1e-6});
    let columns = [
        "tensile_stiffness_index",
        "tensile_index",
        "stretch",
        "energy_absorption_index",
    ];
    println!(
        "sheet seed level fibres bonds {} seconds estimated work",
        columns.join(" ")
    );
    for (name, body, seeds) in [
        ("short", short, 3),
        ("flat", flat, 3),
        ("larger", larger, 1),
    ] {
        for seed in 1..=seeds {
            for level in ["beam", "tube", "truss"] {
                let mut body = at(level, &body);
                body["seed"] = json!(seed);
                let start = std::time::Instant::now();
                let (report, _) = go(&body, 1);
                let seconds = start.elapsed().as_secs_f64();
                let results: Vec<String> = ["fibres", "bonds"]
                    .iter()
                    .chain(&columns)
                    .map(|name| format!("{:.4e}", value(&report, name)))
                    .collect();
                let estimate = super::spec(&body).estimate(&Calibration::default());
                println!(
                    "{name} {seed} {level} {} {seconds:.2} s {:.2} s {:.0} MB {:?} {:?}",
                    results.join(" "),
                    estimate.wall_s,
                    estimate.memory_mb,
                    report.work,
                    codes(&report)
                );
            }
        }
    }
}
