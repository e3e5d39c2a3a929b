//! Several beds of one spec.
#![allow(clippy::float_cmp, reason = "copied numbers are exact")]
use loadframe_api::{ErrorBasis, Report};
use serde_json::{Value, json};

use super::{Record, assert_same, run, submission, try_run, value};

const BEDS: u32 = 3;

/// A box of some fifty spheres, under a sleeper of flat faces.
fn small_box() -> Value {
    json!({"kind": "ballast_box", "spec": {
        "version": 1, "seed": 7,
        "grains": {"sizes": {"uniform": {"smallest_radius_m": 0.025, "largest_radius_m": 0.035}}},
        "materials": {"aggregate": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
            "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "apparatus": {"length_m": 0.4, "width_m": 0.2, "height_m": 0.25, "height_below_m": 0.2,
            "sleeper": {"length_m": 0.2, "width_m": 0.2, "height_m": 0.1, "mass_kg": 10}},
        "test": {"smallest_force_n": 50, "peak_force_n": 500},
        "preparation": {"compaction": null, "longest_settling_s": 0.5},
        "accuracy": {"critical_step_fraction": 0.4, "inertial_number": 1e-2},
        "output": {"rows_per_cycle": 50, "snapshots": 1}
    }})
}

fn repeated() -> Value {
    let mut job = small_box();
    job["spec"]["repeats"] = json!(BEDS);
    job
}

fn alone(bed: u32) -> (Report, Record) {
    let mut job = small_box();
    job["spec"]["seed"] = json!(7 + bed);
    run(&job)
}

#[test]
fn results_of_several_beds_are_means_whose_scatter_is_their_error() {
    let (report, record) = run(&repeated());
    let singles: Vec<(Report, Record)> = (0..BEDS).map(alone).collect();
    let ways: Vec<f64> = singles
        .iter()
        .map(|(report, _)| value(report, "peak_displacement"))
        .collect();
    let mean = ways.iter().sum::<f64>() / 3.0;
    let squares: f64 = ways.iter().map(|way| (way - mean).powi(2)).sum();
    let deviation = (squares / 2.0).sqrt();
    assert!(deviation > 1e-3 * mean, "beds differ");
    let found = &report.summary["peak_displacement"];
    assert!((found.value.expect("a mean") - mean).abs() < 1e-12 * mean);
    assert_eq!(found.n, Some(BEDS));
    let error = found
        .error
        .as_ref()
        .expect("of a box test from its repeats");
    let [part] = error.parts.as_slice() else {
        panic!("one part: {error:?}");
    };
    assert_eq!(
        (part.source.as_str(), part.basis),
        ("specimens", ErrorBasis::Repeats)
    );
    assert!((part.value - deviation / 3.0_f64.sqrt()).abs() < 1e-9 * deviation);

    // curve, tables and pictures are those of the first
    let (_, first) = &singles[0];
    assert_eq!(record.points, first.points);
    for (name, bytes) in &first.files {
        assert!(*bytes == record.files[name], "{name} differs");
    }
    let rows = record.table("repeats.csv");
    let seeds: Vec<f64> = rows.iter().map(|row| row[1]).collect();
    assert_eq!(seeds, [7.0, 8.0, 9.0]);
    let curves = record.table("repeats_curves.csv");
    for (bed, (_, single)) in (1..).zip(&singles) {
        let own = curves.iter().filter(|row| row[0] == f64::from(bed));
        let own: Vec<f64> = own.map(|row| row[3]).collect();
        assert_eq!(own, single.column("displacement_mm"));
    }
}

#[test]
fn the_number_of_threads_changes_no_bit_of_several_beds() {
    let [one, two] = [1, 2].map(|threads| try_run(&repeated(), threads).expect("a test"));
    assert_same(&one, &two);
}

/// What the table of oedometers says of another bed gives way to what the beds of the job say.
#[test]
fn of_several_oedometers_the_error_is_that_of_their_scatter_and_of_the_preset() {
    let body = |beds: u32| {
        json!({"kind": "ballast_oedometer", "spec": {
            "version": 1, "repeats": beds,
            "grains": {"sizes": {"uniform": {"smallest_radius_m": 0.016, "largest_radius_m": 0.031}}},
            "materials": {"aggregate": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 7e7,
                "stiffness_ratio": 0.38, "friction_angle_rad": 0.54}},
            "preparation": {"longest_settling_s": 6},
            "test": {"smallest_force_n": 100, "peak_force_n": 6100},
            "accuracy": "draft"}})
    };
    let parts = |report: &Report| -> Vec<(String, ErrorBasis)> {
        let error = report.summary["unloading_stiffness"].error.as_ref();
        let parts = error.expect("it is in the table").parts.iter();
        let mut parts: Vec<_> = parts
            .map(|part| (part.source.clone(), part.basis))
            .collect();
        parts.sort_by(|a, b| a.0.cmp(&b.0));
        parts
    };
    let [one, several] = [1, 2].map(|beds| parts(&run(&body(beds)).0));
    let of_preset = |parts: &[(String, ErrorBasis)]| parts.iter().any(|part| part.0 == "preset");
    assert_eq!(of_preset(&one), of_preset(&several));
    let of_beds = |parts: &[(String, ErrorBasis)]| -> Vec<ErrorBasis> {
        let of_beds = parts.iter().filter(|part| part.0 == "specimens");
        of_beds.map(|part| part.1).collect()
    };
    assert_eq!(of_beds(&one), [ErrorBasis::MeasuredTable]);
    assert_eq!(of_beds(&several), [ErrorBasis::Repeats]);
}

#[test]
fn seeds_of_beds_that_become_too_large_are_refused() {
    let mut job = repeated();
    job["spec"]["seed"] = json!(9_007_199_254_740_990_u64);
    let violations = submission(&job).expect_err("this must be refused");
    assert_eq!(violations[0].pointer, "/spec/seed");
    job["spec"]["seed"] = json!(9_007_199_254_740_989_u64);
    assert!(submission(&job).is_ok());
    job["spec"]["repeats"] = json!(0);
    let violations = submission(&job).expect_err("this must be refused");
    assert_eq!(violations[0].pointer, "/spec/repeats");
}
