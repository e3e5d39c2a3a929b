//! The thesis' own descents: where they end, and where they cannot; and the landscape they go by.
mod scene;

use loadframe_api::spec::nonwoven_tensile::{
    Accuracy, Bond, Breaking, DescentGradient, Fabric, ForceLandscape, Jaw, Knobs, NetworkBond,
    NonwovenTensile, Solver, StrengthDraw,
};
use scene::{bond, explicit, polyester, run, value};

const DESCENTS: [Solver; 2] = [Solver::GradientDescent, Solver::BarzilaiBorwein];

fn set(spec: &mut NonwovenTensile, solver: Solver, gradient: DescentGradient) {
    spec.accuracy = Accuracy::Knobs(Knobs {
        solver,
        force_accuracy: 100.0,
        descent_gradient: gradient,
        iteration_limit: Some(100),
        ..spec.accuracy.knobs()
    });
}

/// Two linear bonds of 10 mm one above the other, of 1 N and of 3 N, pulled to 4 % in two steps.
fn two_in_series() -> NonwovenTensile {
    let nodes = [
        ([0.0, 0.0, 0.0], Jaw::Bottom),
        ([0.0, 10.0, 0.0], Jaw::Free),
        ([0.0, 20.0, 0.0], Jaw::Top),
    ];
    let of = |modulus, ends: NetworkBond| NetworkBond {
        modulus_n: Some(modulus),
        ..ends
    };
    let law = Bond {
        modulus_n: None,
        friction_modulus_n: 0.0,
        compression_stiffness_n: 1.0,
        mean_strength_n: None,
        strength_sigma: 0.0,
        strength_draw: StrengthDraw::LogNormal,
    };
    let mut spec = explicit(&nodes, vec![of(1.0, bond(0, 1)), of(3.0, bond(1, 2))], law);
    (spec.test.strain_step, spec.test.max_strain) = (0.02, 0.04);
    spec
}

fn set_spacing(spec: &mut NonwovenTensile, spacing: f64) {
    if let Accuracy::Knobs(knobs) = &mut spec.accuracy {
        knobs.smoothing_spacing = spacing;
    }
}

#[test]
fn a_fixed_step_balances_a_node_between_two_springs() {
    // 0.8 mm over compliances of 10 and 10/3 mm/N: 0.06 N in both
    for gradient in [DescentGradient::Exact, DescentGradient::Smoothed] {
        let mut spec = two_in_series();
        set(&mut spec, Solver::GradientDescent, gradient);
        set_spacing(&mut spec, 0.002);
        let (report, _) = run(&spec);
        assert!(report.quality["unconverged_steps"].ok, "{gradient:?}");
        // every resultant below (1 N · 0.04)/100
        let force = value(&report, "max_force");
        assert!((force - 0.06).abs() < 4e-4, "{gradient:?}: {force}");
    }
}

#[test]
fn smoothing_over_a_kink_moves_the_minimum() {
    // the bond of 3 N is strained by 2 %, and 0.4 mm up, where the farthest values are, pressed by as much:
    // there the law has another slope
    let mut spec = two_in_series();
    set(
        &mut spec,
        Solver::GradientDescent,
        DescentGradient::Smoothed,
    );
    set_spacing(&mut spec, 0.02);
    let (report, _) = run(&spec);
    assert!(!report.quality["unconverged_steps"].ok);
}

#[test]
fn on_a_cone_the_change_of_the_gradient_tells_no_step() {
    // |R| = 0.4 N/mm |y|: the gradient is the same until the tip is passed, and the step as long as is
    // allowed
    let mut spec = two_in_series();
    set(&mut spec, Solver::BarzilaiBorwein, DescentGradient::Exact);
    let (report, _) = run(&spec);
    assert!(!report.quality["unconverged_steps"].ok);
}

#[test]
fn the_printed_gradient_leads_away_from_balance_and_the_outcome_says_so() {
    // strained alike, the longer and softer bond pulls harder, 1 N to 0.9 N times the strain, but its
    // tension changes less with its length: 1/30 to 0.9/10 N/mm
    let mut spec = two_in_series();
    if let Fabric::Network(network) = &mut spec.fabric {
        network.nodes_mm = vec![[0.0, 0.0, 0.0], [0.0, 30.0, 0.0], [0.0, 40.0, 0.0]];
        network.bonds[1].modulus_n = Some(0.9);
    }
    set(
        &mut spec,
        Solver::GradientDescent,
        DescentGradient::AsPrinted,
    );
    let (report, _) = run(&spec);
    assert!(!report.quality["unconverged_steps"].ok);
    let codes: Vec<_> = report
        .warnings
        .iter()
        .map(|warning| &*warning.code)
        .collect();
    assert!(codes.contains(&"unconverged_steps"), "{codes:?}");
    set(&mut spec, Solver::GradientDescent, DescentGradient::Exact);
    let (report, _) = run(&spec);
    assert!(report.quality["unconverged_steps"].ok);
}

#[test]
fn a_step_that_is_too_long_jumps_from_side_to_side() {
    // |R| = k x with k = 0.4 N/mm has the slope k on both sides: jumps of α k = 4 mm
    let mut spec = two_in_series();
    set(&mut spec, Solver::GradientDescent, DescentGradient::Exact);
    if let Accuracy::Knobs(knobs) = &mut spec.accuracy {
        knobs.descent_step_mm2_per_n = Some(10.0);
    }
    let (report, _) = run(&spec);
    assert!(!report.quality["unconverged_steps"].ok);
}

#[test]
fn a_fixed_step_is_near_newton_in_a_fabric_and_what_is_not_balanced_is_told() {
    let mut spec = polyester(3, 5, 1);
    spec.test.breaking = Breaking::None;
    (spec.test.strain_step, spec.test.max_strain) = (0.05, 0.1);
    let (exact, _) = run(&spec);
    let expected = value(&exact, "max_force");
    for solver in DESCENTS {
        set(&mut spec, solver, DescentGradient::Exact);
        let (report, _) = run(&spec);
        let is_near = (value(&report, "max_force") / expected - 1.0).abs() < 0.1;
        let is_balanced = report.quality["unconverged_steps"].ok;
        // long waves stay, see the guide's table of solvers; the adaptive steps lead anywhere
        assert!(is_near || solver == Solver::BarzilaiBorwein, "{solver:?}");
        assert!(is_near || !is_balanced, "{solver:?}: wrong and silent");
    }
}

#[test]
fn the_landscape_of_a_node_is_a_cone_in_force_and_a_bowl_in_energy() {
    let mut spec = two_in_series();
    spec.output.force_landscape = Some(ForceLandscape {
        strain: 0.04,
        node: Some(1),
        half_width: 0.01,
        points: 5,
    });
    let (report, record) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let lines = record.table("force_landscape_lines.csv");
    assert_eq!(lines.len(), 5);
    for row in &lines {
        // along the bonds both laws are lines: |R| = (1 + 3)/10 |y|, E grows by half of that times y
        assert!((row[2] - 0.4 * row[0].abs()).abs() < 1e-12, "{row:?}");
        let energy = 10.0 * 0.06 * 0.06 * (1.0 + 1.0 / 3.0) / 2.0;
        assert!(
            (row[5] - energy - 0.2 * row[0] * row[0]).abs() < 1e-12,
            "{row:?}"
        );
    }
    assert_eq!(record.table("force_landscape.csv").len(), 25);
    let law = record.table("bond_law.csv");
    // the mean of 1 N and 3 N, and 1 N in compression
    for row in law {
        let slope = if row[0] < 0.0 { 1.0 } else { 2.0 };
        assert!((row[1] - slope * row[0]).abs() < 1e-12, "{row:?}");
    }
}

#[test]
fn a_landscape_that_is_not_reached_is_told() {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.05;
    spec.output.force_landscape = Some(ForceLandscape {
        strain: 2.9,
        node: None,
        half_width: 0.5,
        points: 3,
    });
    let (report, record) = run(&spec);
    let mut codes = report.warnings.iter().map(|warning| &*warning.code);
    assert!(codes.any(|code| code == "strain_not_reached"));
    assert!(!record.files.contains_key("bond_law.csv"));
}
