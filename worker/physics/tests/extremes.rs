//! Specs at the edge of what the solvers are asked to do: 15 x 17 x 3, one change at a time.
#![allow(clippy::float_cmp, reason = "some results are exact")]
mod scene;

use loadframe_api::spec::nonwoven_tensile::{NonwovenTensile, Solver};
use scene::{floats, lattice, polyester, run, solver};

fn extremes() -> Vec<(&'static str, NonwovenTensile)> {
    let changed = |change: &dyn Fn(&mut NonwovenTensile)| {
        let mut spec = polyester(15, 17, 3);
        change(&mut spec);
        spec
    };
    let compression = |r_c: f64| changed(&|spec| spec.bond.compression_stiffness_n = r_c);
    let scatter = |sigma: f64| changed(&|spec| spec.bond.strength_sigma = sigma);
    let friction = |f_r: f64| changed(&|spec| spec.bond.friction_modulus_n = f_r);
    let step = |step: f64| changed(&|spec| spec.test.strain_step = step);
    let thin = |irregularity: [f64; 3]| {
        changed(&|spec| {
            lattice(spec).layers = 1;
            lattice(spec).irregularity = irregularity;
        })
    };
    vec![
        ("as it is", changed(&|_| ())),
        ("nearly floppy", compression(1e-6)),
        ("floppy", compression(0.0)),
        ("stiff in compression", compression(10.0)),
        ("250 times as stiff in compression", compression(100.0)),
        ("equal strengths", scatter(0.0)),
        ("very unequal strengths", scatter(2.0)),
        ("linear", friction(0.0)),
        ("strongly stiffening", friction(1000.0)),
        (
            "short bonds",
            changed(&|spec| lattice(spec).irregularity = [1.0; 3]),
        ),
        ("large steps", step(0.1)),
        ("huge steps", step(0.5)),
        ("flat", thin([0.5, 0.5, 0.0])),
        ("one rough layer", thin([0.5; 3])),
        ("one layer of short bonds", thin([1.0; 3])),
    ]
}

#[test]
fn newton_reaches_every_equilibrium_up_to_rupture() {
    for (name, spec) in extremes() {
        let (report, record) = run(&spec);
        assert!(report.quality["unconverged_steps"].ok, "{name}");
        assert!(report.quality["largest_residual_ratio"].ok, "{name}");
        let is_torn = ["no_load_path", "force_dropped"].contains(&report.stop_reason.as_str());
        // without the stiffening term the strongest bonds reach their strength beyond 300 %
        assert!(
            is_torn || name == "linear",
            "{name}: {}",
            report.stop_reason
        );
        if report.stop_reason == "no_load_path" {
            let last = record.points.last().expect("there are points");
            assert_eq!(last[1..3], [0.0, 0.0], "{name}: force without load path");
        }
        let broken = record.column("broken_bonds");
        assert!(broken.is_sorted(), "{name}: bonds healed");
    }
}

#[test]
fn a_net_without_compression_is_balanced_to_the_last_digit() {
    for accuracy in [1e4, 1e12] {
        let mut spec = polyester(15, 17, 3);
        spec.bond.compression_stiffness_n = 0.0;
        // the first steps are the hard ones: hardly anything is taut
        spec.test.max_strain = 0.05;
        spec.accuracy = solver(Solver::NewtonCg, accuracy);
        let (report, _) = run(&spec);
        assert!(report.quality["unconverged_steps"].ok, "{accuracy:e}");
    }
}

#[test]
fn a_net_with_hardly_any_compression_is_balanced() {
    // of the order of the force limit: neither nothing nor enough to brace the net
    for (stiffness, accuracy) in [(1e-5, 1e3), (1e-6, 1e4), (1e-6, 1e6)] {
        let mut spec = polyester(15, 17, 3);
        spec.bond.compression_stiffness_n = stiffness;
        spec.test.max_strain = 0.02;
        spec.accuracy = solver(Solver::NewtonCg, accuracy);
        let (report, _) = run(&spec);
        let is_balanced = report.quality["unconverged_steps"].ok;
        assert!(is_balanced, "{stiffness:e} {accuracy:e}");
    }
}

#[test]
fn relaxations_are_balanced_or_say_that_they_are_not() {
    let is_quick = |name: &str| ["huge steps", "flat", "one layer of short bonds"].contains(&name);
    for method in [Solver::Sequential, Solver::Parallel] {
        for (name, mut spec) in extremes() {
            if !is_quick(name) {
                continue;
            }
            spec.accuracy = solver(method, 100.0);
            let (report, record) = run(&spec);
            let ratios = record.column("residual_ratio");
            let beyond = ratios.iter().filter(|ratio| **ratio > 1.0).count();
            let unconverged = report.quality["unconverged_steps"].value;
            assert_eq!(beyond as f64, unconverged, "{method:?} {name}");
            let warned = report
                .warnings
                .iter()
                .any(|w| w.code == "unconverged_steps");
            assert_eq!(warned, beyond > 0, "{method:?} {name}");
        }
    }
}

#[test]
fn a_search_cut_short_is_reported() {
    let mut spec = polyester(15, 17, 3);
    spec.test.max_strain = 0.02;
    let mut knobs = spec.accuracy.knobs();
    knobs.iteration_limit = Some(1);
    for method in [Solver::NewtonCg, Solver::Sequential, Solver::Parallel] {
        knobs.solver = method;
        spec.accuracy = loadframe_api::spec::nonwoven_tensile::Accuracy::Knobs(knobs.clone());
        let (report, record) = run(&spec);
        assert_eq!(report.quality["unconverged_steps"].value, 2.0, "{method:?}");
        assert!(
            record.column("residual_ratio")[1..]
                .iter()
                .all(|ratio| *ratio > 1.0)
        );
        assert!(
            report
                .warnings
                .iter()
                .any(|w| w.code == "unconverged_steps")
        );
    }
}

#[test]
fn a_flat_network_stays_exactly_flat() {
    for method in [Solver::NewtonCg, Solver::Sequential, Solver::Parallel] {
        let (_, mut spec) = extremes().swap_remove(12);
        spec.output.snapshot_every_steps = 1;
        spec.test.max_strain = 0.2;
        spec.accuracy = solver(method, 100.0);
        let (_, record) = run(&spec);
        let displacements = floats(&record.files["snapshots/step_00020.vtp"], "displacement_mm");
        assert!(displacements.iter().any(|value| *value != 0.0));
        assert!(displacements.chunks(3).all(|moved| moved[2] == 0.0));
    }
}
