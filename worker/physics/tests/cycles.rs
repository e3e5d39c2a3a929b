//! Loading and unloading: what a network takes, gives back and keeps, against what can be written down.
mod scene;

use loadframe_api::spec::nonwoven_tensile::{
    Block, Bond, Breaking, Jaw, NetworkBond, NonwovenTensile, StrengthDraw, Target,
};
use loadframe_physics::{Ending, Interrupt, Uninterrupted};
use scene::{
    AtLook, Record, bond, explicit, finished, polyester, run, run_with, suspended_again_and_again,
    value,
};

/// To what a force is found, of the largest so far.
const FORCE_PRECISION: f64 = 1e-5;
/// A break is found to this part of its strength, and what follows from its strain with it.
const BREAK_PRECISION: f64 = 1e-6;
/// N mm in J.
const J: f64 = 1e-3;

fn linear(modulus: f64) -> Bond {
    Bond {
        modulus_n: Some(modulus),
        friction_modulus_n: 0.0,
        compression_stiffness_n: 0.0,
        mean_strength_n: None,
        strength_sigma: 0.0,
        strength_draw: StrengthDraw::LogNormal,
    }
}

/// Bonds side by side between jaws 10 mm apart, each with its rest length [mm] and strength [N].
fn bundle(law: Bond, bonds: &[(f64, f64)]) -> NonwovenTensile {
    let mut nodes = Vec::new();
    let mut given = Vec::new();
    for (number, (rest_length, strength)) in bonds.iter().enumerate() {
        let x = number as f64;
        nodes.push(([x, 0.0, 0.0], Jaw::Bottom));
        nodes.push(([x, 10.0, 0.0], Jaw::Top));
        given.push(NetworkBond {
            rest_length_mm: Some(*rest_length),
            strength_n: Some(*strength),
            ..bond(2 * number as u32, 2 * number as u32 + 1)
        });
    }
    let mut spec = explicit(&nodes, given, law);
    spec.test.breaking = Breaking::AllOverStrength;
    let mut knobs = spec.accuracy.knobs();
    knobs.break_precision = Some(BREAK_PRECISION);
    spec.accuracy = loadframe_api::spec::nonwoven_tensile::Accuracy::Knobs(knobs);
    spec
}

fn cycles(to: Target, back_to: Target, repetitions: u32) -> Vec<Block> {
    vec![Block {
        to,
        back_to: Some(back_to),
        repetitions,
    }]
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found}, expected {expected}"
    );
}

fn has_warning(report: &loadframe_api::Report, code: &str) -> bool {
    report.warnings.iter().any(|warning| warning.code == code)
}

#[test]
fn a_bond_that_lives_comes_back_on_the_line_it_went() {
    // T = 2 u + 3 u², up to 0.25 and back to 0.1 N, where u = (√(4 + 12 · 0.1) − 2)/6
    let law = Bond {
        modulus_n: Some(2.0),
        friction_modulus_n: 3.0,
        ..linear(2.0)
    };
    let mut spec = bundle(law, &[(10.0, 100.0)]);
    spec.test.history = cycles(Target::Strain(0.25), Target::ForceN(0.1), 2);
    let (report, record) = run(&spec);
    assert_eq!(report.stop_reason, "history_finished");
    let strains = record.column("nominal_strain");
    for (strain, force) in strains.iter().zip(record.column("force_n")) {
        assert_near(force, 2.0 * strain + 3.0 * strain * strain, 1e-13, "force");
    }
    let largest = 2.0 * 0.25 + 3.0 * 0.0625;
    let end = ((4.0_f64 + 12.0 * 0.1).sqrt() - 2.0) / 6.0;
    let table = record.table("loops.csv");
    assert_eq!(table.len(), 2);
    for row in &table {
        assert_near(row[1], 0.25, 0.0, "largest strain");
        assert_near(row[2], largest, 1e-13, "largest force");
        // dF/du is at least 2
        assert_near(row[3], end, FORCE_PRECISION * largest / 2.0, "end strain");
        assert!(row[5].is_nan(), "there is force left: {}", row[5]);
    }
    // l₀ (e u² / 2 + f_r u³ / 3) of the first pull; the trapezoidal rule over steps h adds
    // l₀ · 2 f_r h² u / 12
    let energy = 10.0 * (0.0625 + 0.015_625);
    assert_near(
        table[0][7],
        J * energy,
        J * 10.0 * 6.0 * 1e-4 * 0.25 / 12.0 + 1e-12,
        "loaded",
    );
    assert_near(
        table[1][9],
        0.0,
        1e-5 * J * energy,
        "the second loop is closed",
    );
    assert_near(table[0][10], 0.0, 0.0, "nothing broke");
    assert!(report.quality["unaccounted_energy"].ok);
    // the time goes on while the jaw comes back, at 100 mm/min both ways
    let machine = record.table("curve_machine.csv");
    assert!(machine.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    let way = 10.0 * (0.25 + 3.0 * (0.25 - end));
    let last = machine.last().expect("a row");
    assert_near(last[0], way / (100.0 / 60.0), 1e-4, "time");
}

#[test]
fn what_a_loop_takes_is_what_was_in_the_bond_that_broke() {
    // two bonds of 10 N side by side, one breaks at 1 N, u = 0.1: loaded
    // 10 mm · (½ · 20 · 0.1² + ½ · 10 · (0.2² − 0.1²)) = 2.5 N mm, recovered 10 · ½ · 10 · 0.2² = 2,
    // the difference is 10 · ½ · 10 · 0.1² of the broken bond
    let mut spec = bundle(linear(10.0), &[(10.0, 1.0), (10.0, 100.0)]);
    spec.test.history = cycles(Target::Strain(0.2), Target::ForceN(0.0), 2);
    let (report, record) = run(&spec);
    let table = record.table("loops.csv");
    let tolerance = 10.0 * BREAK_PRECISION * J;
    assert_near(table[0][7], 2.5 * J, tolerance, "loaded");
    assert_near(table[0][8], 2.0 * J, tolerance, "recovered");
    assert_near(table[0][9], 0.5 * J, tolerance, "dissipated");
    assert_near(table[0][10], 0.5 * J, tolerance, "released");
    assert_near(table[0][12], 1.0, 0.0, "broken bonds");
    assert_near(table[1][9], 0.0, tolerance, "the second loop is closed");
    assert_near(table[1][12], 0.0, 0.0, "nothing breaks twice");
    assert_near(
        value(&report, "energy_loaded"),
        4.5 * J,
        tolerance,
        "loaded",
    );
    assert_near(
        value(&report, "energy_dissipated"),
        0.5 * J,
        tolerance,
        "dissipated",
    );
    // 2 N at 0.2 from the start, 10 N either way; and 20 N until the first bond breaks
    for name in ["first_cycle_stiffness", "last_cycle_stiffness"] {
        assert_near(value(&report, name), 10.0, 1e-9, name);
    }
    assert_near(
        value(&report, "residual_strain"),
        0.0,
        1e-5,
        "residual strain",
    );
    assert_near(value(&report, "cycles"), 2.0, 0.0, "cycles");
}

#[test]
fn a_long_bond_that_is_left_alone_leaves_a_strain() {
    // the short bond breaks at u = 0.1; the long one, of 10.5 mm, is slack below 5 % strain
    let mut spec = bundle(linear(10.0), &[(10.0, 1.0), (10.5, 100.0)]);
    spec.test.history = cycles(Target::Strain(0.2), Target::ForceN(0.0), 1);
    let (report, _) = run(&spec);
    // 1e-5 of 10 · (12 − 10.5)/10.5 N at a slope of 10 · 10/10.5 N
    assert_near(
        value(&report, "residual_strain"),
        0.05,
        2e-6,
        "residual strain",
    );
    // to no strain it comes slack, and the strain is where the force went
    spec.test.history = cycles(Target::Strain(0.2), Target::Strain(0.0), 1);
    let (report, record) = run(&spec);
    assert_near(
        value(&report, "residual_strain"),
        0.05,
        1e-9,
        "residual strain",
    );
    assert_near(record.table("loops.csv")[0][3], 0.0, 0.0, "end strain");
}

#[test]
fn forces_are_targets_on_both_ways_and_in_blocks() {
    let mut spec = polyester(7, 9, 2);
    spec.test.strain_step = 0.05;
    let [low, mid, high] = [4.0, 10.0, 20.0];
    spec.test.history = cycles(Target::ForceN(mid), Target::ForceN(low), 2);
    spec.test.history.push(Block {
        to: Target::ForceN(high),
        back_to: None,
        repetitions: 1,
    });
    let (report, record) = run(&spec);
    assert_eq!(report.stop_reason, "history_finished");
    let table = record.table("loops.csv");
    for (row, [to, back]) in table.iter().zip([[mid, low], [mid, low], [high, high]]) {
        assert_near(row[2], to, FORCE_PRECISION * to, "pulled to");
        assert_near(row[4], back, FORCE_PRECISION * mid.max(back), "back to");
    }
    assert_eq!(table.len(), 3);
    assert!(
        has_warning(&report, "maximum_at_end"),
        "{:?}",
        report.warnings
    );
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );
    // the curve says which branch a point is of
    let unloading = record.column("unloading");
    let strains = record.column("nominal_strain");
    let cycle = record.column("cycle");
    for row in 1..strains.len() {
        if (cycle[row] - cycle[row - 1]).abs() < 0.5 && unloading[row] > 0.5 {
            assert!(strains[row] < strains[row - 1], "row {row}");
        }
    }
    assert!(cycle.last().is_some_and(|last| *last > 2.5));
}

#[test]
fn a_force_that_the_fabric_does_not_reach_is_told() {
    let mut spec = polyester(7, 9, 2);
    spec.test.strain_step = 0.05;
    spec.test.max_strain = 0.3;
    spec.test.history = cycles(Target::ForceN(1e3), Target::ForceN(0.0), 1);
    let (report, _) = run(&spec);
    assert_eq!(report.stop_reason, "max_strain");
    assert!(
        has_warning(&report, "history_not_finished"),
        "{:?}",
        report.warnings
    );
    spec.test.max_strain = 3.0;
    let (report, record) = run(&spec);
    assert!(["force_dropped", "no_load_path"].contains(&report.stop_reason.as_str()));
    assert!(has_warning(&report, "history_not_finished"));
    assert_near(value(&report, "cycles"), 0.0, 0.0, "cycles");
    assert!(
        record.table("loops.csv")[0][8].is_nan(),
        "nothing came back"
    );
}

/// Cycles in which bonds break, to rupture.
fn torn_in_cycles() -> NonwovenTensile {
    let mut spec = polyester(7, 9, 2);
    spec.test.strain_step = 0.05;
    spec.output.snapshot_every_steps = 8;
    spec.test.history = cycles(Target::Strain(0.8), Target::ForceN(0.5), 2);
    spec.test
        .history
        .extend(cycles(Target::ForceN(30.0), Target::ForceN(0.0), 1));
    spec.test.history.push(Block {
        to: Target::Strain(3.0),
        back_to: None,
        repetitions: 1,
    });
    spec
}

#[test]
fn energy_is_accounted_for_until_the_fabric_parts() {
    let (report, record) = run(&torn_in_cycles());
    assert_eq!(report.stop_reason, "no_load_path");
    assert!(
        report.quality["unaccounted_energy"].ok,
        "{:?}",
        report.quality
    );
    let table = record.table("loops.csv");
    for row in &table[..3] {
        // loaded = recovered + released + kept, but for steps and solver
        let rest = row[7] - row[8] - row[10] - row[11];
        assert!(rest.abs() < 0.01 * row[7], "{row:?}");
    }
    // a cycle to the same strain breaks hardly anything more
    assert!(table[1][9] < 0.1 * table[0][9] + 1e-9, "{table:?}");
}

#[test]
fn a_monotone_history_is_the_pull_without_one() {
    let mut spec = polyester(7, 9, 2);
    spec.test.strain_step = 0.05;
    let (_, plain) = run(&spec);
    spec.test.history.push(Block {
        to: Target::Strain(spec.test.max_strain),
        back_to: None,
        repetitions: 1,
    });
    let (_, history) = run(&spec);
    for name in [
        "nominal_strain",
        "force_n",
        "broken_bonds",
        "stored_energy_n_mm",
    ] {
        assert_eq!(plain.column(name), history.column(name), "{name}");
    }
    for name in ["events.csv", "breaking_by_strain.csv", "force_drops.csv"] {
        assert_eq!(plain.files[name], history.files[name], "{name}");
    }
}

#[test]
fn a_run_suspended_within_a_cycle_leaves_the_same_bytes() {
    let spec = torn_in_cycles();
    let expected = run(&spec);
    for looks in [2, 7] {
        scene::assert_same(&expected, &suspended_again_and_again(&spec, looks, 1));
    }
    scene::assert_same(&expected, &suspended_again_and_again(&spec, 20, 2));
}

#[test]
fn a_cycle_is_cancelled_like_a_pull() {
    let mut record = Record::default();
    let interrupt = AtLook::new(Interrupt::Cancel, 40);
    let ending = run_with(&torn_in_cycles(), &mut record, &interrupt, None, 1);
    assert!(matches!(ending, Ending::Cancelled));
    let again = run_with(&torn_in_cycles(), &mut record, &Uninterrupted, None, 1);
    assert!(finished(again).summary.contains_key("residual_strain"));
}

#[test]
fn repeats_have_means_of_what_their_loops_are() {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.05;
    spec.test.repeats = 3;
    spec.test.history = cycles(Target::Strain(0.9), Target::ForceN(0.0), 1);
    let (report, record) = run(&spec);
    let dissipated = &report.summary["energy_dissipated"];
    assert_eq!(dissipated.n, Some(3));
    assert!(
        dissipated
            .deviation
            .is_some_and(|deviation| deviation > 0.0)
    );
    let curves = String::from_utf8_lossy(&record.files["repeats_curves.csv"]).into_owned();
    let header = curves.lines().next();
    assert_eq!(
        header,
        Some("repeat,nominal_strain,force_n,cycle,unloading")
    );
}
