//! Beds that may give way beside what loads them.
use loadframe_api::{JobSpec, Quantity, Report, Submission};
use serde_json::json;

use super::add;

/// The error of a way of 2 mm over it, of a box test with this peak force [N], and what is said.
fn stated(peak_force_n: f64) -> (Option<f64>, Option<String>) {
    let body = json!({"kind": "ballast_box", "spec": {"version": 1,
        "grains": {"sizes": {"uniform": {"smallest_radius_m": 0.018, "largest_radius_m": 0.036}}},
        "materials": {"aggregate": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 2e8,
            "stiffness_ratio": 0.35, "friction_angle_rad": 0.5}},
        "preparation": {"longest_settling_s": 6},
        "accuracy": "draft",
        "test": {"smallest_force_n": 0.05 * peak_force_n, "peak_force_n": peak_force_n}}});
    let job = Submission::from_slice(body.to_string().as_bytes());
    let JobSpec::BallastBox(spec) = job.expect("a valid job").spec else {
        panic!("another kind")
    };
    let mut report = Report::default();
    let way = Quantity::new(2.0, "mm", "");
    report.summary.insert("peak_displacement".to_owned(), way);
    let words = add(&mut report, &spec);
    let error = report.summary["peak_displacement"].error.clone();
    (error.map(|error| error.value / 2.0), words)
}

#[test]
fn a_box_has_errors_up_to_the_load_that_its_bed_carries() {
    // three times ρ g B over the sleeper, with ρ = 2600 kg/m³, B = 0.25 m and 0.25 m × 0.3 m
    let of_weight = 2600.0 * 9.81 * 0.25 * 0.25 * 0.3;
    let (error, words) = stated(3.0 * of_weight);
    assert_eq!(words, None);
    assert!((0.02..0.5).contains(&error.expect("a measured test")));
    // half of the laboratory's load
    let (error, words) = stated(20e3);
    assert_eq!(error, None);
    let words = words.expect("a reason");
    assert!(words.contains("stress_over_weight is 41.82"), "{words}");
}
