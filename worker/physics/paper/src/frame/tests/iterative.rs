//! Iterations beside a factor, and bonds inside segments beside bonds at nodes.
use std::sync::Arc;

use loadframe_numerics::Team;

use super::sheets::{SMALL, Scatter, TO_THE_END};
use super::*;

/// What iterations leave where nothing breaks: a share of 1e-9 of the motion, in energy.
const ITERATED: f64 = 1e-8;

/// Small enough for thousands of iterations without optimisation.
const TINY: Scatter = Scatter {
    size_um: [400.0, 200.0],
    fibres: 14,
    fibre_length_um: 300.0,
    ..SMALL
};

fn inside(level: Level, length_um: f64, segment_um: f64) -> FrameModel {
    FrameModel {
        attachment: Attachment::Inside,
        segment_um: Some(segment_um),
        ..model(level, length_um)
    }
}

fn iterative() -> Means {
    Means::by(Solver::Iterative)
}

#[test]
fn a_cantilever_with_its_load_between_nodes_bends_as_its_moments_say() {
    // two fibres from the jaw, side by side, one loaded through a bond at 0.3 of its only segment; the
    // work of the force is that of a cantilever that is loaded there if the interpolation is exact at
    // its nodes: beams have no error at nodes
    let (length, at) = (200.0, 60.0);
    let section = tube();
    let flexural = section.youngs_modulus_gpa * section.inertia_um4;
    let shear = section.shear_coefficient * section.shear_modulus_gpa * section.area_um2;
    let fibres = [
        fibre(&[[0.0; 3], [length, 0.0, 0.0]]),
        fibre(&[[at, 0.0, 0.0], [at, 50.0, 0.0]]),
    ];
    let joint = FrameBond {
        // too soft against turning to carry a moment
        area_um2: 1.0,
        stiffness_mn_per_um3: 1.0,
        ..bond([0, 1], [at, 0.0])
    };
    let network = Network::new(&fibres, &[joint], inside(Level::Beam, 1e4, 1e3)).unwrap();
    let load = NodeLoad {
        node: network.nearest_node(1, 0.0),
        force_mn: [0.0, 0.0, 1e-3],
        moment_mn_um: [0.0; 3],
    };
    let rest = network.rest_by(0.0, &[load], &iterative()).unwrap();
    let tip = network.nearest_node(0, length);
    let expected = 1e-3 * (at * at * (3.0 * length - at) / (6.0 * flexural) + at / shear);
    close(rest.displacement_um[tip][2], expected, ITERATED);
}

#[test]
fn a_straight_fibre_bonded_inside_segments_is_exact_under_uniform_strain() {
    // the second fibre is held by nothing but bonds, evenly strained by the first: no force in any bond
    // when both ends of it go along
    let fibres = [
        fibre(&[[0.0; 3], [400.0, 0.0, 0.0]]),
        fibre(&[[0.0, 0.0, 5.0], [400.0, 0.0, 5.0]]),
    ];
    let bonds: Vec<FrameBond> = [33.0, 120.0, 171.0, 290.0, 355.0]
        .map(|x| bond([0, 1], [x, x]))
        .into();
    for level in [Level::Beam, Level::Truss] {
        for segment_um in [130.0, 400.0] {
            let network = Network::new(&fibres, &bonds, inside(level, 400.0, segment_um)).unwrap();
            let rest = network.rest_by(4.0, &[], &iterative()).unwrap();
            let section = tube();
            let force = 2.0 * section.youngs_modulus_gpa * section.area_um2 * 0.01;
            close(rest.jaw_force_mn[0], force, ITERATED);
            close(rest.jaw_force_mn[1], force, ITERATED);
            for node in 0..network.nodes() {
                let expected = 0.01 * network.position_um(node)[0];
                close(rest.displacement_um[node][0], expected, 1e-7);
            }
        }
    }
}

#[test]
fn shear_lag_inside_segments_tends_to_that_at_nodes_from_above() {
    let fibres = [
        fibre(&[[0.0; 3], [270.0, 0.0, 0.0]]),
        fibre(&[[40.0, 0.0, 0.0], [320.0, 0.0, 0.0]]),
    ];
    let bonds: Vec<FrameBond> = (0..9)
        .map(|i| 52.0 + 25.0 * f64::from(i))
        .map(|x| bond([0, 1], [x, x - 40.0]))
        .collect();
    for level in [Level::Beam, Level::Truss] {
        let force = |model: FrameModel| {
            let network = Network::new(&fibres, &bonds, model).unwrap();
            network
                .rest_by(1.0, &[], &iterative())
                .unwrap()
                .jaw_force_mn[1]
        };
        let exact = force(model(level, 320.0));
        let errors: Vec<f64> = [160.0, 80.0, 40.0, 20.0]
            .map(|segment| force(inside(level, 320.0, segment)) / exact - 1.0)
            .into();
        // the error falls with the square of a segment that holds several bonds, and as the segment where
        // bonds are farther apart than nodes, for strain jumps at bonds
        assert!(errors[0] < 0.04 && errors[3] > 0.0, "{errors:?}");
        let ratios: Vec<f64> = errors.windows(2).map(|pair| pair[0] / pair[1]).collect();
        assert!(ratios[0] > 3.5, "{ratios:?}");
        assert!(ratios.iter().all(|ratio| *ratio > 2.0), "{ratios:?}");
    }
}

#[test]
fn iterations_find_what_a_factor_finds() {
    let network = TINY.network(Level::Beam, None);
    let direct = network.rest(1.0, &[]).unwrap();
    let found = network.rest_by(1.0, &[], &iterative()).unwrap();
    close(found.jaw_force_mn[1], direct.jaw_force_mn[1], 1e-6);
    close(found.energy_nj, direct.energy_nj, 1e-9);
}

#[test]
fn a_pull_by_iterations_goes_on_to_the_same_bits_on_any_number_of_threads() {
    let (fibres, bonds) = TINY.sheet();
    let network = Network::new(&fibres, &bonds, inside(Level::Beam, 400.0, 60.0)).unwrap();
    let test = PullTest {
        break_precision: 0.1,
        max_strain: 0.5,
        stop_force_fraction: 0.9,
    };
    let on = |threads| Means {
        motion: None,
        solver: Solver::ByCost,
        team: Arc::new(Team::new(threads).unwrap()),
    };
    let pull = |threads, state| Pull::resume(&network, test, state, &on(threads)).unwrap();
    let (whole, _) = pull(1, PullState::default()).run().unwrap();
    let (shared, _) = pull(2, PullState::default()).run().unwrap();
    assert_eq!(whole, shared);
    let mut first = pull(1, PullState::default());
    let mut events = Vec::new();
    for _ in 0..2 {
        if let Step::Broke(broke) = first.advance().unwrap() {
            events.extend(broke);
        }
    }
    let mut second = pull(2, first.state().clone());
    events.extend(second.run().unwrap().0);
    assert_eq!(events, whole);
}

#[test]
fn parts_break_together_within_the_precision_and_the_energy_is_kept() {
    let network = TINY.network(Level::Beam, None);
    let run = |break_precision, means: &Means| {
        let test = PullTest {
            break_precision,
            ..TO_THE_END
        };
        let mut pull = Pull::resume(&network, test, PullState::default(), means).unwrap();
        let mut batches = Vec::new();
        while let Step::Broke(events) = pull.advance().unwrap() {
            batches.push(events);
        }
        (batches, pull.state().measures)
    };
    let (one_by_one, exact) = run(0.0, &Means::default());
    assert!(one_by_one.iter().all(|batch| batch.len() == 1));
    let (batches, measures) = run(0.2, &Means::default());
    assert!(batches.len() < one_by_one.len() && batches.iter().any(|batch| batch.len() > 1));
    assert!(measures.energy_error() < 1e-8, "{measures:?}");
    // the first break, late by the precision, is the peak
    close(measures.peak_force_mn, 1.2 * exact.peak_force_mn, 1e-9);
    let (fibres, bonds) = TINY.sheet();
    for event in batches.iter().flatten() {
        let index = match event.bore {
            Bore::Bond {
                normal_mn,
                shear_mn,
            } => {
                let Broken::Bond(bond) = event.broken else {
                    panic!("a bond");
                };
                let strength = bonds[bond].normal_strength_mn.unwrap();
                normal_mn.max(0.0).hypot(shear_mn) / strength
            }
            Bore::Segment { stress_gpa } => stress_gpa / fibres[0].section.strength_gpa.unwrap(),
        };
        assert!(index >= 1.0 - 0.05 - 1e-12, "{index}");
    }
    // iterations break the same together, up to where little is left
    let mut pull = Pull::resume(
        &network,
        PullTest {
            break_precision: 0.2,
            ..TO_THE_END
        },
        PullState::default(),
        &iterative(),
    )
    .unwrap();
    let mut iterated = Vec::new();
    while let (true, Step::Broke(events)) = (iterated.len() < 2, pull.advance().unwrap()) {
        iterated.push(events);
    }
    let parts = |batches: &[Vec<Event>]| -> Vec<Vec<Broken>> {
        let of = |batch: &Vec<Event>| batch.iter().map(|event| event.broken).collect();
        batches.iter().map(of).collect()
    };
    assert_eq!(parts(&iterated)[..2], parts(&batches)[..2]);
}

#[test]
fn what_knows_no_points_between_nodes_refuses_them() {
    let (fibres, bonds) = TINY.sheet();
    let network = Network::new(&fibres, &bonds, inside(Level::Beam, 400.0, 60.0)).unwrap();
    let means = Means::by(Solver::Direct(Refactoring::ByCost));
    let refused = FrameError::Hanging;
    assert_eq!(network.rest_by(1.0, &[], &means).unwrap_err(), refused);
    assert_eq!(network.rest_at_large(1.0, &[], 1).unwrap_err(), refused);
}
