//! Measured curves in a job: text becomes points once, and the job says how.
use loadframe_api::{JobSpec, Submission, result_names, result_units, spec::calibrate::Calibrate};
use serde_json::{Value, json};

/// A calibration of two bonds in a row to a curve.
fn job(curve: &Value) -> Value {
    json!({
        "kind": "calibrate",
        "spec": {
            "version": 1,
            "job": {"kind": "nonwoven_tensile", "spec": {
                "version": 1,
                "fabric": {"network": {
                    "nodes_mm": [[0, 0, 0], [0, 10, 0], [0, 20, 0]],
                    "jaws": ["bottom", "free", "top"],
                    "bonds": [{"nodes": [0, 1]}, {"nodes": [1, 2]}],
                    "width_mm": 10,
                }},
                "bond": {"modulus_n": 1.0},
                "test": {"max_strain": 0.5, "breaking": "none"},
            }},
            "free": [{"parameter": "/bond/modulus_n", "min": 0.1, "max": 10.0}],
            "measured": {"curve": curve},
        }
    })
}

fn read(curve: &Value) -> (JobSpec, Calibrate) {
    let submission = Submission::from_slice(job(curve).to_string().as_bytes());
    let spec = submission
        .unwrap_or_else(|error| panic!("{}", error.into_problem()))
        .spec;
    let JobSpec::Calibrate(calibrate) = &spec else {
        panic!("a calibration was given");
    };
    (spec.clone(), (**calibrate).clone())
}

#[test]
fn text_becomes_points_in_the_units_of_the_job_and_says_how() {
    let text = "Strain\tTime (s)\tLoad (mN)\n0.0200\t1\t41\n0.3400\t2\t1,027\n";
    let (spec, calibrate) = read(&json!({"csv": text}));
    let curve = calibrate.measured.curve.as_ref().expect("a curve");
    assert_eq!(curve.rows, [[0.02, 0.041], [0.34, 1.027]]);
    assert_eq!((&curve.csv, &curve.reading), (&None, &None));
    assert_eq!(
        curve.read_as[2],
        "column 3 'Load (mN)' as force_n, times 0.001"
    );
    // the normalised job is read again as it is
    let again = JobSpec::from_json(spec.kind(), &spec.to_json()).expect("the same job");
    assert_eq!(again.sha256(), spec.sha256());
}

#[test]
fn hints_of_the_reading_are_taken() {
    let curve = json!({
        "csv": "A;B\n2;230\n4;520\n",
        "reading": {
            "abscissa": {"column": "1", "unit": "mm"},
            "ordinate": {"column": "B", "unit": "mN"},
            "gauge_length_mm": 20,
        },
    });
    let found = Submission::from_slice(job(&curve).to_string().as_bytes());
    let violations = found
        .expect_err("a line of text that names nothing")
        .violations();
    assert_eq!(violations[0].pointer, "/spec/measured/curve/csv");
    let mut named = curve;
    named["csv"] = json!("Extension;B\n2;230\n4;520\n");
    let curve = read(&named).1.measured.curve.expect("a curve");
    assert_eq!(curve.rows, [[0.1, 0.23], [0.2, 0.52]]);
}

#[test]
fn results_have_the_units_of_their_kind() {
    use loadframe_api::JobKind::{CompositeBending, NonwovenTensile, PaperTensile};
    assert_eq!(result_units(NonwovenTensile, "max_force"), ["N"]);
    assert_eq!(result_units(NonwovenTensile, "strength_along_x"), ["N/m"]);
    assert_eq!(
        result_units(NonwovenTensile, "anisotropy_of_strength"),
        ["1"]
    );
    // of a sheet, and of one fibre
    assert_eq!(result_units(PaperTensile, "max_force"), ["N", "mN"]);
    assert!(result_units(CompositeBending, "max_froce").is_empty());
    assert!(result_names(NonwovenTensile).contains(&"poisson_ratio"));
}
