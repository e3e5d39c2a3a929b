//! Calibrations find what synthetic data were made with, say what data leave open, and do not depend
//! on threads or interruptions.
#![allow(clippy::float_cmp, reason = "copied numbers are exact")]
mod machine_tables;
#[path = "../scene/mod.rs"]
mod scene;

use loadframe_api::{
    JobKind, JobSpec, Report, Submission, result_units,
    spec::nonwoven_tensile::{Breaking, NonwovenTensile, Solver},
};
use loadframe_physics::{Ending, Interrupt, SimulationError, Uninterrupted};
use scene::{AtLook, Record, assert_same, finished, polyester, run, run_job, solver, value};
use serde_json::{Value, json};

/// Specimens a trial.
const REALISATIONS: u32 = 3;

/// A fabric small enough for hundreds of tests.
fn small() -> NonwovenTensile {
    let mut spec = polyester(7, 9, 2);
    spec.test.strain_step = 0.02;
    spec.accuracy = solver(Solver::NewtonCg, 20.0);
    spec
}

/// A calibration of `inner`.
fn calibration(inner: &NonwovenTensile, free: &Value, measured: &Value) -> Value {
    json!({
        "kind": "calibrate",
        "spec": {
            "version": 1,
            "job": {"kind": "nonwoven_tensile", "spec": inner},
            "free": free,
            "measured": measured,
            "realisations": REALISATIONS,
            "max_trials": 60,
        }
    })
}

fn parsed(job: &Value) -> JobSpec {
    let submission = Submission::from_slice(job.to_string().as_bytes());
    let submission = submission.unwrap_or_else(|error| panic!("{}", error.into_problem()));
    submission.spec
}

fn calibrate(job: &Value, threads: usize) -> (Report, Record) {
    let mut record = Record::default();
    let ending = run_job(&parsed(job), &mut record, &Uninterrupted, None, threads);
    (finished(ending.expect("it can be calibrated")), record)
}

/// Mean results of specimens whose seeds no calibration here uses.
fn measure(spec: &NonwovenTensile, repeats: u32) -> Report {
    let mut spec = spec.clone();
    spec.seed = 1000;
    spec.test.repeats = repeats;
    run(&spec).0
}

fn codes(report: &Report) -> Vec<&str> {
    let warnings = report.warnings.iter();
    warnings.map(|warning| warning.code.as_str()).collect()
}

/// Elastic moduli from a stiffness and a Poisson ratio: nothing breaks, so that results follow the
/// parameters smoothly.
fn elastic() -> (NonwovenTensile, Value) {
    let mut spec = small();
    spec.accuracy = solver(Solver::NewtonCg, 1e4);
    spec.test.breaking = Breaking::None;
    spec.test.max_strain = 0.1;
    let free = json!([
        {"parameter": "/bond/modulus_n", "min": 0.1, "max": 2.0, "start": 0.6},
        {"parameter": "/bond/compression_stiffness_n", "min": 0.02, "max": 1.0, "start": 0.08},
    ]);
    (spec, free)
}

#[test]
fn moduli_are_found_from_specimens_of_other_seeds() {
    let (spec, free) = elastic();
    let data = measure(&spec, 30);
    let results = ["secant_stiffness_at_10_percent", "poisson_ratio"].map(|name| {
        let quantity = &data.summary[name];
        // of the mean of the thirty
        let deviation = quantity.deviation.expect("specimens scatter") / 30.0_f64.sqrt();
        json!({"result": name, "value": quantity.value, "deviation": deviation})
    });
    let mut job = calibration(&spec, &free, &json!({"results": results}));
    job["spec"]["realisations"] = json!(10);
    job["spec"]["tolerance"] = json!(0.05);
    let (report, record) = calibrate(&job, 2);
    assert_eq!(report.stop_reason, "tolerance_reached");
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    for (name, truth) in [
        ("bond_modulus_n", 0.399),
        ("bond_compression_stiffness_n", 0.157),
    ] {
        let [low, high] = report.summary[name].interval.expect("specimens scatter");
        // 95 % intervals miss one time in twenty, these seeds are not among those
        assert!(low < truth && truth < high, "{name}: {low} … {high}");
        // and say something
        assert!(high / low < 1.5, "{name}: {low} … {high}");
    }
    // what is written can be posted, and gives what was fitted
    let fitted = std::str::from_utf8(&record.files["fitted.json"]).expect("text");
    let fitted: Value = serde_json::from_str(fitted).expect("JSON");
    let modulus = fitted["spec"]["bond"]["modulus_n"].as_f64();
    assert_eq!(modulus, report.summary["bond_modulus_n"].value);
    parsed(&fitted);
    let trials = record.table("trials.csv");
    assert_eq!(trials.len() as f64, value(&report, "trials"));
    let misfit = value(&report, "misfit");
    assert!(trials.iter().any(|row| row.last() == Some(&misfit)));
}

#[test]
fn a_strength_is_found_through_avalanches() {
    let spec = small();
    let force = value(&measure(&spec, 20), "max_force");
    let free =
        json!([{"parameter": "/bond/mean_strength_n", "min": 1.0, "max": 10.0, "start": 5.1}]);
    let measured = json!({"results": [{"result": "max_force", "value": force, "unit": "N"}]});
    let (report, _) = calibrate(&calibration(&spec, &free, &measured), 2);
    assert_eq!(report.stop_reason, "tolerance_reached");
    let found = &report.summary["bond_mean_strength_n"];
    let [low, high] = found.interval.expect("specimens scatter");
    assert!(low < 3.397 && 3.397 < high, "{low} … {high}");
    let off = value(&report, "max_force") / force - 1.0;
    assert!(off.abs() <= 0.002, "{off}");
}

#[test]
fn a_curve_is_followed() {
    let (spec, _) = elastic();
    let mut other = spec.clone();
    other.seed = 50;
    let curve = run(&other).1;
    let rows: Vec<[f64; 2]> = curve
        .points
        .iter()
        .map(|point| [point[0], point[1]])
        .collect();
    let text: Vec<String> = rows.iter().map(|[x, y]| format!("{x};{y}")).collect();
    let free = json!([
        {"parameter": "/bond/modulus_n", "min": 0.1, "max": 2.0, "start": 0.2},
        {"parameter": "/bond/friction_modulus_n", "min": 0.0, "max": 5.0, "start": 3.0, "scale": "linear"},
    ]);
    let measured = json!({"curve": {"csv": format!("Dehnung;Kraft\n{}\n", text.join("\n"))}});
    let mut job = calibration(&spec, &free, &measured);
    // the data's own specimen
    job["spec"]["seed"] = json!(50);
    job["spec"]["realisations"] = json!(1);
    job["spec"]["tolerance"] = json!(1e-4);
    let (report, record) = calibrate(&job, 2);
    assert_eq!(codes(&report), ["one_realisation"], "{:?}", report.warnings);
    // a misfit of 1e-4 of the force at the end leaves less than 1 % of each parameter open
    for (name, truth) in [
        ("bond_modulus_n", 0.399),
        ("bond_friction_modulus_n", 1.473),
    ] {
        let found = value(&report, name);
        assert!((found / truth - 1.0).abs() < 0.01, "{name} {found}");
    }
    assert_eq!(record.columns, curve.columns);
    assert_eq!(record.table("fit_curve.csv").len(), rows.len());
}

#[test]
fn a_parameter_at_its_bound_is_named() {
    let (spec, _) = elastic();
    let stiffness = value(&run(&spec).0, "secant_stiffness_at_10_percent");
    let free = json!([{"parameter": "/bond/modulus_n", "min": 0.1, "max": 0.45}]);
    let result = "secant_stiffness_at_10_percent";
    let measured = json!({"results": [{"result": result, "value": 2.0 * stiffness}]});
    let (report, _) = calibrate(&calibration(&spec, &free, &measured), 2);
    assert_eq!(report.stop_reason, "no_further_descent");
    assert_eq!(
        codes(&report),
        ["misfit_above_tolerance", "parameter_at_bound"]
    );
    assert!(report.warnings[1].detail.contains("/bond/modulus_n"));
    let found = value(&report, "bond_modulus_n");
    assert!(found > 0.44 && found <= 0.45, "{found}");
}

#[test]
fn parameters_that_do_the_same_are_named_and_those_that_do_nothing() {
    let (spec, _) = elastic();
    let report = run(&spec).0;
    let result = "secant_stiffness_at_10_percent";
    let measured = json!({"results": [{"result": result, "value": 1.3 * value(&report, result)}]});
    let free = json!([
        {"parameter": "/bond/modulus_n", "min": 0.1, "max": 2.0},
        {"parameter": "/bond/friction_modulus_n", "min": 0.5, "max": 5.0},
        {"parameter": "/bond/mean_strength_n", "min": 1.0, "max": 5.0},
    ]);
    let (report, _) = calibrate(&calibration(&spec, &free, &measured), 2);
    let expected = ["parameter_without_effect", "parameters_not_told_apart"];
    assert_eq!(codes(&report), expected, "{:?}", report.warnings);
    assert!(report.warnings[0].detail.contains("/bond/mean_strength_n"));
    let detail = &report.warnings[1].detail;
    assert!(
        detail.starts_with("/bond/modulus_n, /bond/friction_modulus_n do the same"),
        "{detail}"
    );
    assert!(report.summary["bond_modulus_n"].interval.is_none());
}

#[test]
fn trials_end_where_they_are_used_up() {
    let spec = small();
    let free =
        json!([{"parameter": "/bond/mean_strength_n", "min": 1.0, "max": 10.0, "start": 9.0}]);
    let measured = json!({"results": [{"result": "max_force", "value": 30.0}]});
    let mut job = calibration(&spec, &free, &measured);
    job["spec"]["max_trials"] = json!(5);
    let (report, _) = calibrate(&job, 2);
    assert_eq!(report.stop_reason, "max_trials");
    assert!(codes(&report).contains(&"trials_used_up"));
    assert!(value(&report, "trials") <= 5.0);
}

#[test]
fn bytes_are_the_same_on_any_number_of_threads_and_after_any_suspension() {
    let spec = small();
    let free = json!([
        {"parameter": "/bond/mean_strength_n", "min": 1.0, "max": 10.0, "start": 5.1},
        {"parameter": "/bond/friction_modulus_n", "min": 0.3, "max": 5.0, "start": 0.8},
    ]);
    let measured = json!({"results": [
        {"result": "max_force", "value": 33.0},
        {"result": "strain_at_max_force", "value": 1.1},
    ]});
    let mut job = calibration(&spec, &free, &measured);
    // far enough to go on without derivatives
    job["spec"]["max_trials"] = json!(40);
    job["spec"]["tolerance"] = json!(0.0);
    let expected = calibrate(&job, 1);
    for threads in [2, 3] {
        assert_same(&expected, &calibrate(&job, threads));
    }
    let spec = parsed(&job);
    for (looks, threads) in [(300, 1), (3000, 2)] {
        let (mut record, mut checkpoint, mut pieces) = (Record::default(), None::<Vec<u8>>, 0);
        record.always_checkpoint = true;
        let report = loop {
            pieces += 1;
            let interrupt = AtLook::new(Interrupt::Suspend, looks);
            match run_job(
                &spec,
                &mut record,
                &interrupt,
                checkpoint.as_deref(),
                threads,
            ) {
                Ok(Ending::Suspended) => checkpoint = record.checkpoint.clone(),
                Ok(ending) => break finished(ending),
                Err(error) => panic!("{error:?}"),
            }
        };
        assert!(pieces > 2, "{looks} looks suspended {pieces} times");
        assert_same(&expected, &(report, record));
    }
}

#[test]
fn a_cancelled_calibration_ends_at_once() {
    let (spec, free) = elastic();
    let measured = json!({"results": [{"result": "poisson_ratio", "value": 0.5}]});
    let job = parsed(&calibration(&spec, &free, &measured));
    let interrupt = AtLook::new(Interrupt::Cancel, 50);
    let mut record = Record::default();
    let ending = run_job(&job, &mut record, &interrupt, None, 2);
    assert!(matches!(ending, Ok(Ending::Cancelled)), "{ending:?}");
    assert!(record.files.is_empty());
}

#[test]
fn what_a_test_does_not_get_to_is_told_at_the_first_trial() {
    let (spec, free) = elastic();
    let mut short = spec.clone();
    short.test.max_strain = 0.05;
    let measured = json!({"results": [{"result": "poisson_ratio", "value": 0.5}]});
    let words = "seed 1 gives no value for poisson_ratio";
    assert_error(&calibration(&short, &free, &measured), words);
    // a result that such jobs may have, and this one has not
    let measured = json!({"results": [{"result": "strength_pa", "value": 1.0}]});
    let words = "no result named \"strength_pa\"; it has: max_force";
    assert_error(&calibration(&spec, &free, &measured), words);
}

fn assert_error(job: &Value, words: &str) {
    let ending = run_job(
        &parsed(job),
        &mut Record::default(),
        &Uninterrupted,
        None,
        1,
    );
    let Err(error @ SimulationError::Calibration(_)) = ending else {
        panic!("{ending:?}")
    };
    assert!(error.to_string().contains(words), "{error}");
}

#[test]
fn the_example_meets_what_was_measured() {
    let example = JobKind::Calibrate.examples()[0];
    let job: Value = serde_json::from_str(example.body).expect("JSON");
    let (report, _) = calibrate(&job, 2);
    assert_eq!(report.stop_reason, "tolerance_reached", "{report:#?}");
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn other_kinds_are_calibrated_alike() {
    let scene = |modulus: f64| {
        json!({
            "version": 1,
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": modulus,
                                    "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
            "bodies": [{"sphere": {"radius_m": 0.05}, "material": "stone", "position_m": [0, 0, 0.05]}],
            "planes": [{"name": "floor", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
            "laws": {"local_damping": 0.7},
            "stages": [{"settle": {"unbalanced_force_ratio": 1e-4, "time_s": 1.0}}],
        })
    };
    let job = parsed(&json!({"kind": "granular_scene", "spec": scene(3e6)}));
    let ending = run_job(&job, &mut Record::default(), &Uninterrupted, None, 1);
    let energy = value(&finished(ending.expect("it settles")), "elastic_energy");
    let job = json!({"kind": "calibrate", "spec": {
        "version": 1,
        "job": {"kind": "granular_scene", "spec": scene(1e6)},
        "free": [{"parameter": "/materials/stone/youngs_modulus_pa", "min": 1e5, "max": 1e8}],
        "measured": {"results": [{"result": "elastic_energy", "value": energy, "unit": "J"}]},
        "realisations": 1,
    }});
    let (report, _) = calibrate(&job, 1);
    // at rest the energy is (m g)²/(2 k) with k in proportion to the modulus, which is therefore known
    // to the tolerance of the energy
    let found = &report.summary["materials_stone_youngs_modulus_pa"];
    let off = found.value.expect("it is found") / 3e6 - 1.0;
    assert!(off.abs() < 0.0025, "{off}");
    assert_eq!(found.unit, "Pa");
}

#[test]
fn results_and_columns_are_those_that_a_spec_is_checked_against() {
    use JobKind::{
        BallastOedometer, CompositeBending, GranularScene, NonwovenTensile, PaperTensile,
    };
    let quick = [
        (NonwovenTensile, 1),
        (PaperTensile, 0),
        (GranularScene, 0),
        (CompositeBending, 0),
    ];
    for (kind, example) in quick {
        let body = kind.examples()[example].body;
        let spec = Submission::from_slice(body.as_bytes())
            .expect("a valid example")
            .spec;
        let mut record = Record::default();
        let ending = run_job(&spec, &mut record, &Uninterrupted, None, 2);
        let report = finished(ending.expect("it runs"));
        for (name, quantity) in &report.summary {
            let units = result_units(kind, name);
            assert!(
                units.contains(&quantity.unit.as_str()),
                "{kind}: {name} in {}",
                quantity.unit
            );
        }
        let columns = spec.curve_columns();
        assert!(
            columns.starts_with(&record.columns),
            "{kind}: {:?}",
            record.columns
        );
    }
    // what a ballast test takes over from its scene
    assert_eq!(result_units(BallastOedometer, "settlement"), ["mm"]);
    assert_eq!(result_units(BallastOedometer, "total_mass"), ["kg"]);
}
