//! Sections of composites as jobs: against closed forms, their own error estimates and promises.
mod scene;

use loadframe_api::{JobSpec, Report, Submission, SubmissionError};
use loadframe_physics::{Ending, Interrupt, Uninterrupted};
use scene::{AtLook, Record, assert_same, run_job};
use serde_json::{Value, json};

fn job(spec: &Value) -> JobSpec {
    let body = json!({"kind": "composite_bending", "spec": spec});
    match Submission::from_slice(body.to_string().as_bytes()) {
        Ok(submission) => submission.spec,
        Err(SubmissionError::Invalid(violations)) => panic!("{violations:#?}"),
        Err(error) => panic!("{error}"),
    }
}

fn run_on(spec: &Value, threads: usize) -> (Report, Record) {
    let mut record = Record::default();
    match run_job(&job(spec), &mut record, &Uninterrupted, None, threads) {
        Ok(Ending::Finished(report)) => (report, record),
        other => panic!("{other:?}"),
    }
}

fn run(spec: &Value) -> (Report, Record) {
    run_on(spec, 1)
}

fn value(report: &Report, name: &str) -> f64 {
    let quantity = &report.summary[name];
    quantity
        .value
        .unwrap_or_else(|| panic!("{name} is not known"))
}

fn error(report: &Report, name: &str) -> f64 {
    let error = report.summary[name].error.as_ref();
    error.unwrap_or_else(|| panic!("no error of {name}")).value
}

/// The spec with another value at a JSON pointer.
fn with(spec: &Value, pointer: &str, value: Value) -> Value {
    let mut changed = spec.clone();
    *changed
        .pointer_mut(pointer)
        .expect("the spec has the field") = value;
    changed
}

/// The paper's section with five fibres under its load.
fn macro_case(angle: f64, cells: u32) -> Value {
    let fibres: Vec<Value> = [5.0, 20.0, 35.0, 50.0, 65.0]
        .iter()
        .map(|place| {
            let through = if angle == 0.0 { [35.0, *place] } else { [*place, 35.0] };
            json!({"material": "fibre", "through_mm": through, "angle_deg": angle, "thickness_mm": 0.7})
        })
        .collect();
    json!({
        "version": 1,
        "section": {"length_mm": 70, "height_mm": 70, "thickness_mm": 1, "state": "plane_stress"},
        "materials": {
            "filler": {"isotropic": {"youngs_modulus_mpa": 85, "poisson_ratio": 0.3}},
            "fibre": {"orthotropic": {"modulus_1_mpa": 11500, "modulus_2_mpa": 6430,
                                      "poisson_ratio_12": 0.28, "shear_modulus_12_mpa": null}},
        },
        "matrix": "filler",
        "fibres": fibres,
        "grid": {"cells": [cells, cells]},
        "lattice": {"exact": {}},
        "test": {"supports": {"left": "clamped", "right": "clamped"},
                 "load": {"force_n": [0, -10], "on": {"face": "top"}}},
        "probes_mm": [[35, 70], [35, 35]],
        "accuracy": {"solver": "static", "geometry": "linear"},
    })
}

/// A strip of one material.
fn strip(sides: [f64; 2], cells: [u32; 2], test: Value) -> Value {
    json!({
        "version": 1,
        "section": {"length_mm": sides[0], "height_mm": sides[1], "thickness_mm": 2, "state": "plane_stress"},
        "materials": {"steel": {"isotropic": {"youngs_modulus_mpa": 1000, "poisson_ratio": 0.3},
                                "density_kg_per_m3": 1000}},
        "matrix": "steel",
        "grid": {"cells": cells},
        "test": test,
    })
}

#[test]
fn a_pull_gives_back_the_material_at_any_angle() {
    let (e1, e2, nu, g) = (11_500.0, 643.0, 0.28, 355.0);
    for angle in [0.0_f64, 17.0, 45.0, 90.0] {
        let mut spec = strip([20.0, 10.0], [8, 4], json!({"tension": {"strain": 1e-4}}));
        spec["materials"]["steel"] = json!({"orthotropic": {"modulus_1_mpa": e1, "modulus_2_mpa": e2,
            "poisson_ratio_12": nu, "shear_modulus_12_mpa": g}});
        spec["matrix_angle_deg"] = json!(angle);
        let (report, _) = run(&spec);
        let (s, c) = angle.to_radians().sin_cos();
        let both = c * c * s * s;
        let along = c.powi(4) / e1 + s.powi(4) / e2 + both * (1.0 / g - 2.0 * nu / e1);
        let across = both * (1.0 / e1 + 1.0 / e2 - 1.0 / g) - nu / e1 * (c.powi(4) + s.powi(4));
        // grips that let it slide let an off-axis strip shear as it likes
        let modulus = value(&report, "effective_modulus");
        assert!((modulus * along - 1.0).abs() < 1e-9, "{angle}: {modulus}");
        let ratio = value(&report, "effective_poisson_ratio");
        assert!((ratio + across / along).abs() < 1e-9, "{angle}: {ratio}");
    }
}

#[test]
fn shear_gives_back_the_shear_modulus() {
    let spec = strip([20.0, 10.0], [8, 4], json!({"shear": {"strain": 1e-3}}));
    let (report, _) = run(&spec);
    let modulus = value(&report, "effective_shear_modulus");
    assert!((modulus / (1_000.0 / 2.6) - 1.0).abs() < 1e-9, "{modulus}");
}

/// The estimate is checked against a graded grid of four times the cells.
#[test]
fn the_error_told_is_about_the_true_one() {
    let mut micro = macro_case(0.0, 10);
    micro["section"]["length_mm"] = json!(6.3);
    micro["section"]["height_mm"] = json!(6.3);
    micro["fibres"] = json!([{"material": "fibre", "through_mm": [3.15, 3.15], "angle_deg": 0,
                              "thickness_mm": 0.7}]);
    micro["probes_mm"] = json!([]);
    let slanted = {
        let mut spec = macro_case(0.0, 10);
        spec["fibres"][0]["angle_deg"] = json!(30);
        spec["fibres"] = json!([spec["fibres"][0]]);
        spec["fibres"][0]["through_mm"] = json!([35, 35]);
        spec
    };
    let mut worst: f64 = 0.0;
    let mut seen = 0;
    for (case, is_equal) in [
        (macro_case(0.0, 10), false),
        (macro_case(0.0, 10), true),
        (macro_case(90.0, 10), false),
        (micro.clone(), false),
        (micro, true),
        (slanted, false),
    ] {
        for cells in [10, 25, 40] {
            let mut spec = with(&case, "/grid/cells", json!([cells, cells]));
            if is_equal {
                spec["grid"]["equal_cells"] = json!(true);
            }
            let (told, _) = run(&spec);
            let mut fine = with(&case, "/grid/cells", json!([120, 120]));
            fine["grid"]["graded_cells_per_fibre"] = json!(4);
            let (truth, _) = run(&fine);
            for name in ["mean_top_deflection", "mean_bottom_deflection"] {
                let off = (value(&told, name) - value(&truth, name)).abs();
                let said = error(&told, name);
                worst = worst.max(off / said);
                seen += u32::from(off > said);
                assert!(
                    off < 2.0 * said,
                    "{cells} {is_equal} {name}: off {off}, said {said}"
                );
            }
        }
    }
    // one standard error holds two of three
    assert!(
        seen < 12,
        "{seen} of 36 are off by more than said, at most {worst} times"
    );
}

#[test]
fn a_cantilever_bends_as_timoshenko_says() {
    let test = json!({"supports": {"left": "clamped"},
                      "load": {"force_n": [0, -1], "on": {"face": "right"}}});
    let mut spec = strip([50.0, 5.0], [100, 10], test);
    spec["probes_mm"] = json!([[50, 2.5]]);
    let (_, record) = run(&spec);
    let deflection = -record.table("points.csv")[0][3];
    let (e, g) = (1_000.0, 1_000.0 / 2.6);
    let inertia = 2.0 * 125.0 / 12.0;
    let beam = 50.0_f64.powi(3) / (3.0 * e * inertia) + 50.0 / (5.0 / 6.0 * g * 10.0);
    assert!(
        (deflection / beam - 1.0).abs() < 3e-3,
        "{deflection} {beam}"
    );
}

#[test]
fn every_solver_comes_to_the_same_rest() {
    let spec = macro_case(90.0, 8);
    let expected = value(&run(&spec).0, "mean_top_deflection");
    for solver in ["verlet", "pbd", "xpbd"] {
        let spec = with(&spec, "/accuracy/solver", json!(solver));
        let (report, _) = run(&spec);
        let found = value(&report, "mean_top_deflection");
        assert!((found / expected - 1.0).abs() < 1e-4, "{solver}: {found}");
        let parts = &report.summary["mean_top_deflection"]
            .error
            .as_ref()
            .unwrap()
            .parts;
        assert_eq!(parts[1].source, "solver");
        assert!((parts[1].value - (found - expected).abs()).abs() < 1e-12);
    }
}

/// First bending frequency of a clamped-free beam, f = 1.8751² √(EI/(ρA L⁴)) / 2π, lower by the
/// beam's shear and turning inertia.
#[test]
fn a_released_strip_swings_at_its_frequency() {
    let test = json!({"supports": {"left": "clamped"},
                      "load": {"force_n": [0, -0.01], "on": {"face": "right"}},
                      "history": {"duration_s": 0.05, "load": "released", "points": 50}});
    let mut spec = strip([40.0, 2.0], [40, 4], test);
    spec["accuracy"] = json!({"solver": "verlet"});
    let (report, record) = run(&spec);
    let (e, density, h) = (1e9, 1_000.0, 2e-3_f64);
    let beam = 1.8751_f64.powi(2) * (e * h * h / (12.0 * density)).sqrt()
        / (0.04_f64.powi(2) * std::f64::consts::TAU);
    let found = value(&report, "natural_frequency");
    assert!((found / beam - 1.0).abs() < 0.01, "{found} {beam}");
    let energies: Vec<f64> = record
        .points
        .iter()
        .map(|point| point[3] + point[4])
        .collect();
    let first = energies[0];
    let off = energies
        .iter()
        .map(|now| (now / first - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(off < 0.02, "energy changes by {off}");
    assert_eq!(record.points.len(), 50);
}

#[test]
fn a_laminate_on_rollers_has_the_modulus_of_its_plies() {
    let mut spec = strip(
        [60.0, 2.0],
        [60, 8],
        json!({"three_point": {"span_mm": 40, "support_radius_mm": 2, "displacement_mm": 0.2}}),
    );
    spec["grid"]["graded_cells_per_fibre"] = json!(2);
    spec["materials"] = json!({"ply": {"orthotropic": {
        "modulus_1_mpa": 40000, "modulus_2_mpa": 10000, "poisson_ratio_12": 0.28,
        "shear_modulus_12_mpa": 4000, "modulus_3_mpa": 10000, "poisson_ratio_13": 0.28,
        "poisson_ratio_23": 0.4, "shear_modulus_23_mpa": 3500}}});
    spec.as_object_mut().unwrap().remove("matrix");
    spec["plies"] = json!([
        {"material": "ply", "thickness_mm": 0.5},
        {"material": "ply", "thickness_mm": 1.0, "angle_deg": 90},
        {"material": "ply", "thickness_mm": 0.5},
    ]);
    let (report, record) = run(&spec);
    // 12 EI/(bh³) = E₁ 7/8 + E₃/8
    let bending = 40_000.0 * 7.0 / 8.0 + 10_000.0 / 8.0;
    assert!((value(&report, "bending_modulus") / bending - 1.0).abs() < 1e-9);
    let shear_taken_away = value(&report, "flexural_modulus_without_shear");
    assert!(
        (shear_taken_away / bending - 1.0).abs() < 0.03,
        "{shear_taken_away}"
    );
    assert!(report.quality.values().all(|check| check.ok));
    assert_eq!(record.columns[0], "deflection_mm");
}

#[test]
fn the_papers_rule_is_told_to_be_too_stiff() {
    let lattice = json!({"paper": {"stiffness": "p_wave", "bonds": "cross"}});
    let mut plain = macro_case(0.0, 10);
    plain["fibres"] = json!([]);
    let spec = with(&plain, "/lattice", lattice);
    let (report, _) = run(&spec);
    let stiffer = value(&report, "stiffness_over_exact");
    assert!((2.5..3.1).contains(&stiffer), "{stiffer}");
    assert!(
        report
            .warnings
            .iter()
            .any(|warning| warning.code == "paper_stiffness")
    );
}

#[test]
fn large_rotations_are_warned_of_and_followed() {
    let test = json!({"supports": {"left": "clamped"},
                      "load": {"force_n": [0, -3], "on": {"face": "right"}}});
    let spec = strip([50.0, 2.0], [50, 2], test);
    let is_warned = |report: &Report| {
        let codes = report.warnings.iter().map(|warning| warning.code.as_str());
        codes.into_iter().any(|code| code == "large_displacements")
    };
    let (report, _) = run(&spec);
    assert!(is_warned(&report));
    let mut large = spec.clone();
    large["accuracy"] = json!({"geometry": "large", "load_steps": 4});
    let (report, record) = run(&large);
    assert!(!is_warned(&report));
    assert_eq!(record.points.len(), 5);
    // a cantilever cannot come down by more than its length
    let down = record.column("deflection_mm");
    assert!(down.is_sorted() && down[4] < 50.0, "{down:?}");
}

fn suspended() -> Vec<Value> {
    let mut large = macro_case(0.0, 6);
    large["accuracy"] = json!({"geometry": "large", "load_steps": 3});
    large["test"]["load"]["force_n"] = json!([0, -500]);
    let pbd = with(&macro_case(90.0, 4), "/accuracy/solver", json!("pbd"));
    let xpbd = with(&macro_case(90.0, 4), "/accuracy/solver", json!("xpbd"));
    let test = json!({"supports": {"left": "clamped"},
                      "history": {"duration_s": 2e-3, "velocity_mm_per_s": [0, -100], "points": 20}});
    let mut swing = strip([20.0, 2.0], [10, 2], test);
    swing["accuracy"] = json!({"solver": "verlet"});
    let mut rollers = strip(
        [60.0, 4.0],
        [30, 4],
        json!({"four_point": {"span_mm": 48, "force_n": 5}}),
    );
    rollers["accuracy"] = json!({"load_steps": 3});
    vec![macro_case(0.0, 6), large, pbd, xpbd, swing, rollers]
}

#[test]
fn suspended_runs_end_with_the_same_bytes_on_any_number_of_threads() {
    for (number, spec) in suspended().iter().enumerate() {
        let expected = run(spec);
        assert_same(&expected, &run_on(spec, 2));
        for looks in [1, 9, 40] {
            let mut record = Record::default();
            let mut checkpoint: Option<Vec<u8>> = None;
            let mut pieces = 1;
            let report = loop {
                let interrupt = AtLook::new(Interrupt::Suspend, looks + pieces);
                let from = checkpoint.as_deref();
                match run_job(&job(spec), &mut record, &interrupt, from, 1) {
                    Ok(Ending::Finished(report)) => break report,
                    Ok(Ending::Suspended) => checkpoint = record.checkpoint.clone(),
                    other => panic!("{other:?}"),
                }
                pieces += 1;
            };
            assert!(pieces > 1 || looks > 1, "{number} was not suspended");
            assert_same(&expected, &(report, record));
        }
    }
}

#[test]
fn a_cancelled_run_ends() {
    for spec in suspended() {
        let interrupt = AtLook::new(Interrupt::Cancel, 1);
        let ending = run_job(&job(&spec), &mut Record::default(), &interrupt, None, 1);
        assert!(matches!(ending, Ok(Ending::Cancelled)), "{ending:?}");
    }
}

fn codes(report: &Report) -> Vec<&str> {
    report
        .warnings
        .iter()
        .map(|warning| warning.code.as_str())
        .collect()
}

#[test]
fn one_cell_has_a_result_and_no_known_error() {
    let spec = with(&macro_case(0.0, 10), "/grid/cells", json!([1, 1]));
    let mut spec = with(&spec, "/fibres", json!([]));
    spec["test"] = json!({"tension": {"strain": 1e-3}});
    let (report, _) = run(&spec);
    assert!((value(&report, "effective_modulus") / 85.0 - 1.0).abs() < 1e-9);
    assert!(report.summary["effective_modulus"].error.is_none());
    assert_eq!(codes(&report), ["unknown_discretisation_error"]);
}

#[test]
fn stiffness_of_any_contrast_is_solved_or_doubted() {
    for modulus in [1e-6, 1e9] {
        let stiff = json!({"isotropic": {"youngs_modulus_mpa": modulus, "poisson_ratio": 0.3}});
        let spec = with(&macro_case(90.0, 14), "/materials/fibre", stiff);
        let (report, _) = run(&spec);
        assert!(value(&report, "mean_top_deflection") > 0.0);
        let residual = &report.quality["residual"];
        assert!(
            residual.ok || codes(&report).contains(&"residual"),
            "{residual:?}"
        );
    }
}

#[test]
fn fibres_far_thinner_than_cells_stiffen_as_layers_do() {
    // stiff threads of a millionth of the height: E of the layers in parallel
    let mut spec = macro_case(0.0, 7);
    for fibre in spec["fibres"].as_array_mut().expect("a list") {
        fibre["thickness_mm"] = json!(1e-5);
    }
    spec["materials"]["fibre"] =
        json!({"isotropic": {"youngs_modulus_mpa": 8.5e6, "poisson_ratio": 0.3}});
    spec["test"] = json!({"tension": {"strain": 1e-4}});
    let (report, _) = run(&spec);
    let share = 5.0 * 1e-5 / 70.0;
    let layers = 85.0 * (1.0 - share) + 8.5e6 * share;
    let found = value(&report, "effective_modulus");
    assert!((found / layers - 1.0).abs() < 1e-6, "{found} {layers}");
}

#[test]
fn a_load_beyond_what_the_section_can_carry_ends_with_the_place() {
    let mut spec = macro_case(0.0, 6);
    spec["accuracy"] = json!({"geometry": "large"});
    spec["test"]["load"]["force_n"] = json!([0, -1e7]);
    let ending = run_job(&job(&spec), &mut Record::default(), &Uninterrupted, None, 1);
    let error = ending.expect_err("no section carries this");
    assert!(error.is_of_the_spec());
    let told = error.to_string();
    assert!(
        told.contains("turns inside out") || told.contains("no equilibrium"),
        "{told}"
    );
}

#[test]
fn edges_alone_fold_and_say_so() {
    let mut spec = with(
        &macro_case(0.0, 10),
        "/lattice",
        json!({"paper": {"stiffness": "bare", "bonds": "edges"}}),
    );
    spec["test"]["supports"] = json!({"bottom": "clamped"});
    let body = json!({"kind": "composite_bending", "spec": spec});
    let refused = Submission::from_slice(body.to_string().as_bytes());
    let Err(SubmissionError::Invalid(violations)) = refused else {
        panic!("it is refused before it runs")
    };
    assert_eq!(violations[0].pointer, "/spec/lattice/paper/bonds");
    assert_eq!(violations[0].code, "not_stiff");
}
