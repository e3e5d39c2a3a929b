//! Bars that are taut, and what that holds.
use std::sync::Arc;

use loadframe_api::spec::paper_tensile::equilibrium::{LEAST_PRECISION, LEAST_TAUT};
use loadframe_numerics::Team;

use super::sheets::{SMALL, Scatter};
use super::*;

const STRAIN: f64 = 1e-4;

/// Small enough for many iterations without optimisation, flat and of short fibres: a mechanism but for its tension.
const FLAT: Scatter = Scatter {
    size_um: [400.0, 200.0],
    fibres: 20,
    fibre_length_um: 300.0,
    ..SMALL
};

fn inside(strain: f64) -> Network {
    let (fibres, bonds) = FLAT.sheet();
    let model = FrameModel {
        attachment: Attachment::Inside,
        segment_um: Some(60.0),
        ..model(Level::Truss, 400.0)
    };
    let network = Network::new(&fibres, &bonds, model).unwrap();
    network.with_taut_bars(strain).unwrap()
}

#[test]
fn a_taut_string_gives_way_across_as_its_tension_says() {
    // two bars between jaws, pushed at their middle: F = 2 (T/l) u with the tension T = E A ε
    let (half, push) = (100.0, 1e-3);
    let fibre = fibre(&[[0.0; 3], [half, 0.0, 0.0], [2.0 * half, 0.0, 0.0]]);
    let network = Network::new(&[fibre], &[], model(Level::Truss, 2.0 * half)).unwrap();
    let network = network.with_taut_bars(STRAIN).unwrap();
    let middle = network.nearest_node(0, half);
    let load = NodeLoad {
        node: middle,
        force_mn: [0.0, push, 0.0],
        moment_mn_um: [0.0; 3],
    };
    let rest = network.rest(0.0, &[load]).unwrap();
    let section = tube();
    let tension = STRAIN * section.youngs_modulus_gpa * section.area_um2;
    let expected = push * half / (2.0 * tension);
    close(rest.displacement_um[middle][1], expected, ROUND_OFF);
}

#[test]
fn only_bars_are_taut_and_by_little() {
    let of = |level| {
        Network::new(
            &[fibre(&[[0.0; 3], [100.0, 0.0, 0.0]])],
            &[],
            model(level, 100.0),
        )
    };
    let beams = of(Level::Beam).unwrap().with_taut_bars(STRAIN);
    assert_eq!(beams.unwrap_err(), FrameError::Taut);
    for strain in [0.0, 0.5e-9, 0.011, f64::NAN] {
        let refused = of(Level::Truss)
            .unwrap()
            .with_taut_bars(strain)
            .unwrap_err();
        let text = refused.to_string();
        assert!(
            text.contains("taut") && text.contains("1e-9 to 0.01"),
            "{text}"
        );
    }
}

/// The first bonds that break, until `rounds` solutions, and the force after them.
fn pulled(strain: f64, break_precision: f64, rounds: usize) -> (Vec<Broken>, f64, PullCost) {
    let network = inside(strain);
    let test = PullTest {
        break_precision,
        max_strain: 0.5,
        stop_force_fraction: 0.0,
    };
    let mut pull = Pull::new(&network, test).unwrap();
    let mut broken = Vec::new();
    for _ in 0..rounds {
        if let Step::Broke(events) = pull.advance().unwrap() {
            broken.extend(events.iter().map(|event| event.broken));
        }
    }
    (broken, pull.jaw_force_mn()[1], pull.cost())
}

#[test]
fn groups_find_what_a_factor_of_all_does() {
    // a hair below the strain from which on groups serve there is a factor of all
    let [grouped, factored] =
        [LEAST_TAUT, 0.999_999 * LEAST_TAUT].map(|strain| pulled(strain, 0.05, 2));
    assert!(grouped.2.stored < factored.2.stored / 4, "another road");
    assert_eq!(grouped.0, factored.0);
    // indices are known to half a per cent
    close(grouped.1, factored.1, 5e-3);
}

#[test]
fn rests_that_must_be_exact_have_a_factor_of_all_however_taut_bars_are() {
    let least = LEAST_PRECISION;
    let of = |precision| pulled(1e-4, precision, 1).2.stored;
    let [exact, finer, near] = [0.0, 0.999_999 * least, least].map(of);
    assert_eq!(exact, finer);
    assert!(exact > 4 * near);
}

#[test]
fn what_a_factor_of_all_finds_at_once_is_known() {
    // its first iterations do nearly all, so that what they moved tells of no error
    for strain in [1e-9, 1e-5, 1e-2] {
        let network = inside(strain);
        let test = PullTest {
            break_precision: 0.0,
            max_strain: 0.5,
            stop_force_fraction: 0.5,
        };
        let mut pull = Pull::new(&network, test).unwrap();
        pull.run().unwrap();
        let measures = pull.state().measures;
        assert!(measures.broken_bonds > 3, "{measures:?}");
        let error = measures.largest_index_error.unwrap();
        assert!(error <= 1e-6, "taut by {strain}: {error}");
    }
}

#[test]
fn the_more_bars_are_taut_the_stiffer_is_the_sheet_and_the_fewer_are_iterations() {
    let test = PullTest {
        // where a rest may be as far off as for 0.1, a sheet so small takes next to none
        break_precision: 0.01,
        max_strain: 0.5,
        stop_force_fraction: 0.9,
    };
    let found = [1e-5, 1e-4, 1e-3].map(|strain| {
        let network = inside(strain);
        let pull = Pull::new(&network, test).unwrap();
        (
            pull.state().measures.initial_stiffness_mn,
            pull.cost().iterations,
        )
    });
    for pair in found.windows(2) {
        assert!(pair[1].0 > pair[0].0 && pair[1].1 < pair[0].1, "{found:?}");
    }
}

#[test]
fn a_taut_truss_is_pulled_to_the_same_bits_on_any_number_of_threads_and_after_a_stop() {
    let network = inside(1e-5);
    let test = PullTest {
        break_precision: 0.1,
        max_strain: 0.5,
        stop_force_fraction: 0.9,
    };
    let pull = |threads, state| {
        let means = Means {
            team: Arc::new(Team::new(threads).unwrap()),
            ..Means::default()
        };
        Pull::resume(&network, test, state, &means).unwrap()
    };
    let (whole, _) = pull(1, PullState::default()).run().unwrap();
    let (shared, _) = pull(2, PullState::default()).run().unwrap();
    assert!(!whole.is_empty());
    assert_eq!(whole, shared);
    let mut first = pull(1, PullState::default());
    let Step::Broke(mut events) = first.advance().unwrap() else {
        panic!("something breaks");
    };
    events.extend(pull(2, first.state().clone()).run().unwrap().0);
    assert_eq!(events, whole);
}
