//! Networks whose forces can be written down.
#![allow(clippy::float_cmp, reason = "some results are exact")]
mod scene;

use loadframe_api::spec::nonwoven_tensile::{
    Accuracy, Bond, Breaking, Fabric, Jaw, Knobs, NetworkBond, NonwovenTensile, StrengthDraw,
};
use scene::{bond, explicit, run, value};

const LAW: Bond = Bond {
    modulus_n: Some(2.0),
    friction_modulus_n: 3.0,
    compression_stiffness_n: 0.5,
    mean_strength_n: None,
    strength_sigma: 0.0,
    strength_draw: StrengthDraw::LogNormal,
};
/// Forces follow from strains by a few operations, strains from displacements near round-off.
const NEAR_ROUND_OFF: f64 = 1e-13;

fn assert_close(found: f64, expected: f64) {
    let difference = (found - expected).abs();
    assert!(
        difference <= NEAR_ROUND_OFF * expected.abs().max(1.0),
        "{found} against {expected}"
    );
}

/// A network of bonds of [`LAW`], strained as far as that.
fn stretched(
    nodes: &[([f64; 3], Jaw)],
    bonds: Vec<NetworkBond>,
    max_strain: f64,
) -> NonwovenTensile {
    let mut spec = explicit(nodes, bonds, LAW);
    spec.test.max_strain = max_strain;
    spec
}

/// Tension of a bond of [`LAW`] at this strain [N].
fn equation_1(strain: f64) -> f64 {
    2.0 * strain + 3.0 * strain * strain
}

#[test]
fn a_single_bond_follows_equation_1_at_every_step() {
    let nodes = [([0.0; 3], Jaw::Bottom), ([0.0, 10.0, 0.0], Jaw::Top)];
    let spec = stretched(&nodes, vec![bond(0, 1)], 0.25);
    let (report, record) = run(&spec);
    let strains = record.column("nominal_strain");
    assert_eq!(strains.len(), 26);
    for (strain, force) in strains.iter().zip(record.column("force_n")) {
        assert_close(force, equation_1(*strain));
    }
    assert_eq!(
        record.column("force_n"),
        record.column("force_bottom_jaw_n")
    );
    assert_eq!(report.stop_reason, "max_strain");
    let expected = (2.0 * 0.1 + 3.0 * 0.01) / 0.1;
    assert_close(value(&report, "secant_stiffness_at_10_percent"), expected);
    // per width of 10 mm: N/mm in N/m
    assert_close(
        value(&report, "modulus_at_10_percent"),
        expected / 10.0 * 1e3,
    );
    assert_close(value(&report, "max_force"), 2.0 * 0.25 + 3.0 * 0.0625);
    assert_eq!(report.summary["poisson_ratio"].value, None);
}

#[test]
fn springs_in_series_share_the_force() {
    // linear bonds of 10, 20 and 30 mm with moduli 1, 2 and 3 N: compliances l₀/e of 10 mm/N each
    let nodes = [
        ([0.0, 0.0, 0.0], Jaw::Bottom),
        ([0.0, 10.0, 0.0], Jaw::Free),
        ([0.0, 30.0, 0.0], Jaw::Free),
        ([0.0, 60.0, 0.0], Jaw::Top),
    ];
    let with_modulus = |bond: NetworkBond, modulus| NetworkBond {
        modulus_n: Some(modulus),
        friction_modulus_n: Some(0.0),
        ..bond
    };
    let bonds = vec![
        with_modulus(bond(0, 1), 1.0),
        with_modulus(bond(1, 2), 2.0),
        with_modulus(bond(2, 3), 3.0),
    ];
    let mut spec = stretched(&nodes, bonds, 0.1);
    spec.output.snapshot_every_steps = 10;
    let (_, record) = run(&spec);
    for (strain, force) in record
        .column("nominal_strain")
        .iter()
        .zip(record.column("force_n"))
    {
        assert_close(force, strain * 60.0 / 30.0);
    }
    let strains = scene::floats(&record.files["snapshots/step_00010.vtp"], "strain");
    for (found, expected) in strains.iter().zip([0.2 / 1.0, 0.2 / 2.0, 0.2 / 3.0]) {
        assert_close(*found, expected);
    }
}

#[test]
fn bars_at_an_angle_pull_by_their_component() {
    // two bars from (±3, 0) to (0, 4), the tip pulled from 4 to 5: lengths 5 and √34
    let nodes = [
        ([-3.0, 0.0, 0.0], Jaw::Bottom),
        ([3.0, 0.0, 0.0], Jaw::Bottom),
        ([0.0, 4.0, 0.0], Jaw::Top),
    ];
    let mut spec = explicit(&nodes, vec![bond(0, 2), bond(2, 1)], LAW);
    (spec.test.strain_step, spec.test.max_strain) = (0.25, 0.25);
    let (_, record) = run(&spec);
    let strain = (34.0_f64.sqrt() - 5.0) / 5.0;
    let tension = equation_1(strain);
    let expected = 2.0 * tension * 5.0 / 34.0_f64.sqrt();
    // at rest, at 10 % where stiffness is read, and at the end
    assert_eq!(record.column("nominal_strain"), [0.0, 0.1, 0.25]);
    assert_close(record.column("force_n")[2], expected);
    assert_close(record.column("force_bottom_jaw_n")[2], expected);
    let energy = 2.0 * 5.0 * (2.0 * strain.powi(2) / 2.0 + 3.0 * strain.powi(3) / 3.0);
    assert_close(record.column("stored_energy_n_mm")[2], energy);
}

#[test]
fn a_cross_bar_is_compressed_as_the_sides_are_pulled_in() {
    // a rhombus: pulled at the tips, its cross bar takes r_c u in compression. By symmetry the
    // half width w solves 2 T(l) w/l = r_c (w₀ − w)/w₀ with l² = w² + h²
    let nodes = [
        ([0.0, 0.0, 0.0], Jaw::Bottom),
        ([-5.0, 5.0, 0.0], Jaw::Free),
        ([5.0, 5.0, 0.0], Jaw::Free),
        ([0.0, 10.0, 0.0], Jaw::Top),
    ];
    let sides = [[0, 1], [0, 2], [1, 3], [2, 3]].map(|[i, j]| bond(i, j));
    let bonds = sides.into_iter().chain([bond(1, 2)]).collect();
    let mut spec = explicit(&nodes, bonds, LAW);
    (spec.test.strain_step, spec.test.max_strain) = (0.02, 0.2);
    let (report, record) = run(&spec);
    let side = 50.0_f64.sqrt();
    let tension = |w: f64, h: f64| {
        let strain = (w.hypot(h) - side) / side;
        equation_1(strain)
    };
    let h = 6.0;
    let imbalance = |w: f64| 2.0 * tension(w, h) * w / w.hypot(h) - 0.5 * (5.0 - w) / 5.0;
    let (mut low, mut high) = (3.7, 5.0);
    while high - low > 1e-15 * high {
        let middle = 0.5 * (low + high);
        if imbalance(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
        if middle <= low && middle >= high {
            break;
        }
    }
    let expected = 2.0 * tension(low, h) * h / low.hypot(h);
    let force = *record.column("force_n").last().expect("there are points");
    assert_close(force, expected);
    assert_close(
        *record
            .column("width_strain")
            .last()
            .expect("there are points"),
        (low - 5.0) / 5.0,
    );
    assert!(report.quality["unconverged_steps"].ok);
}

#[test]
fn a_stretched_network_pulls_before_the_test_begins() {
    let nodes = [([0.0; 3], Jaw::Bottom), ([0.0, 10.0, 0.0], Jaw::Top)];
    let short = NetworkBond {
        rest_length_mm: Some(8.0),
        ..bond(0, 1)
    };
    let spec = stretched(&nodes, vec![short], 0.01);
    let (_, record) = run(&spec);
    assert_close(record.column("force_n")[0], 2.0 * 0.25 + 3.0 * 0.0625);
}

/// Two parallel bars of strengths 0.5 N and 0.8 N; T = 2 u reaches them at u = 0.25 and 0.4.
fn two_bars() -> loadframe_api::spec::nonwoven_tensile::NonwovenTensile {
    let nodes = [
        ([0.0, 0.0, 0.0], Jaw::Bottom),
        ([5.0, 0.0, 0.0], Jaw::Bottom),
        ([0.0, 10.0, 0.0], Jaw::Top),
        ([5.0, 10.0, 0.0], Jaw::Top),
    ];
    let strong = |bond: NetworkBond, strength| NetworkBond {
        friction_modulus_n: Some(0.0),
        strength_n: Some(strength),
        ..bond
    };
    let bonds = vec![strong(bond(0, 2), 0.5), strong(bond(1, 3), 0.8)];
    let mut spec = explicit(&nodes, bonds, LAW);
    spec.test.breaking = Breaking::AllOverStrength;
    spec.test.strain_step = 0.06;
    spec
}

#[test]
fn at_whole_steps_bonds_break_after_their_strength_and_the_curve_ends_without_load_path() {
    let mut spec = two_bars();
    spec.accuracy = Accuracy::Knobs(Knobs {
        break_precision: None,
        ..spec.accuracy.knobs()
    });
    let (report, record) = run(&spec);
    assert_eq!(report.stop_reason, "no_load_path");
    // the steps that first exceed 0.25 and 0.4 are 0.30 and 0.42
    let energy = |strain: f64| 10.0 * 2.0 * strain * strain / 2.0;
    let expected = [
        [5.0, 1.0, 0.3, 0.0, 2.0 * 0.3, energy(0.3)],
        [7.0, 1.0, 0.42, 1.0, 2.0 * 0.42, energy(0.42)],
    ];
    for (found, expected) in record.table("events.csv").iter().zip(expected) {
        for (found, expected) in found.iter().zip(expected) {
            assert_close(*found, expected);
        }
    }
    let forces = record.column("force_n");
    // the jaw rests between its steps to 0.06 and 0.12, at 10 % where stiffness is read
    assert_close(forces[2], 2.0 * 2.0 * 0.1);
    assert_close(forces[5], 2.0 * 2.0 * 0.24);
    assert_close(forces[6], 2.0 * 0.3);
    assert_eq!(forces[8..], [0.0]);
    assert_close(value(&report, "max_force"), 2.0 * 2.0 * 0.24);
    assert_close(value(&report, "strain_at_max_force"), 0.24);
    // area of the triangle under the force up to the maximum, over 10 mm x 10 mm
    let work = 0.5 * 0.96 * 0.24 * 10.0;
    assert_close(value(&report, "energy_absorption"), work / 100.0 * 1e3);
    assert_eq!(value(&report, "broken_bonds"), 2.0);
}

#[test]
fn bonds_break_at_their_strength_within_the_precision() {
    let (report, record) = run(&two_bars());
    assert_eq!(report.stop_reason, "no_load_path");
    let close = |found: f64, expected: f64| {
        let excess = found / expected - 1.0;
        assert!((0.0..=0.01).contains(&excess), "{found} against {expected}");
    };
    for (event, expected) in record.table("events.csv").iter().zip([0.25, 0.4]) {
        close(event[2], expected);
        close(event[4], 2.0 * expected);
    }
    close(value(&report, "max_force"), 2.0 * 2.0 * 0.25);
    close(value(&report, "strain_at_max_force"), 0.25);
}

#[test]
fn a_force_drop_ends_the_test_when_asked_to() {
    let mut spec = two_bars();
    spec.test.stop_force_fraction = 0.7;
    let (report, record) = run(&spec);
    assert_eq!(report.stop_reason, "force_dropped");
    // steps 0 to 4 and the reading at 10 %, before and after the first bar broke
    assert_eq!(record.points.len(), 8);
}

#[test]
fn the_last_step_ends_at_the_largest_strain() {
    let mut spec = two_bars();
    (spec.test.strain_step, spec.test.max_strain) = (0.1, 0.23);
    let (report, record) = run(&spec);
    assert_eq!(record.column("nominal_strain"), [0.0, 0.1, 0.2, 0.23]);
    assert_eq!(report.stop_reason, "max_strain");
    assert!(report.warnings.iter().any(|w| w.code == "maximum_at_end"));
    // 600 mm/min are 10 mm/s
    spec.test.speed_mm_per_min = 600.0;
    let machine = run(&spec).1.table("curve_machine.csv");
    assert_close(machine[3][0], 2.3 / 10.0);
    assert_close(machine[3][1], 2.3);
}

#[test]
fn parts_that_hang_on_one_jaw_carry_nothing_and_follow_it() {
    let nodes = [
        ([0.0, 0.0, 0.0], Jaw::Bottom),
        ([0.0, 10.0, 0.0], Jaw::Top),
        ([3.0, 8.0, 0.0], Jaw::Free),
        ([-3.0, 2.0, 0.0], Jaw::Free),
    ];
    let bonds = vec![bond(0, 1), bond(1, 2), bond(0, 3)];
    let mut spec = stretched(&nodes, bonds, 0.1);
    spec.output.snapshot_every_steps = 10;
    let (report, record) = run(&spec);
    assert_close(value(&report, "max_force"), 2.0 * 0.1 + 3.0 * 0.01);
    let moved = scene::floats(&record.files["snapshots/step_00010.vtp"], "displacement_mm");
    assert!((moved[3 * 2 + 1] - 1.0).abs() < 1e-6 && moved[3 * 3 + 1] == 0.0);
    assert!(report.warnings.iter().any(|w| w.code == "unloaded_bonds"));
}

#[test]
fn a_bond_of_nearly_no_length_is_strained_like_its_neighbour() {
    // the same tension in both, so the same strain: the way over the sum of the rest lengths
    for short in [1e-8, 1e-4] {
        let nodes = [
            ([0.0; 3], Jaw::Bottom),
            ([0.0, short, 0.0], Jaw::Free),
            ([0.0, 10.0, 0.0], Jaw::Top),
        ];
        let spec = stretched(&nodes, vec![bond(0, 1), bond(1, 2)], 0.2);
        let (report, record) = run(&spec);
        assert!(report.quality["unconverged_steps"].ok);
        for (strain, force) in record
            .column("nominal_strain")
            .iter()
            .zip(record.column("force_n"))
        {
            assert_close(force, equation_1(*strain));
        }
    }
}

#[test]
fn nodes_in_the_same_place_know_nothing_of_each_other() {
    let nodes = [
        ([0.0; 3], Jaw::Bottom),
        ([0.0, 5.0, 0.0], Jaw::Free),
        ([0.0, 5.0, 0.0], Jaw::Free),
        ([0.0, 10.0, 0.0], Jaw::Top),
    ];
    let bonds = vec![bond(0, 1), bond(1, 3), bond(0, 2), bond(2, 3)];
    let spec = stretched(&nodes, bonds, 0.1);
    let (report, _) = run(&spec);
    assert_close(value(&report, "max_force"), 2.0 * (2.0 * 0.1 + 3.0 * 0.01));
}

#[test]
fn an_island_stays_where_it_is_and_carries_nothing() {
    let nodes = [
        ([0.0; 3], Jaw::Bottom),
        ([0.0, 10.0, 0.0], Jaw::Top),
        ([5.0, 4.0, 0.0], Jaw::Free),
        ([7.0, 4.0, 0.0], Jaw::Free),
        ([6.0, 6.0, 0.0], Jaw::Free),
    ];
    let bonds = vec![bond(0, 1), bond(2, 3), bond(3, 4), bond(4, 2)];
    let mut spec = stretched(&nodes, bonds, 0.1);
    spec.output.snapshot_every_steps = 10;
    let (report, record) = run(&spec);
    assert_close(value(&report, "max_force"), 2.0 * 0.1 + 3.0 * 0.01);
    let moved = scene::floats(&record.files["snapshots/step_00010.vtp"], "displacement_mm");
    assert_eq!(moved[3 * 2..], [0.0; 9]);
}

#[test]
fn bonds_without_strength_part_at_the_first_step() {
    let mut spec = two_bars();
    if let Fabric::Network(network) = &mut spec.fabric {
        for bond in &mut network.bonds {
            bond.strength_n = Some(0.0);
        }
    }
    let (report, record) = run(&spec);
    assert_eq!(report.stop_reason, "no_load_path");
    assert_eq!(value(&report, "broken_bonds"), 2.0);
    let forces = record.column("force_n");
    assert!(forces.iter().all(|force| *force < 1e-10), "{forces:?}");
}

#[test]
fn steps_of_a_millionth_follow_equation_1_too() {
    let nodes = [
        ([0.0; 3], Jaw::Bottom),
        ([0.0, 3.0, 0.0], Jaw::Free),
        ([0.0, 10.0, 0.0], Jaw::Top),
    ];
    let mut spec = explicit(&nodes, vec![bond(0, 1), bond(1, 2)], LAW);
    (spec.test.strain_step, spec.test.max_strain) = (1e-6, 1e-5);
    let (_, record) = run(&spec);
    let forces = record.column("force_n");
    assert_eq!(forces.len(), 11);
    for (step, force) in forces.iter().enumerate() {
        let strain = 1e-6 * step as f64;
        // rounding of places of 10 mm
        assert!((force - equation_1(strain)).abs() < 1e-15);
    }
}
