//! Breaks of one solution beside breaks one by one.
use super::super::together::together;
use super::*;

/// Round-off of a direct solution of some hundred unknowns.
const ROUND_OFF: f64 = 1e-9;
const PRECISION: f64 = 0.05;

/// Lap joints side by side, each with two bonds of these shear strengths [mN].
fn joints(strengths: &[[f64; 2]]) -> Network {
    let mut fibres = Vec::new();
    let mut bonds = Vec::new();
    for (row, strengths) in strengths.iter().enumerate() {
        let (y, first) = (100.0 * row as f64, 2 * row as u32);
        fibres.push(fibre(&[[0.0, y, 0.0], [120.0, y, 0.0]]));
        fibres.push(fibre(&[[40.0, y, 0.0], [160.0, y, 0.0]]));
        for (x, strength) in [50.0, 110.0].into_iter().zip(*strengths) {
            bonds.push(FrameBond {
                shear_strength_mn: Some(strength),
                stiffness_mn_per_um3: 1.0,
                ..bond([first, first + 1], [x, x - 40.0])
            });
        }
    }
    Network::new(&fibres, &bonds, model(Level::Beam, 160.0)).unwrap()
}

/// The bonds that break with each solution, and what was measured.
fn pulled(network: &Network, break_precision: f64) -> (Vec<Vec<usize>>, PullMeasures) {
    let test = PullTest {
        max_strain: 0.5,
        stop_force_fraction: 0.0,
        break_precision,
    };
    let mut pull = Pull::new(network, test).unwrap();
    let mut rounds = Vec::new();
    while let Step::Broke(events) = pull.advance().unwrap() {
        let bonds = events.iter().map(|event| match event.broken {
            Broken::Bond(bond) => bond,
            Broken::Segment(segment) => panic!("segment {segment} broke"),
        });
        // equally loaded ones come in the order of round-off
        let mut bonds: Vec<usize> = bonds.collect();
        bonds.sort_unstable();
        rounds.push(bonds);
    }
    (rounds, pull.state().measures)
}

#[test]
fn what_has_no_fibre_in_common_breaks_in_one_round_at_loads_that_are_larger_by_the_precision() {
    // the bonds of a joint share its force evenly, and are stiff beside the fibres: when the first has gone,
    // the second bears nearly twice as much, more than its 1.2 or 1.5 times the strength
    let network = joints(&[[1.0, 1.2], [1.0, 1.5], [6.0, 6.0]]);
    let (one_by_one, exact) = pulled(&network, 0.0);
    assert_eq!(one_by_one.len(), 6);
    let (rounds, measures) = pulled(&network, PRECISION);
    assert_eq!(rounds[..2], [vec![0, 2], vec![1, 3]]);
    for (found, expected, power) in [
        (measures.peak_force_mn, exact.peak_force_mn, 1),
        (measures.strain_at_peak, exact.strain_at_peak, 1),
        (measures.work_to_peak_nj, exact.work_to_peak_nj, 2),
        (measures.work_nj, exact.work_nj, 2),
        (measures.released_nj, exact.released_nj, 2),
    ] {
        close(found, (1.0 + PRECISION).powi(power) * expected, ROUND_OFF);
    }
}

#[test]
fn a_few_that_are_over_their_strength_wait_where_many_have_broken_and_the_next_is_near() {
    // alone, the second bond of a joint bears some 1.64: of 1.5 it is over that by more than the precision
    let pulled = |joints_of_many: usize, second: f64, of_one: f64| {
        let mut strengths = vec![[1.0, second]; joints_of_many];
        strengths.push([1.0, of_one]);
        let (rounds, measures) = pulled(&joints(&strengths), PRECISION);
        let rounds: Vec<usize> = rounds.iter().map(Vec::len).collect();
        (rounds, measures.work_nj)
    };
    let (rounds, work) = pulled(400, 1.6, 1.5);
    assert_eq!(rounds, [401, 401]);
    // it breaks at the elongation at which the others would without it
    let (rounds, without) = pulled(400, 1.6, 1.6);
    assert_eq!(rounds, [401, 401]);
    close(work, without, ROUND_OFF);
    // too few have broken for one to wait: all that is at its strength breaks with it, at the elongation of before
    let (rounds, at_once) = pulled(300, 1.6, 1.5);
    assert_eq!(rounds, [301, 301]);
    assert!(at_once / 301.0 < 0.99 * work / 401.0, "{at_once} {work}");
    // the next is over its strength by the precision at nearly four times the elongation only
    assert_eq!(pulled(400, 6.0, 1.5).0, [401, 1, 400]);
}

#[test]
fn what_shares_a_fibre_with_something_more_overloaded_waits() {
    // all five are overloaded once the outermost have gone, and go in pairs from outside
    let fibres = [
        fibre(&[[0.0; 3], [150.0, 0.0, 0.0]]),
        fibre(&[[50.0, 0.0, 0.0], [200.0, 0.0, 0.0]]),
    ];
    let bonds = [60.0, 80.0, 100.0, 120.0, 140.0].map(|x| FrameBond {
        shear_strength_mn: Some(1.0),
        stiffness_mn_per_um3: 1.0,
        ..bond([0, 1], [x, x - 50.0])
    });
    let network = Network::new(&fibres, &bonds, model(Level::Beam, 200.0)).unwrap();
    let (rounds, _) = pulled(&network, PRECISION);
    assert_eq!(rounds, [vec![0, 4], vec![1, 3], vec![2]]);
}

#[test]
fn parts_wait_by_fibres_and_by_the_precision() {
    let network = joints(&[[1.0; 2]; 3]);
    let bond = |bond: usize| network.segments() + bond;
    let broken = |indices: [f64; 6]| -> Vec<usize> {
        let indices: Vec<(usize, f64)> = (0..6).map(|at| (bond(at), indices[at])).collect();
        let parts = together(&network, &indices, PRECISION);
        parts.iter().map(|part| part - bond(0)).collect()
    };
    // what is over its strength, or short of it by a quarter of the precision, and no more
    assert_eq!(broken([1.04, 0.99, 0.987, 0.3, 0.988, 0.0]), [0, 1, 4]);
    // overloaded: of each joint the more overloaded, and what is within the precision of it
    assert_eq!(broken([2.0, 1.5, 1.2, 1.15, 0.99, 0.5]), [0, 2, 3, 4]);
}
