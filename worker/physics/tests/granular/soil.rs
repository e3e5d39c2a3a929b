//! Tests of soil: their stresses and strains, closed forms, and what is known of sand.
use loadframe_api::{JobSpec, Report, Submission, SubmissionError};
use loadframe_physics::{Ending, Uninterrupted};
use serde_json::{Value, json};

use super::{
    assert_close,
    scene::{Record, run_job},
};

fn triaxial() -> Value {
    json!({"kind": "triaxial", "spec": {"version": 1,
        "grains": {"sizes": {"uniform": {"smallest_radius_m": 0.001, "largest_radius_m": 0.0015}}},
        "soil": {"density_kg_per_m3": 2650, "youngs_modulus_pa": 1e8, "friction_angle_rad": 0.5},
        "preparation": {"friction_factor": 0.1},
        "test": {"width_m": 0.012, "height_m": 0.014, "confining_pressure_pa": 1e5, "axial_strain": 0.1,
                 "axial_strain_rate_per_s": 2.0},
        "accuracy": {"critical_step_fraction": 0.4}, "output": {"rows": 60}}})
}

fn direct_shear() -> Value {
    let mut spec = triaxial();
    spec["kind"] = json!("direct_shear");
    spec["spec"]["test"] = json!({"length_m": 0.016, "width_m": 0.012, "height_m": 0.012,
                                  "normal_stress_pa": 1e5, "shear_velocity_m_per_s": 0.05});
    spec
}

fn job(body: &Value) -> Result<JobSpec, SubmissionError> {
    Submission::from_slice(body.to_string().as_bytes()).map(|submission| submission.spec)
}

fn run(body: &Value) -> (Report, Record) {
    let job = job(body).expect("a valid job");
    let mut record = Record::default();
    match run_job(&job, &mut record, &Uninterrupted, None, 1) {
        Ok(Ending::Finished(report)) => (report, record),
        other => panic!("{other:?}"),
    }
}

fn value(report: &Report, name: &str) -> f64 {
    let quantity = &report.summary[name];
    quantity
        .value
        .unwrap_or_else(|| panic!("{name}: {report:?}"))
}

/// The walls at the sides keep 100 kPa, strains are those of the walls, and sin φ = q/(q + 2 σ_r) row by row.
/// Spheres of φ = 27° between smooth walls have 20 to 40° as a bed.
#[test]
fn a_triaxial_test_keeps_its_pressure_and_finds_an_angle() {
    let (report, record) = run(&triaxial());
    let column = |name: &str| record.column(name);
    let (radial, axial) = (column("radial_stress_kpa"), column("axial_stress_kpa"));
    for (radial, axial) in radial.iter().zip(&axial) {
        // rows are moments
        assert_close(*radial, 100.0, 10.0);
        assert!(*axial > 90.0, "{axial}");
    }
    assert_close(value(&report, "confining_pressure"), 1e5, 2e3);
    let angles = column("mobilised_friction_angle_deg");
    for ((q, radial), angle) in column("deviator_stress_kpa")
        .iter()
        .zip(&radial)
        .zip(&angles)
    {
        assert_close(angle.to_radians().sin(), q / (q + 2.0 * radial), 1e-12);
    }
    assert_close(axial[0] / radial[0], 1.0, 0.05);
    let peak = value(&report, "peak_friction_angle");
    assert!((20.0..40.0).contains(&peak), "{report:#?}");
    assert!(
        value(&report, "critical_friction_angle") <= peak,
        "{report:#?}"
    );
    let strains = column("axial_strain");
    let (first, last) = (strains[0], strains[strains.len() - 1]);
    assert_close(first, 0.0, 1e-15);
    // of the height that it has, not of that it is made for
    let ratio = 14.0 / value(&report, "initial_height");
    assert_close(last, 0.1 * ratio, 1e-3 * ratio);
    let ratio = value(&report, "initial_void_ratio");
    // 0.5 to 0.85 is that of a bed; smooth walls leave gaps beside a few layers of spheres
    assert!((0.5..1.0).contains(&ratio), "{ratio}");
    assert_close(report.quality["stress_not_kept"].value, 0.0, 1e-12);
    assert!(
        report.quality["wall_force_imbalance"].value < 0.2,
        "{report:#?}"
    );
    assert!(record.files.contains_key("scene.json"));
}

/// Pressed with little friction a specimen is dense, rises to a peak and grows; with all of its friction it is
/// looser and weaker at first ([SchanzVermeer1996] and any textbook).
#[test]
fn a_dense_specimen_is_stronger_and_grows_more_than_a_loose_one() {
    let (dense, _) = run(&triaxial());
    let mut loose = triaxial();
    loose["spec"]["preparation"]["friction_factor"] = json!(1.0);
    let (loose, _) = run(&loose);
    let of = |name: &str| [&dense, &loose].map(|report| value(report, name));
    let [tight, wide] = of("initial_void_ratio");
    assert!(tight < wide - 0.03, "{tight} {wide}");
    let [strong, weak] = of("peak_friction_angle");
    assert!(strong > weak, "{strong} {weak}");
    let [grown, less] = of("final_volumetric_strain");
    assert!(grown < less, "{grown} {less}");
}

#[test]
fn a_shear_box_carries_the_same_force_in_both_halves_and_keeps_its_stress() {
    let (report, record) = run(&direct_shear());
    assert_close(value(&report, "normal_stress"), 1e5, 3e3);
    let [shear, normal] = ["shear_stress_kpa", "normal_stress_kpa"].map(|name| record.column(name));
    let ratios = record.column("stress_ratio");
    for ((shear, normal), ratio) in shear.iter().zip(&normal).zip(&ratios) {
        assert_close(shear / normal, *ratio, 1e-12);
    }
    let peak = value(&report, "peak_friction_angle");
    assert!((20.0..50.0).contains(&peak), "{report:#?}");
    assert_close(value(&report, "largest_shear_displacement"), 1.6, 1e-3);
    assert_close(report.quality["stress_not_kept"].value, 0.0, 1e-12);
    assert!(
        report.quality["wall_force_imbalance"].value < 0.3,
        "{report:#?}"
    );
}

#[test]
fn tests_of_soil_refuse_what_they_cannot_be() {
    let refused = |body: &Value| match job(body) {
        Err(SubmissionError::Invalid(violations)) => violations
            .into_iter()
            .map(|violation| (violation.pointer, violation.code))
            .collect::<Vec<_>>(),
        other => panic!("{other:?}"),
    };
    let at = |pointer: &str, code: &str| vec![(format!("/spec/{pointer}"), code.to_owned())];
    let mut body = triaxial();
    body["spec"]["grains"] = json!({});
    assert_eq!(refused(&body), at("grains/sizes", "missing"));
    let mut body = triaxial();
    body["spec"]["grains"]["sizes"] = json!({"radius_m": 0.01});
    assert_eq!(refused(&body), at("grains/sizes", "does_not_fit"));
    let mut body = direct_shear();
    body["spec"]["test"]["shear_displacement_m"] = json!(0.01);
    assert_eq!(refused(&body), at("test/shear_displacement_m", "too_large"));
}
