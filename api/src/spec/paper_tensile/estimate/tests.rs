//! Times of large sheets beside those that runs took.
use serde_json::{Value, json};

use super::*;
use crate::Spec as _;

/// What a run may take more or less than is told.
const FACTOR: f64 = 2.0;

/// Softwood at 60 g/m² half as wide as long, bonds inside straight parts of 100 µm.
fn sheet(length_mm: f64, break_precision: f64, mut model: Value) -> PaperTensile {
    model["segment_um"] = json!(100);
    let spec = json!({
        "version": 1,
        "pulp": [{"name": "softwood", "length_mm": 2, "length_variation": 0.4, "width_um": 28, "wall_um": 2,
                  "coarseness_mg_per_m": 0.15, "youngs_modulus_gpa": 30, "poisson_ratio": 0.3,
                  "shear_modulus_gpa": 2.5, "strength_mpa": 600, "shape_factor": 0.95}],
        "specimen": {"sheet": {"length_mm": length_mm, "width_mm": 0.5 * length_mm, "grammage_g_per_m2": 60}},
        "bond": {"normal_strength_mpa": 4, "shear_strength_mpa": 4, "stiffness_n_per_m_per_um2": 250},
        "model": model,
        "test": {"max_strain": 0.1},
        "accuracy": {"bonds_at": "inside", "break_precision": break_precision},
        "output": {"snapshot_every_steps": 0},
    });
    serde_json::from_value(spec).expect("a valid spec")
}

/// Of a core of the machine that the runs were on.
fn told(spec: &PaperTensile) -> f64 {
    let core = Calibration {
        bond_evaluations_per_s: 2.8e8,
    };
    spec.estimate(&core).wall_s
}

#[test]
fn pulls_of_large_sheets_take_about_what_is_told() {
    let beam = json!({});
    let taut = |strain: f64| json!({"level": "truss", "taut_strain": strain});
    // seconds of the processor: the example `scale`, to a tenth below the largest force
    for (length, precision, model, took) in [
        (1.0, 0.1, beam.clone(), 1.6),
        (1.0, 0.05, beam.clone(), 4.2),
        (2.0, 0.1, beam.clone(), 15.0),
        (3.4, 0.1, beam.clone(), 66.0),
        (10.0, 0.1, beam.clone(), 2130.0),
        (2.0, 0.1, taut(1e-5), 4.4),
        (2.0, 0.1, taut(1e-4), 4.1),
        (10.0, 0.1, taut(1e-4), 500.0),
        (2.0, 0.1, json!({"level": "truss"}), 52.0),
    ] {
        let told = told(&sheet(length, precision, model.clone()));
        let range = took / FACTOR..took * FACTOR;
        assert!(
            range.contains(&told),
            "{length} mm, {precision}, {model}: {told} s beside {took} s"
        );
    }
}

#[test]
fn a_finer_precision_and_looser_bars_are_told_to_take_longer() {
    let of = |precision: f64, strain: f64| {
        told(&sheet(
            5.0,
            precision,
            json!({"level": "truss", "taut_strain": strain}),
        ))
    };
    assert!(of(0.05, 1e-4) > 2.0 * of(0.1, 1e-4));
    assert!(of(0.1, 1e-5) > 1.2 * of(0.1, 1e-4));
    assert!(
        of(0.1, 1e-6) > 2.0 * of(0.1, 1e-5),
        "loose bars take thousands of iterations"
    );
    assert!(of(0.0, 1e-4) > 5.0 * of(0.05, 1e-4), "one by one");
}

#[test]
fn factors_of_groups_have_about_the_entries_that_are_told() {
    let truss = |strain: f64| json!({"level": "truss", "taut_strain": strain});
    for (model, unknowns, had) in [
        (json!({}), 332_154.0, 2_501_856.0),
        (json!({}), 1_309_200.0, 14_990_292.0),
        (truss(1e-4), 166_077.0, 268_560.0),
        (truss(1e-4), 654_600.0, 1_752_876.0),
    ] {
        let told = iterated_entries(&sheet(2.0, 0.1, model), unknowns);
        let range = had / FACTOR..had * FACTOR;
        assert!(range.contains(&told), "{unknowns}: {told} beside {had}");
    }
}
