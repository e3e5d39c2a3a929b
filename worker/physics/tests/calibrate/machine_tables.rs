//! Tables of testing machines, found by the names and units of their columns, give the moduli that they
//! were measured on.
use loadframe_api::Report;
use loadframe_physics::Uninterrupted;
use serde_json::{Value, json};

use crate::scene::{Record, finished, run_job, value};
use crate::{calibrate, parsed};

/// Two bonds in a row, each of modulus e and friction modulus f: F = e u + f u^2 at any strain.
fn pair() -> Value {
    json!({
        "kind": "nonwoven_tensile",
        "spec": {
            "version": 1,
            "fabric": {"network": {
                "nodes_mm": [[0, 0, 0], [0, 10, 0], [0, 20, 0]],
                "jaws": ["bottom", "free", "top"],
                "bonds": [{"nodes": [0, 1]}, {"nodes": [1, 2]}],
                "width_mm": 10,
            }},
            "bond": {"modulus_n": 1.0, "friction_modulus_n": 1.0},
            "test": {"strain_step": 0.01, "max_strain": 0.5, "breaking": "none"},
            "accuracy": "reference",
        }
    })
}

/// Fits the pair to a table.
fn fit_pair(curve: &Value) -> (Report, Record) {
    let free = |parameter| json!({"parameter": parameter, "min": 0.001, "max": 10000.0});
    let job = json!({
        "kind": "calibrate",
        "spec": {
            "version": 1,
            "job": pair(),
            "free": [free("/bond/modulus_n"), free("/bond/friction_modulus_n")],
            "measured": {"curve": curve},
            "realisations": 1,
            "max_trials": 60,
            "tolerance": 1e-6,
        }
    });
    calibrate(&job, 1)
}

/// What a machine measures on bonds of 2 N and 3 N, as a table with a row for each point.
fn machine_table(names: &str, row: impl Fn(f64, f64) -> String) -> String {
    let points = (0..26).map(|index| 0.02 * f64::from(index));
    let rows = points.map(|u| row(u, 2.0 * u + 3.0 * u * u));
    format!("{names}\n{}\n", rows.collect::<Vec<_>>().join("\n"))
}

#[test]
fn tables_of_machines_give_the_moduli_that_they_were_measured_on() {
    let third = machine_table(
        "Tensile strain (mm/mm),Extension (mm),Load (N)",
        |u, force| format!("{u:.4},{:.4},{force:.6}", 20.0 * u),
    );
    let milli = machine_table("Strain,Load (mN)", |u, force| {
        format!("{u:.4},{:.6}", 1e3 * force)
    });
    let thousands = machine_table("Strain\tLoad (µN)", |u, force| {
        let whole = (1e6 * force).round() as u64;
        let [millions, thousands, ones] = [whole / 1_000_000, whole / 1000 % 1000, whole % 1000];
        match (millions, thousands) {
            (0, 0) => format!("{u:.4}\t{ones}"),
            (0, _) => format!("{u:.4}\t{thousands},{ones:03}"),
            _ => format!("{u:.4}\t{millions},{thousands:03},{ones:03}"),
        }
    });
    let exported = machine_table(
        "sep=;\nPr\u{fc}fer;X\n\"Standardweg\";\"Standardkraft\"\nmm;cN",
        |u, force| format!("{:.4};{:.4}", 20.0 * u, 100.0 * force).replace('.', ","),
    );
    for curve in [
        json!({"csv": third}),
        json!({"csv": milli}),
        json!({"csv": thousands}),
        json!({"csv": exported, "reading": {"gauge_length_mm": 20}}),
    ] {
        let (report, _) = fit_pair(&curve);
        // the numbers have four to six digits
        let near = |name, right: f64| (value(&report, name) / right - 1.0).abs() < 1e-3;
        assert!(near("bond_modulus_n", 2.0), "{curve}: {:?}", report.summary);
        assert!(
            near("bond_friction_modulus_n", 3.0),
            "{curve}: {:?}",
            report.summary
        );
        assert_eq!(value(&report, "measured_points"), 26.0);
        let said = &report.summary["measured_points"].description;
        assert!(
            said.contains("as force_n") && said.contains("as nominal_strain"),
            "{said}"
        );
    }
}

#[test]
fn the_machine_curve_of_a_job_is_read_by_a_calibration() {
    let mut made = pair();
    made["spec"]["bond"] = json!({"modulus_n": 2.0, "friction_modulus_n": 3.0});
    let mut record = Record::default();
    let ending = run_job(&parsed(&made), &mut record, &Uninterrupted, None, 1);
    finished(ending.expect("it runs"));
    let text = String::from_utf8(record.files["curve_machine.csv"].clone()).expect("text");
    let (report, _) = fit_pair(&json!({"csv": text}));
    // the same test
    assert!(
        (value(&report, "bond_modulus_n") - 2.0).abs() < 1e-5,
        "{:?}",
        report.summary
    );
    assert!((value(&report, "bond_friction_modulus_n") - 3.0).abs() < 1e-5);
}
