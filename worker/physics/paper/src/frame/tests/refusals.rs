//! Bad input, and what is said about it.
use super::*;

fn refused(fibres: &[FrameFibre], bonds: &[FrameBond], model: FrameModel) -> String {
    Network::new(fibres, bonds, model).unwrap_err().to_string()
}

#[test]
fn every_wrong_value_is_named() {
    let good = || {
        vec![
            fibre(&[[0.0; 3], [60.0, 0.0, 0.0]]),
            fibre(&[[40.0, 0.0, 0.0], [100.0, 0.0, 0.0]]),
        ]
    };
    let usual = model(Level::Beam, 100.0);
    let joint = bond([0, 1], [50.0, 10.0]);
    let with = |change: fn(&mut FrameFibre)| {
        let mut fibres = good();
        change(&mut fibres[1]);
        refused(&fibres, &[joint], usual)
    };
    let cases = [
        (
            refused(&good(), &[joint], model(Level::Beam, -1.0)),
            "distance of the jaws [um] is -1, allowed is above 0",
        ),
        (
            refused(
                &good(),
                &[joint],
                FrameModel {
                    segment_um: Some(0.0),
                    ..usual
                },
            ),
            "longest segment [um] is 0, allowed is above 0",
        ),
        (
            with(|fibre| fibre.section.shear_modulus_gpa = 0.0),
            "shear modulus [GPa] of fibre 1 is 0, allowed is above 0",
        ),
        (
            with(|fibre| fibre.section.strength_gpa = Some(f64::NAN)),
            "strength [GPa] of fibre 1 is NaN, allowed is above 0",
        ),
        (
            with(|fibre| fibre.centre_line_um.truncate(1)),
            "fibre 1 has 1 points, allowed are 2 or more",
        ),
        (
            with(|fibre| fibre.centre_line_um.push([100.0, 0.0, 0.0])),
            "points 1 and 2 of fibre 1 are in one place",
        ),
        (
            with(|fibre| fibre.centre_line_um[0][1] = f64::INFINITY),
            "coordinate [um] of point 0 of fibre 1 is inf, allowed is finite",
        ),
        (
            refused(
                &good(),
                &[FrameBond {
                    area_um2: 0.0,
                    ..joint
                }],
                usual,
            ),
            "area [um2] of bond 0 is 0, allowed is above 0",
        ),
        (
            refused(
                &good(),
                &[FrameBond {
                    shear_strength_mn: Some(-2.0),
                    ..joint
                }],
                usual,
            ),
            "shear strength [mN] of bond 0 is -2, allowed is 0 or above, or none",
        ),
        (
            refused(&good(), &[joint, bond([0, 2], [1.0, 1.0])], usual),
            "bond 1 joins fibre 2, but there are 2 fibres",
        ),
        (
            refused(&good(), &[bond([0, 1], [61.0, 1.0])], usual),
            "bond 0 lies 61 um from the start of fibre 0, which is 60 um long",
        ),
        (
            refused(&good(), &[bond([1, 1], [5.0, 5.0])], usual),
            "bond 0 joins a point of fibre 1 with itself",
        ),
    ];
    for (found, expected) in cases {
        assert_eq!(found, expected);
    }
}

#[test]
fn tests_and_states_that_do_not_fit_are_refused() {
    let fibres = [fibre(&[[0.0; 3], [100.0, 0.0, 0.0]])];
    let network = Network::new(&fibres, &[], model(Level::Beam, 100.0)).unwrap();
    let usual = PullTest {
        max_strain: 0.1,
        stop_force_fraction: 0.3,
        break_precision: 0.0,
    };
    let refused = |test| Pull::new(&network, test).unwrap_err().to_string();
    let flat = PullTest {
        max_strain: 0.0,
        ..usual
    };
    assert_eq!(refused(flat), "largest strain is 0, allowed is above 0");
    let whole = PullTest {
        stop_force_fraction: 1.0,
        ..usual
    };
    assert_eq!(
        refused(whole),
        "force fraction is 1, allowed is 0 to below 1"
    );
    let all = PullTest {
        break_precision: 1.0,
        ..usual
    };
    assert_eq!(
        refused(all),
        "break precision is 1, allowed is 0 to below 1"
    );
    let mut foreign = PullState::default();
    foreign.taken.push(7);
    let error = Pull::resume(&network, usual, foreign, &Means::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the state to go on from names element 7, but the network has 1"
    );
}
