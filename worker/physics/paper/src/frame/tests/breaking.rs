//! Breaks whose order and forces are known by hand.
use super::*;

const TO_THE_END: PullTest = PullTest {
    max_strain: 0.5,
    stop_force_fraction: 0.0,
    break_precision: 0.0,
};

/// Three lap joints side by side, with bonds of these shear strengths [mN].
fn three_joints(strengths: [f64; 3]) -> (Vec<FrameFibre>, Vec<FrameBond>) {
    let mut fibres = Vec::new();
    let mut bonds = Vec::new();
    for (row, strength) in strengths.into_iter().enumerate() {
        let y = 100.0 * row as f64;
        fibres.push(fibre(&[[0.0, y, 0.0], [60.0, y, 0.0]]));
        fibres.push(fibre(&[[40.0, y, 0.0], [100.0, y, 0.0]]));
        bonds.push(FrameBond {
            shear_strength_mn: Some(strength),
            normal_strength_mn: Some(1.0),
            ..bond([2 * row as u32, 2 * row as u32 + 1], [50.0, 10.0])
        });
    }
    (fibres, bonds)
}

/// Stiffness of one of these joints [mN/µm].
fn joint_stiffness() -> f64 {
    let axial = tube().youngs_modulus_gpa * tube().area_um2;
    1.0 / (100.0 / axial + 1.0 / (0.01 * 400.0))
}

#[test]
fn three_joints_break_by_their_strengths() {
    let (fibres, bonds) = three_joints([2.0, 3.0, 1.0]);
    let stiffness = joint_stiffness();
    for level in [Level::Beam, Level::Truss] {
        let network = Network::new(&fibres, &bonds, model(level, 100.0)).unwrap();
        let mut pull = Pull::new(&network, TO_THE_END).unwrap();
        let (events, end) = pull.run().unwrap();
        assert_eq!(end, PullEnd::Parted);
        let order: Vec<Broken> = events.iter().map(|event| event.broken).collect();
        assert_eq!(order, [Broken::Bond(2), Broken::Bond(0), Broken::Bond(1)]);
        // at 1, 2, 3 mN of each joint that is left: 3 x 1, 2 x 2, 1 x 3
        for (index, (force, left)) in [(3.0, 2.0), (4.0, 2.0), (3.0, 0.0)].into_iter().enumerate() {
            let event = &events[index];
            let strength = (index + 1) as f64;
            close(event.elongation_um, strength / stiffness, ROUND_OFF);
            close(event.force_before_mn, force, ROUND_OFF);
            assert!((event.force_after_mn - left).abs() < ROUND_OFF);
            close(
                event.energy_released_nj,
                0.5 * strength * strength / stiffness,
                ROUND_OFF,
            );
            assert_eq!(event.avalanche, index as u32 + 1);
        }
        let measures = pull.state().measures;
        close(measures.peak_force_mn, 4.0, ROUND_OFF);
        close(measures.strain_at_peak, 0.01 * 2.0 / stiffness, ROUND_OFF);
        close(
            measures.work_nj,
            0.5 * (1.0 + 4.0 + 9.0) / stiffness,
            ROUND_OFF,
        );
        close(
            measures.work_to_peak_nj,
            (1.5 + 0.5 * 2.0 * 3.0) / stiffness,
            ROUND_OFF,
        );
        assert!(measures.energy_error() < ROUND_OFF);
        assert!(measures.largest_jaw_imbalance < ROUND_OFF);
        assert_eq!((measures.broken_bonds, measures.broken_segments), (3, 0));
    }
}

#[test]
fn a_pull_stops_at_its_share_of_the_peak() {
    let (fibres, bonds) = three_joints([2.0, 3.0, 1.0]);
    let network = Network::new(&fibres, &bonds, model(Level::Beam, 100.0)).unwrap();
    let test = PullTest {
        stop_force_fraction: 0.55,
        ..TO_THE_END
    };
    let (events, end) = Pull::new(&network, test).unwrap().run().unwrap();
    // 4 mN was the peak, and 2 mN are left
    assert_eq!((events.len(), end), (2, PullEnd::ForceFraction));
}

#[test]
fn a_row_of_equal_bonds_unzips_in_one_avalanche() {
    // the outermost bonds carry most; when one goes, what is left carries more
    let at = [60.0, 80.0, 100.0, 120.0, 140.0];
    let fibres = [
        fibre(&[[0.0; 3], [150.0, 0.0, 0.0]]),
        fibre(&[[50.0, 0.0, 0.0], [200.0, 0.0, 0.0]]),
    ];
    let bonds = at.map(|x| FrameBond {
        shear_strength_mn: Some(1.0),
        ..bond([0, 1], [x, x - 50.0])
    });
    let network = Network::new(&fibres, &bonds, model(Level::Beam, 200.0)).unwrap();
    let (events, end) = Pull::new(&network, TO_THE_END).unwrap().run().unwrap();
    assert_eq!((events.len(), end), (5, PullEnd::Parted));
    assert!(events.iter().all(|event| event.avalanche == 1));
    assert!(events[4].force_after_mn.abs() < ROUND_OFF);
}

#[test]
fn normal_and_shear_mix_by_squares_and_pressure_breaks_nothing() {
    // ends that turn aside by 45 degrees lie side by side, 20 µm apart: the pull opens their face and shears it, or
    // presses it together when the second lies behind the first
    let apart = 20.0 / f64::sqrt(2.0);
    for sign in [1.0, -1.0] {
        let fibres = [
            fibre(&[[0.0; 3], [50.0, 0.0, 0.0], [60.0, 10.0, 0.0]]),
            fibre(&[
                [50.0 + sign * apart, -sign * apart, 0.0],
                [60.0 + sign * apart, 10.0 - sign * apart, 0.0],
                [100.0, 10.0 - sign * apart, 0.0],
            ]),
        ];
        let joint = FrameBond {
            normal_strength_mn: Some(2.0),
            shear_strength_mn: Some(5.0),
            ..bond([0, 1], [50.0 + f64::sqrt(50.0), f64::sqrt(50.0)])
        };
        let network = Network::new(&fibres, &[joint], model(Level::Beam, 100.0)).unwrap();
        let mut pull = Pull::new(&network, TO_THE_END).unwrap();
        let (events, _) = pull.run().unwrap();
        let Bore::Bond {
            normal_mn,
            shear_mn,
        } = events[0].bore
        else {
            panic!("a bond broke");
        };
        assert!(sign * normal_mn > 0.1, "{normal_mn}");
        let opened = normal_mn.max(0.0) / 2.0;
        close(f64::hypot(opened, shear_mn / 5.0), 1.0, 1e-7);
        // what the jaws pull with goes through the bond, with what they need to keep their height
        assert!(f64::hypot(normal_mn, shear_mn) >= (1.0 - 1e-7) * events[0].force_before_mn);
    }
}

#[test]
fn a_fibre_breaks_at_its_strength() {
    let mut single = fibre(&[[0.0; 3], [100.0, 0.0, 0.0]]);
    single.section.strength_gpa = Some(0.6);
    let network = Network::new(&[single], &[], model(Level::Beam, 100.0)).unwrap();
    let mut pull = Pull::new(&network, TO_THE_END).unwrap();
    let (events, end) = pull.run().unwrap();
    assert_eq!((events.len(), end), (1, PullEnd::Parted));
    assert_eq!(events[0].broken, Broken::Segment(0));
    close(events[0].strain, 0.6 / 30.0, ROUND_OFF);
    close(events[0].force_before_mn, 0.6 * tube().area_um2, ROUND_OFF);
    assert!(pull.is_broken(Broken::Segment(0)) && pull.segment_stress_gpa(0) == 0.0);
}

#[test]
fn below_percolation_the_force_is_nought_with_a_sentence() {
    let fibres = [
        fibre(&[[0.0; 3], [60.0, 0.0, 0.0]]),
        fibre(&[[40.0, 0.0, 0.0], [100.0, 0.0, 0.0]]),
        fibre(&[[40.0, 50.0, 0.0], [60.0, 50.0, 0.0]]),
    ];
    let void = FrameBond {
        normal_strength_mn: Some(0.0),
        shear_strength_mn: Some(0.0),
        ..bond([0, 1], [50.0, 10.0])
    };
    for bonds in [vec![], vec![void]] {
        let network = Network::new(&fibres, &bonds, model(Level::Beam, 100.0)).unwrap();
        let mut pull = Pull::new(&network, TO_THE_END).unwrap();
        let (events, end) = pull.run().unwrap();
        assert!(events.is_empty());
        assert_eq!(end, PullEnd::NoPath);
        assert!(end.sentence().ends_with("the force is 0"));
        assert!(pull.jaw_force_mn().iter().all(|force| force.abs() <= 0.0));
    }
    let nothing = Network::new(&[], &[], model(Level::Beam, 100.0)).unwrap();
    let (_, end) = Pull::new(&nothing, TO_THE_END).unwrap().run().unwrap();
    assert_eq!(end, PullEnd::NoPath);
}
