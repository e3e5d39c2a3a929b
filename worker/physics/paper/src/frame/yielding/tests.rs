//! Fibres that yield against closed forms.
use super::super::tests::{bond, close, fibre, model, tube};
use super::super::{
    Bore, Broken, FrameBond, FrameError, FrameFibre, Level, Means, Network, Pull, PullEnd,
    PullState, PullTest, Pulling, Step, Yielding, pull, run,
};

/// Round-off of a direct solution of a few hundred unknowns whose stiffnesses differ by 1e4.
const ROUND_OFF: f64 = 1e-9;

const E: f64 = 30.0;

fn to(max_strain: f64) -> PullTest {
    PullTest {
        max_strain,
        stop_force_fraction: 0.0,
        break_precision: 0.0,
    }
}

fn area() -> f64 {
    tube().area_um2
}

fn yielding(points: &[[f64; 3]], stress_gpa: f64, hardening_modulus_gpa: f64) -> FrameFibre {
    let mut made = fibre(points);
    made.section.yielding = Some(Yielding {
        stress_gpa,
        hardening_modulus_gpa,
    });
    made
}

fn started<'n>(network: &'n Network, test: PullTest) -> Box<dyn Pulling + 'n> {
    pull(network, test, PullState::default(), &Means::default()).unwrap()
}

#[test]
fn a_bar_goes_along_two_lines_and_unloads_along_the_first() {
    let (stress, slope, strain) = (0.3, 3.0, 0.05);
    // however it is cut, and at an angle to no axis of its own
    for (level, segment_um) in [
        (Level::Beam, None),
        (Level::Truss, None),
        (Level::Beam, Some(9.0)),
    ] {
        let bar = yielding(&[[0.0; 3], [100.0, 0.0, 0.0]], stress, slope);
        let model = super::super::FrameModel {
            segment_um,
            ..model(level, 100.0)
        };
        let network = Network::new(&[bar], &[], model).unwrap();
        let mut pull = started(&network, to(strain));
        let (events, end) = run(pull.as_mut()).unwrap();
        assert!(events.is_empty() && end == PullEnd::MaxStrain);
        let carried = stress + slope * (strain - stress / E);
        close(pull.jaw_force_mn()[1], carried * area(), ROUND_OFF);
        let lasting = strain - carried / E;
        close(
            pull.residual_elongation_um().unwrap(),
            100.0 * lasting,
            ROUND_OFF,
        );
        let measures = pull.state().measures;
        // trapezia under both lines
        let work = 0.5 * stress * stress / E + 0.5 * (stress + carried) * (strain - stress / E);
        let volume = 100.0 * area();
        close(measures.work_nj, work * volume, ROUND_OFF);
        close(
            measures.stored_nj,
            0.5 * carried * carried / E * volume,
            ROUND_OFF,
        );
        // Y α + H α²/2 with 1/H = 1/Eₜ - 1/E
        let hardening = 1.0 / (1.0 / slope - 1.0 / E);
        let lost = stress * lasting + 0.5 * hardening * lasting * lasting;
        close(measures.dissipated_nj, lost * volume, ROUND_OFF);
        assert!(measures.energy_error() < ROUND_OFF);
        close(measures.yielded_share_at_peak, 1.0, ROUND_OFF);
        close(measures.initial_stiffness_mn, E * area(), ROUND_OFF);
    }
}

#[test]
fn a_bar_that_yields_breaks_at_its_strength_or_over_it_by_the_precision() {
    for break_precision in [0.0, 0.1] {
        let mut bar = yielding(&[[0.0; 3], [100.0, 0.0, 0.0]], 0.3, 3.0);
        bar.section.strength_gpa = Some(0.4);
        let network = Network::new(&[bar], &[], model(Level::Beam, 100.0)).unwrap();
        let test = PullTest {
            break_precision,
            ..to(0.5)
        };
        let mut pull = started(&network, test);
        let (events, end) = run(pull.as_mut()).unwrap();
        assert_eq!((events.len(), end), (1, PullEnd::Parted));
        let at = 0.4 * (1.0 + break_precision);
        close(events[0].strain, 0.3 / E + (at - 0.3) / 3.0, ROUND_OFF);
        close(events[0].force_before_mn, at * area(), ROUND_OFF);
        let Bore::Segment { stress_gpa } = events[0].bore else {
            panic!("a segment broke");
        };
        close(stress_gpa, at, ROUND_OFF);
        // the elastic part is set free, the rest is lost
        let elastic = 0.5 * at * at / E * 100.0 * area();
        close(events[0].energy_released_nj, elastic, ROUND_OFF);
        assert!(pull.state().measures.energy_error() < ROUND_OFF);
        assert!(pull.is_broken(Broken::Segment(0)));
    }
}

#[test]
fn two_bars_side_by_side_yield_one_after_the_other() {
    let bars = [
        yielding(&[[0.0; 3], [100.0, 0.0, 0.0]], 0.2, 1.0),
        yielding(&[[0.0, 50.0, 0.0], [100.0, 50.0, 0.0]], 0.4, 2.0),
    ];
    let network = Network::new(&bars, &[], model(Level::Beam, 100.0)).unwrap();
    let law = |strain: f64, stress: f64, slope: f64| {
        let elastic = E * strain;
        elastic.min(stress + slope * (strain - stress / E))
    };
    for strain in [0.005, 0.01, 0.012, 0.03] {
        let mut pull = started(&network, to(strain));
        run(pull.as_mut()).unwrap();
        let expected = (law(strain, 0.2, 1.0) + law(strain, 0.4, 2.0)) * area();
        close(pull.jaw_force_mn()[1], expected, ROUND_OFF);
        assert!(pull.state().measures.energy_error() < ROUND_OFF);
    }
}

#[test]
fn a_lap_yields_and_then_its_bond_shears() {
    let (stress, slope) = (0.01, 0.6);
    let fibres = [
        yielding(&[[0.0; 3], [60.0, 0.0, 0.0]], stress, slope),
        yielding(&[[40.0, 0.0, 0.0], [100.0, 0.0, 0.0]], stress, slope),
    ];
    let strength = 4.0;
    let joint = FrameBond {
        shear_strength_mn: Some(strength),
        normal_strength_mn: Some(1.0),
        ..bond([0, 1], [50.0, 10.0])
    };
    let network = Network::new(&fibres, &[joint], model(Level::Beam, 100.0)).unwrap();
    let mut pull = started(&network, to(0.5));
    let (events, end) = run(pull.as_mut()).unwrap();
    assert_eq!((events.len(), end), (1, PullEnd::Parted));
    // 50 µm of each fibre, and the bond between
    let carried = strength / area();
    let strain = stress / E + (carried - stress) / slope;
    let elongation = 100.0 * strain + strength / (0.01 * 400.0);
    close(events[0].elongation_um, elongation, ROUND_OFF);
    let measures = pull.state().measures;
    let elastic = 0.5 * strength * (100.0 * carried / E + strength / 4.0);
    close(events[0].energy_released_nj, elastic, ROUND_OFF);
    close(measures.released_nj, elastic, ROUND_OFF);
    let lost = 0.5 * (stress + carried) * (strain - carried / E) * 100.0 * area();
    close(measures.dissipated_nj, lost, ROUND_OFF);
    close(measures.work_to_peak_nj, elastic + lost, ROUND_OFF);
    assert!(measures.energy_error() < ROUND_OFF);
}

/// One fibre from the left, two beside one another from the right, all along one line: the first bond to
/// break unloads the fibre that flowed, which flows again only where it had come to.
#[test]
fn a_break_unloads_elastically_and_the_next_yield_is_where_the_last_ended() {
    let (stress, slope) = (0.01, 0.6);
    let fibres = [
        yielding(&[[0.0; 3], [80.0, 0.0, 0.0]], stress, slope),
        fibre(&[[80.0, 0.0, 0.0], [150.0, 0.0, 0.0]]),
        fibre(&[[80.0, 0.0, 0.0], [150.0, 0.0, 0.0]]),
    ];
    let strengths = [1.5, 3.5];
    let bonds = [1, 2].map(|other| FrameBond {
        shear_strength_mn: Some(strengths[other as usize - 1]),
        ..bond([0, other], [80.0, 0.0])
    });
    let network = Network::new(&fibres, &bonds, model(Level::Beam, 150.0)).unwrap();
    let mut pull = started(&network, to(0.5));
    let (events, _) = run(pull.as_mut()).unwrap();
    assert_eq!(events.len(), 2);
    let strain = |force: f64| {
        let carried = force / area();
        stress / E + (carried - stress) / slope
    };
    // both halves carry alike
    let branch = 1.0 / 4.0 + 70.0 / (E * area());
    let first = 80.0 * strain(3.0) + 1.5 * branch;
    close(events[0].elongation_um, first, ROUND_OFF);
    close(events[0].force_before_mn, 3.0, ROUND_OFF);
    // elastic from there, on one branch
    let lasting = 80.0 * (strain(3.0) - 3.0 / area() / E);
    let left = (first - lasting) / (80.0 / (E * area()) + branch);
    close(events[0].force_after_mn, left, ROUND_OFF);
    // back to 3 mN, and on along the second line
    let second = 80.0 * strain(3.5) + 3.5 * branch;
    close(events[1].elongation_um, second, ROUND_OFF);
    assert!(pull.state().measures.energy_error() < ROUND_OFF);
    // the work under four straight lines
    let yields_at = stress * area();
    let at = 80.0 * stress / E + 0.5 * yields_at * branch;
    let back = lasting + 3.0 * (80.0 / (E * area()) + branch);
    let work = 0.5 * yields_at * at
        + 0.5 * (yields_at + 3.0) * (first - at)
        + 0.5 * (left + 3.0) * (back - first)
        + 0.5 * (3.0 + 3.5) * (second - back);
    close(pull.state().measures.work_nj, work, ROUND_OFF);
}

#[test]
fn what_is_pushed_yields_too_and_hardens_for_both() {
    use super::law::{Law, Plastic};
    let section = yielding(&[[0.0; 3], [1.0, 0.0, 0.0]], 0.3, 3.0).section;
    let element = super::super::element::Element::segment(
        [0, 1],
        nalgebra::Vector3::x() * 100.0,
        &section,
        Level::Truss,
    );
    let law = Law::new(&section, &element).unwrap();
    let fresh = Plastic {
        longer_um: 0.0,
        hardened_um: 0.0,
        flows: false,
    };
    let pushed = law.reach(-2.0, fresh, false);
    let force = law.stiffness * (-2.0 - pushed.longer_um);
    close(force, -(0.3 + 3.0 * 0.01) * area(), ROUND_OFF);
    // pulled back: elastic through twice the limit
    let limit = law.limit(pushed.hardened_um);
    let again = -2.0 + 2.0 * limit / law.stiffness;
    assert!(!law.reach(again - 1e-6, pushed, false).flows);
    assert!(law.reach(again + 1e-6, pushed, false).flows);
}

#[test]
fn other_roads_refuse_fibres_that_yield() {
    let bar = yielding(&[[0.0; 3], [100.0, 0.0, 0.0]], 0.3, 3.0);
    let network = Network::new(&[bar], &[], model(Level::Beam, 100.0)).unwrap();
    let refused = Pull::new(&network, to(0.1)).unwrap_err();
    assert_eq!(refused, FrameError::Yields);
    assert_eq!(network.rest(1.0, &[]).unwrap_err(), FrameError::Yields);
    for (stress, slope) in [(0.0, 3.0), (0.3, 0.0), (0.3, 30.0), (f64::NAN, 3.0)] {
        let bar = yielding(&[[0.0; 3], [100.0, 0.0, 0.0]], stress, slope);
        let refused = Network::new(&[bar], &[], model(Level::Beam, 100.0)).unwrap_err();
        assert!(matches!(refused, FrameError::Value { .. }), "{refused}");
    }
}

/// A row of crossed fibres between two yielding ones: many segments that yield, bend and break.
fn woven(segment_um: Option<f64>) -> Network {
    let mut fibres = Vec::new();
    let mut bonds = Vec::new();
    for row in 0..4 {
        let y = 40.0 * f64::from(row);
        let rise = 25.0 * f64::from(row % 2);
        let mut made = yielding(&[[0.0, y, 0.0], [300.0, y + rise, 0.0]], 0.02, 1.0);
        made.section.strength_gpa = Some(0.05 + 0.01 * f64::from(row));
        fibres.push(made);
    }
    for column in 0..5 {
        let x = 40.0 + 50.0 * f64::from(column);
        fibres.push(yielding(
            &[[x, -20.0, 8.0], [x + 10.0, 170.0, 8.0]],
            0.02,
            1.0,
        ));
        for row in 0..4_u32 {
            let y = 40.0 * f64::from(row);
            let rise = 25.0 * f64::from(row % 2);
            let at = f64::hypot(x, x / 300.0 * rise);
            bonds.push(FrameBond {
                shear_strength_mn: Some(2.0 + 0.1 * f64::from(column)),
                normal_strength_mn: Some(2.0),
                ..bond([row, 4 + column as u32], [at, 20.0 + y + x / 300.0 * rise])
            });
        }
    }
    let model = super::super::FrameModel {
        segment_um,
        ..model(Level::Beam, 300.0)
    };
    Network::new(&fibres, &bonds, model).unwrap()
}

#[test]
fn work_is_stored_set_free_or_lost_and_more_events_change_nothing() {
    let mut forces = Vec::new();
    // cut finer, each segment yields by itself: more events on the same way
    for segment_um in [None, Some(30.0), Some(9.0)] {
        let network = woven(segment_um);
        let mut pull = started(&network, to(0.2));
        let (events, end) = run(pull.as_mut()).unwrap();
        let measures = pull.state().measures;
        assert!(events.len() > 4, "{}", events.len());
        assert_eq!(end, PullEnd::Parted);
        assert!(
            measures.energy_error() < ROUND_OFF,
            "{}",
            measures.energy_error()
        );
        assert!(measures.dissipated_nj > 0.1 * measures.work_nj);
        assert!(measures.largest_jaw_imbalance < 1e-8);
        assert!(
            events
                .iter()
                .all(|event| event.energy_released_nj > -1e-9 * measures.work_nj)
        );
        forces.push((
            measures.peak_force_mn,
            measures.strain_at_peak,
            measures.work_nj,
        ));
    }
    for (force, strain, work) in &forces[1..] {
        close(*force, forces[0].0, 1e-8);
        close(*strain, forces[0].1, 1e-8);
        close(*work, forces[0].2, 1e-8);
    }
}

#[test]
fn a_pull_that_yields_goes_on_from_any_state_to_the_same_bits() {
    let network = woven(Some(30.0));
    let mut whole = started(&network, to(0.2));
    let mut states = vec![whole.state().clone()];
    loop {
        let step = whole.advance().unwrap();
        states.push(whole.state().clone());
        if let Step::Ended(_) = step {
            break;
        }
    }
    assert!(states.len() > 20);
    for from in (0..states.len()).step_by(7) {
        let mut again = pull(&network, to(0.2), states[from].clone(), &Means::default()).unwrap();
        for state in &states[from + 1..] {
            again.advance().unwrap();
            assert_eq!(again.state(), state);
        }
    }
}
