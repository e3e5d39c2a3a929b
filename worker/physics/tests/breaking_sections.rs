//! Sections that break and unit cells as jobs: against closed forms, and their promises.
mod scene;

use loadframe_api::{JobSpec, Report, Submission, SubmissionError};
use loadframe_physics::{Ending, Interrupt, Uninterrupted};
use scene::{AtLook, Record, assert_same, run_job};
use serde_json::{Value, json};

fn job(kind: &str, spec: &Value) -> JobSpec {
    let body = json!({"kind": kind, "spec": spec});
    match Submission::from_slice(body.to_string().as_bytes()) {
        Ok(submission) => submission.spec,
        Err(SubmissionError::Invalid(violations)) => panic!("{violations:#?}"),
        Err(error) => panic!("{error}"),
    }
}

fn run_on(kind: &str, spec: &Value, threads: usize) -> (Report, Record) {
    let mut record = Record::default();
    match run_job(&job(kind, spec), &mut record, &Uninterrupted, None, threads) {
        Ok(Ending::Finished(report)) => (report, record),
        other => panic!("{other:?}"),
    }
}

fn value(report: &Report, name: &str) -> f64 {
    let quantity = &report.summary[name];
    quantity
        .value
        .unwrap_or_else(|| panic!("{name} is not known"))
}

/// A bar of two materials in a row of three pieces, the middle one weaker, pulled along x.
fn bar(cells: u32, breaking: Value) -> Value {
    let resin = |strength: f64| {
        json!({"isotropic": {"youngs_modulus_mpa": 3000, "poisson_ratio": 0.0},
               "strength": {"tension": {"strength_mpa": strength, "fracture_energy_n_per_mm": 3}}})
    };
    json!({
        "version": 1,
        "section": {"length_mm": 9, "height_mm": 1, "thickness_mm": 2, "state": "plane_stress"},
        "materials": {"resin": resin(60.0), "weak": resin(50.0)},
        "matrix": "resin",
        "fibres": [{"material": "weak", "through_mm": [4.5, 0.5], "angle_deg": 90,
                    "thickness_mm": 9.0 / f64::from(cells)}],
        "grid": {"cells": [cells, 2], "equal_cells": true},
        "test": {"tension": {"strain": 0.001}, "breaking": breaking},
    })
}

#[test]
fn a_bar_bears_the_strength_of_its_weakest_piece_and_takes_its_fracture_energy_on_any_grid() {
    for cells in [9, 27, 81] {
        let spec = bar(cells, json!({"teeth": 40, "stop_force_fraction": 0.01}));
        let (report, record) = run_on("composite_bending", &spec, 1);
        // 50 MPa on 2 mm²
        let strength = value(&report, "tensile_strength");
        assert!((strength / 50.0 - 1.0).abs() < 1e-6, "{cells}: {strength}");
        // 3 N/mm on 2 mm² is 6 mJ
        let energy = value(&report, "dissipated_energy") / 6e-3;
        assert!((energy - 1.0).abs() < 0.06, "{cells}: {energy}");
        let area = value(&report, "crack_area");
        assert!((area / 2.0 - 1.0).abs() < 1e-6, "{cells}: {area}");
        assert_eq!(report.stop_reason, "force_dropped");
        let rows = String::from_utf8_lossy(&record.files["cracks.csv"])
            .lines()
            .count()
            - 1;
        assert!((rows as f64 - value(&report, "cracks")).abs() < 0.5);
        for name in [
            "snapshots/peak.vtp",
            "snapshots/end.vtp",
            "snapshots/cracks.vtp",
        ] {
            assert!(record.files.contains_key(name), "{name}");
        }
    }
}

#[test]
fn of_one_material_strains_break_where_stresses_do() {
    let strength = |criterion: &str| {
        let spec = bar(
            9,
            json!({"criterion": criterion, "stop_force_fraction": 0.5}),
        );
        value(&run_on("composite_bending", &spec, 1).0, "tensile_strength")
    };
    let [by_stress, by_strain] = ["stress", "strain"].map(strength);
    assert!(
        (by_strain / by_stress - 1.0).abs() < 1e-9,
        "{by_stress} {by_strain}"
    );
}

#[test]
fn a_machine_of_growing_displacement_jumps_where_the_path_snaps_back() {
    let ways = |control: &str| {
        let spec = bar(9, json!({"control": control, "stop_force_fraction": 0.05}));
        let (_, record) = run_on("composite_bending", &spec, 1);
        let curve = record.table("curve.csv");
        curve.iter().map(|row| row[0]).collect::<Vec<f64>>()
    };
    let falls = |ways: &[f64]| ways.windows(2).any(|pair| pair[1] < pair[0] * (1.0 - 1e-9));
    // a bar of 9 mm stores 9/1 times what one of a cell does: it snaps back
    assert!(falls(&ways("path")));
    assert!(!falls(&ways("displacement")));
}

#[test]
fn a_broken_section_is_the_same_on_two_threads_and_after_a_resume() {
    let spec = bar(
        27,
        json!({"scatter": {"weibull_modulus": 10}, "stop_force_fraction": 0.05}),
    );
    let expected = run_on("composite_bending", &spec, 1);
    assert_same(&expected, &run_on("composite_bending", &spec, 2));
    let job = job("composite_bending", &spec);
    let mut record = Record::default();
    let mut checkpoint: Option<Vec<u8>> = None;
    let mut pieces = 1;
    let report = loop {
        let interrupt = AtLook::new(Interrupt::Suspend, 1 + pieces);
        match run_job(&job, &mut record, &interrupt, checkpoint.as_deref(), 1) {
            Ok(Ending::Finished(report)) => break report,
            Ok(Ending::Suspended) => checkpoint = record.checkpoint.clone(),
            other => panic!("{other:?}"),
        }
        pieces += 1;
    };
    assert!(pieces > 1, "{pieces}");
    assert_same(&expected, &(report, record));
}

#[test]
fn fibres_come_off_before_they_break_where_their_faces_are_weak() {
    let spec = json!({
        "version": 1,
        "section": {"length_mm": 6, "height_mm": 3, "thickness_mm": 1, "state": "plane_stress"},
        "materials": {
            "resin": {"isotropic": {"youngs_modulus_mpa": 3000, "poisson_ratio": 0.3},
                      "strength": {"tension": {"strength_mpa": 60, "fracture_energy_n_per_mm": 0.3}}},
            "glass": {"isotropic": {"youngs_modulus_mpa": 70_000, "poisson_ratio": 0.2},
                      "strength": {"tension": {"strength_mpa": 2000, "fracture_energy_n_per_mm": 20}},
                      "interface": {"normal": {"strength_mpa": 10, "fracture_energy_n_per_mm": 0.05},
                                    "shear": {"strength_mpa": 10, "fracture_energy_n_per_mm": 0.05}}},
        },
        "matrix": "resin",
        "fibres": [{"material": "glass", "through_mm": [3, 1.5], "angle_deg": 0, "thickness_mm": 0.5}],
        "grid": {"cells": [12, 12]},
        "test": {"supports": {"bottom": "clamped", "top": {"displacement_mm": [null, 0.01]}},
                 "breaking": {"stop_force_fraction": 0.3}},
    });
    let (report, _) = run_on("composite_bending", &spec, 1);
    assert!(value(&report, "dissipated_at_interfaces") > 0.0);
    assert!(value(&report, "dissipated_in_fibres").abs() < 1e-12);
}

fn cell(arrangement: Value, repeats: u32) -> Value {
    json!({
        "version": 1, "seed": 3,
        "materials": {
            "epoxy": {"isotropic": {"youngs_modulus_mpa": 3350, "poisson_ratio": 0.35},
                      "strength": {"tension": {"strength_mpa": 80}}},
            "glass": {"isotropic": {"youngs_modulus_mpa": 74_000, "poisson_ratio": 0.2},
                      "strength": {"tension": {"strength_mpa": 2150}}},
        },
        "matrix": "epoxy", "fibre": "glass", "arrangement": arrangement, "repeats": repeats,
        "accuracy": {"cells_per_fibre": 12},
    })
}

#[test]
fn random_cells_scatter_and_their_joint_result_says_by_how_much() {
    let random = json!({"random": {"fibre_fraction": 0.5, "fibres": 6, "diameter_mm": 0.012}});
    let spec = cell(random, 3);
    let expected = run_on("composite_cell", &spec, 1);
    assert_same(&expected, &run_on("composite_cell", &spec, 2));
    let (report, record) = expected;
    let across = &report.summary["modulus_2"];
    let rows = record.table("repeats.csv");
    let header = String::from_utf8_lossy(&record.files["repeats.csv"]).into_owned();
    let column = header
        .lines()
        .next()
        .and_then(|names| names.split(',').position(|name| name == "modulus_2_mpa"));
    let values: Vec<f64> = rows
        .iter()
        .map(|row| row[column.expect("a column")])
        .collect();
    let mean = values.iter().sum::<f64>() / 3.0;
    assert!((across.value.expect("a mean") / mean - 1.0).abs() < 1e-12);
    assert_eq!(across.n, Some(3));
    let error = across.error.as_ref().expect("an error");
    let sources: Vec<&str> = error
        .parts
        .iter()
        .map(|part| part.source.as_str())
        .collect();
    assert_eq!(sources, ["grid", "specimens"]);
    // the rule of mixtures along the fibres, but for what Poisson ratios that differ add
    let along = value(&report, "modulus_1");
    assert!(
        (along / (0.5 * (3350.0 + 74_000.0)) - 1.0).abs() < 2e-3,
        "{along}"
    );
    // all strains alike, the matrix would be the first at 80 MPa; it contracts more than the fibres, which
    // hold it, and so bears somewhat more than the stress of its strain alone
    let strength = value(&report, "strength_along_tension");
    let by_matrix = 80.0 / 3350.0 * along;
    assert!(
        strength < by_matrix && strength > 0.85 * by_matrix,
        "{strength} {by_matrix}"
    );
    for name in [
        "material.json",
        "companions.csv",
        "fibres.csv",
        "stiffness.csv",
        "snapshots/cell.vtp",
    ] {
        assert!(record.files.contains_key(name), "{name}");
    }
}

#[test]
fn a_regular_array_lies_within_the_bounds_of_theory() {
    let hexagonal = json!({"hexagonal": {"fibre_fraction": 0.6, "diameter_mm": 0.012}});
    let mut spec = cell(hexagonal, 1);
    spec["accuracy"] = json!("reference");
    let (report, record) = run_on("composite_cell", &spec, 1);
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );
    let text = String::from_utf8_lossy(&record.files["companions.csv"]).into_owned();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let place = |name: &str| names.iter().position(|known| *known == name).expect(name);
    for line in lines.filter(|line| line.contains("modulus")) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |name: &str| cells[place(name)].parse::<f64>().expect(line);
        let (least, own, most) = (number("reuss"), number("cell"), number("voigt"));
        assert!(least < own && own < most, "{line}");
        // one per cent for the grid
        let (lower, upper) = (
            number("hashin_shtrikman_lower"),
            number("hashin_shtrikman_upper"),
        );
        assert!(own > 0.99 * lower && own < 1.01 * upper, "{line}");
    }
}
