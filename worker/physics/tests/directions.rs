//! The same fabric pulled along both axes.
#![allow(clippy::float_cmp, reason = "copied numbers are exact")]
mod scene;

use loadframe_api::spec::nonwoven_tensile::{
    Breaking, Direction, Fabric, Jaw, Jaws, Network, NonwovenTensile, Solver,
};
use loadframe_physics::Uninterrupted;
use scene::{
    Record, array, assert_same, bond, finished, floats, lattice, polyester, run, run_with, solver,
    suspended_again_and_again, value,
};

/// Agreement at `force_accuracy` 1e10: forces are balanced to 1e-10 of a bond's, and a network of
/// some hundred bonds has waves about ten rows long.
const TIGHT: f64 = 1e-8;

fn both() -> NonwovenTensile {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.05;
    spec.test.directions = vec![Direction::Y, Direction::X];
    spec.output.snapshot_every_steps = 8;
    spec
}

fn along(direction: Direction, seed: u64) -> NonwovenTensile {
    let mut spec = both();
    spec.test.directions = vec![direction];
    spec.seed = seed;
    spec
}

#[test]
fn a_single_row_pulled_along_itself_is_a_chain_of_bonds() {
    let mut spec = polyester(9, 1, 1);
    lattice(&mut spec).irregularity = [0.0; 3];
    spec.test.directions = vec![Direction::X];
    spec.test.breaking = Breaking::None;
    (spec.test.strain_step, spec.test.max_strain) = (0.05, 0.5);
    spec.accuracy = solver(Solver::NewtonCg, 1e12);
    let (report, record) = run(&spec);
    let strains = record.column("nominal_strain");
    for (strain, force) in strains.iter().zip(record.column("force_n")) {
        // every bond has the nominal strain, and the row's force is the bond's: e u + f_r u²
        let expected = 0.399 * strain + 1.473 * strain * strain;
        assert!((force - expected).abs() <= 1e-11, "{force} {expected}");
    }
    // eight bonds between nine nodes, and one row of 20 mm to carry the force
    assert_eq!(
        (value(&report, "nodes"), value(&report, "bonds")),
        (9.0, 8.0)
    );
    let per_width = value(&report, "max_force") / 0.02;
    assert!((value(&report, "strength") - per_width).abs() < 1e-9 * per_width);
}

/// The lattice of `spec` as a snapshot shows it, without its jaws, x and y exchanged, the ends of
/// its rows held: an explicit network that knows nothing of how the engine turns a lattice.
fn turned_by_hand(spec: &NonwovenTensile) -> NonwovenTensile {
    let mut upright = spec.clone();
    upright.test.directions = vec![Direction::Y];
    upright.test.max_strain = upright.test.strain_step;
    upright.output.snapshot_every_steps = 1;
    let (_, record) = run(&upright);
    let file = &record.files["snapshots/step_00000.vtp"];
    let points: Vec<[f64; 3]> = floats(file, "Points")
        .chunks_exact(3)
        .map(|p| [p[1], p[0], p[2]])
        .collect();
    let sizes = lattice(&mut upright).clone();
    let jaw_points = match sizes.jaws {
        Jaws::HalfBond => 2 * sizes.points_per_row as usize,
        Jaws::ClampedRows => 0,
    };
    let inner = jaw_points..points.len() - jaw_points;
    let mut jaws = Vec::new();
    for row in 0..sizes.rows {
        let columns = sizes.points_per_row + row % 2;
        for _layer in 0..sizes.layers {
            jaws.push(Jaw::Bottom);
            jaws.extend((2..columns).map(|_| Jaw::Free));
            jaws.push(Jaw::Top);
        }
    }
    let connectivity = array(file, "connectivity");
    let number = |bytes: &[u8]| match *bytes {
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        _ => panic!("node numbers have four bytes"),
    };
    let ends: Vec<u32> = connectivity.chunks_exact(4).map(number).collect();
    let pairs = ends
        .chunks_exact(2)
        .map(|ends| [ends[0] as usize, ends[1] as usize]);
    let inside = pairs.filter(|ends| ends.iter().all(|node| inner.contains(node)));
    let bonds = inside.map(|ends| {
        let [first, second] = ends.map(|node| (node - jaw_points) as u32);
        bond(first, second)
    });
    let mut network = spec.clone();
    network.test.directions = vec![Direction::Y];
    network.fabric = Fabric::Network(Network {
        nodes_mm: points[inner.clone()].to_vec(),
        jaws,
        bonds: bonds.collect(),
        width_mm: Some(f64::from(sizes.rows) * sizes.spacing_mm[1]),
        thickness_mm: None,
        grammage_g_per_m2: None,
    });
    network
}

#[test]
fn along_x_is_the_same_network_given_turned() {
    let mut spec = polyester(6, 7, 2);
    lattice(&mut spec).spacing_mm = [20.0, 15.0, 10.0];
    // equal strengths, which a network given bond by bond draws as well
    spec.bond.strength_sigma = 0.0;
    spec.test.strain_step = 0.05;
    spec.test.directions = vec![Direction::X];
    spec.accuracy = solver(Solver::NewtonCg, 1e10);
    let (report, record) = run(&spec);
    let (by_hand, record_by_hand) = run(&turned_by_hand(&spec));
    assert!(value(&report, "broken_bonds") > 20.0);
    assert_eq!(
        value(&report, "broken_bonds"),
        value(&by_hand, "broken_bonds")
    );
    let scale = value(&by_hand, "max_force");
    for name in ["force_n", "force_bottom_jaw_n", "broken_bonds"] {
        let (found, expected) = (record.column(name), record_by_hand.column(name));
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!(
                (found - expected).abs() <= TIGHT * scale,
                "{name}: {found} {expected}"
            );
        }
    }
    for name in ["strength", "energy_absorption", "modulus_at_10_percent"] {
        let (found, expected) = (value(&report, name), value(&by_hand, name));
        assert!(
            (found - expected).abs() <= TIGHT * expected,
            "{name}: {found} {expected}"
        );
    }
}

#[test]
fn clamped_rows_are_whole_when_they_are_pulled() {
    // the upright lattice leaves out the bonds within its clamped rows; pulled along x they carry
    let mut spec = polyester(9, 3, 1);
    lattice(&mut spec).irregularity = [0.0; 3];
    lattice(&mut spec).jaws = Jaws::ClampedRows;
    spec.test.directions = vec![Direction::X];
    (spec.test.max_strain, spec.test.breaking) = (0.1, Breaking::None);
    spec.accuracy = solver(Solver::NewtonCg, 1e10);
    let (clamped, _) = run(&spec);
    lattice(&mut spec).jaws = Jaws::HalfBond;
    let (half_bond, _) = run(&spec);
    // without irregularity both are the same lattice, its bonds numbered in another order
    for name in ["nodes", "bonds", "modulus_at_10_percent", "poisson_ratio"] {
        let (found, expected) = (value(&clamped, name), value(&half_bond, name));
        assert!(
            (found - expected).abs() <= TIGHT * expected.abs(),
            "{name}: {found} {expected}"
        );
    }
}

#[test]
fn both_directions_are_the_tests_alone_and_their_ratios() {
    let (report, record) = run(&both());
    let (along_y, record_y) = run(&along(Direction::Y, 1));
    let (along_x, record_x) = run(&along(Direction::X, 1));
    for name in along_y.summary.keys() {
        assert_eq!(report.summary[name], along_y.summary[name]);
        let second = &report.summary[&format!("{name}_along_x")];
        assert_eq!(second.value, along_x.summary[name].value);
    }
    assert_ne!(along_y.summary["strength"], along_x.summary["strength"]);
    for name in [
        "strength",
        "strain_at_max_force",
        "modulus_at_10_percent",
        "poisson_ratio",
    ] {
        let ratio = value(&along_y, name) / value(&along_x, name);
        assert_eq!(value(&report, &format!("anisotropy_of_{name}")), ratio);
    }
    assert_eq!(record.points, record_y.points);
    assert_eq!(
        record.files.len(),
        record_y.files.len() + record_x.files.len()
    );
    for (folder, alone) in [("", &record_y), ("along_x/", &record_x)] {
        for (name, bytes) in &alone.files {
            assert!(
                *bytes == record.files[&format!("{folder}{name}")],
                "{folder}{name}"
            );
        }
    }
    assert!(record.fractions.is_sorted() && record.fractions.last() == Some(&1.0));
}

#[test]
fn repeats_compare_the_directions_of_each_specimen() {
    let mut spec = both();
    spec.test.repeats = 3;
    let (report, record) = run(&spec);
    let singles = [1, 2, 3]
        .map(|seed| [Direction::Y, Direction::X].map(|direction| run(&along(direction, seed))));
    let ratios = singles.each_ref().map(|[(along_y, _), (along_x, _)]| {
        value(along_y, "strength") / value(along_x, "strength")
    });
    let mean = ratios.iter().sum::<f64>() / 3.0;
    let ratio = &report.summary["anisotropy_of_strength"];
    assert!((value(&report, "anisotropy_of_strength") - mean).abs() < 1e-12);
    assert!(ratio.n == Some(3) && ratio.deviation > Some(0.0));
    for (index, [(_, along_y), (_, along_x)]) in singles.iter().enumerate() {
        for (name, alone) in [
            ("repeats_curves.csv", along_y),
            ("along_x/repeats_curves.csv", along_x),
        ] {
            let rows = record.table(name).into_iter();
            let curve = rows.filter(|row| row[0] == (index + 1) as f64);
            let forces: Vec<f64> = curve.map(|row| row[2]).collect();
            assert_eq!(forces, alone.column("force_n"));
        }
    }
    let header = String::from_utf8_lossy(&record.files["repeats.csv"]).into_owned();
    assert!(
        header.contains(",max_force_along_x_n,") && header.contains(",anisotropy_of_strength,")
    );
}

#[test]
fn threads_and_suspension_change_no_byte() {
    let mut spec = both();
    spec.test.repeats = 2;
    let expected = run(&spec);
    for threads in [2, 3, 8] {
        let mut record = Record::default();
        let report = finished(run_with(&spec, &mut record, &Uninterrupted, None, threads));
        assert_eq!(report.work, expected.0.work);
        assert_same(&expected, &(report, record));
    }
    for (looks, threads) in [(5, 1), (40, 1), (40, 2), (150, 3)] {
        assert_same(&expected, &suspended_again_and_again(&spec, looks, threads));
    }
}
