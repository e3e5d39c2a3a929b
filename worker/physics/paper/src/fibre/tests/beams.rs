use std::f64::consts::{FRAC_PI_2, PI};

use super::{elasticity, near, section};
use crate::fibre::equilibrium::{Supports, large, small};
use crate::fibre::measure::{cantilever, column_load_mn, constants, push, shear_stiffness_mn};
use crate::fibre::{
    Divided, Division, FibreError, OnInadmissible, Ring, Tube, TubeError, divide, half_angle,
};

fn fibre(length_um: f64, points: usize) -> Divided {
    let division = Division {
        points_on_ring: points,
        ring: Ring::Gyration,
        segment_um: None,
        on_inadmissible: OnInadmissible::Refine,
    };
    divide(length_um, &section(), &elasticity(0.2), &division).unwrap()
}

fn shear(divided: &Divided) -> f64 {
    shear_stiffness_mn(
        &section(),
        &elasticity(0.2),
        divided.springs.shear_modulus_gpa,
    )
}

/// Force [mN] that moves the last ring by this [µm] along the chord, both rings glued.
fn glued(tube: &Tube, by_um: f64) -> Supports {
    let mut supports = Supports::none(tube);
    supports.move_ring(tube, 0, |_| [Some(0.0); 3]);
    supports.move_ring(tube, tube.segments(), |_| {
        [Some(by_um), Some(0.0), Some(0.0)]
    });
    supports
}

fn force(tube: &Tube, reactions: &[f64]) -> f64 {
    tube.ring(tube.segments())
        .map(|point| reactions[3 * point])
        .sum()
}

#[test]
fn the_arc_of_a_shape_factor_has_its_chord() {
    // sin 1/1
    near(half_angle(1.0_f64.sin()).unwrap(), 1.0, 1e-14);
    near(half_angle(2.0 / PI).unwrap(), FRAC_PI_2, 1e-14);
    assert!(half_angle(1.0).unwrap().abs() < 1e-12);
    for factor in [1e-6, 0.05, 0.3, 0.5, 0.92, 0.999_999] {
        let angle = half_angle(factor).unwrap();
        near(angle.sin() / angle, factor, 1e-9);
    }
    for refused in [0.0, -0.1, 1.0001, f64::NAN] {
        let error = half_angle(refused).unwrap_err();
        assert!(matches!(error, FibreError::OutOfRange { .. }));
    }
}

#[test]
fn half_the_angle_at_the_chord_is_that_of_the_reference() {
    for (factor, expected) in [(0.99, 0.1227), (0.95, 0.2760), (0.9, 0.3933), (0.8, 0.5656)] {
        near(half_angle(factor).unwrap() / 2.0, expected, 5e-4);
    }
}

#[test]
fn a_fine_tube_keeps_its_length_and_has_the_chord_of_its_shape_factor() {
    for factor in [1.0, 0.92, 0.5] {
        let divided = fibre(40_000.0, 4);
        let tube = Tube::curled(&divided, factor).unwrap();
        near(tube.chord_um() / tube.length_um(), factor, 1e-6);
        // the chord lies along x
        assert!(tube.centre_um(tube.segments())[1].abs() < 1e-8);
        near(tube.length_um(), 40_000.0, 1e-12);
    }
}

/// What glue at an end ring stiffens dies out within a few µm, so that its share goes as 1/length.
fn assert_end_effect(misses: [f64; 2], lengths: [f64; 2]) {
    assert!(misses.iter().all(|miss| miss.abs() < 1e-2), "{misses:?}");
    near(misses[0] / misses[1], lengths[1] / lengths[0], 0.15);
}

#[test]
fn a_cantilever_bends_and_shears_as_the_measured_stiffness_says_but_for_its_glue() {
    for points in [6, 8, 12] {
        let lengths = [600.0, 1200.0];
        let misses = lengths.map(|length| {
            let divided = fibre(length, points);
            let tube = Tube::straight(divided.segments, &divided.segment, &divided.springs);
            let (compliance, rest) = cantilever(&tube).unwrap();
            assert!(rest.residual < 1e-10);
            let stiffness = constants(&divided, &section())
                .unwrap()
                .bending_stiffness_mn_um2;
            let beam = length.powi(3) / (3.0 * stiffness) + length / shear(&divided);
            1.0 - compliance / beam
        });
        assert_end_effect(misses, lengths);
    }
}

#[test]
fn a_slender_tube_buckles_at_the_load_of_engesser() {
    for points in [6, 8, 12, 16] {
        let divided = fibre(800.0, points);
        let tube = Tube::straight(divided.segments, &divided.segment, &divided.springs);
        let pushed = push(&tube).unwrap();
        let stiffness = constants(&divided, &section())
            .unwrap()
            .bending_stiffness_mn_um2;
        let column = column_load_mn(stiffness, 800.0, Some(shear(&divided)));
        near(pushed.load_mn, column, 5e-3);
        // half a sine, largest in the middle
        let middle = divided.segments / 2;
        let shift = |ring: usize| -> f64 {
            tube.ring(ring)
                .map(|point| pushed.buckling.mode[3 * point + 1])
                .sum()
        };
        near(shift(middle / 2) / shift(middle), (PI * 0.25).sin(), 0.05);
    }
}

/// Castigliano on an arc of radius R and half angle ψ, glued at both ends, H along the chord:
/// M = -H R (cos φ - sin ψ/ψ), N = H cos φ, V = H sin φ.
#[test]
fn a_curled_fibre_is_as_stiff_between_its_ends_as_an_arc_but_for_its_glue() {
    for factor in [0.98, 0.9, 0.7] {
        let lengths = [1500.0, 3000.0];
        let misses = lengths.map(|length| {
            let divided = fibre(length, 8);
            let tube = Tube::curled(&divided, factor).unwrap();
            let rest = small(&tube, &glued(&tube, 1e-3)).unwrap();
            let stiffness = constants(&divided, &section())
                .unwrap()
                .bending_stiffness_mn_um2;
            let angle = half_angle(factor).unwrap();
            let radius = length / (2.0 * angle);
            let cosines = angle + (2.0 * angle).sin() / 2.0;
            let bending =
                radius.powi(3) / stiffness * (cosines - 2.0 * angle.sin().powi(2) / angle);
            let pulling = radius / (30.0 * section().area_um2()) * cosines;
            let shearing = radius / shear(&divided) * (2.0 * angle - cosines);
            let expected = 1e-3 / (bending + pulling + shearing);
            force(&tube, &rest.reactions_mn) / expected - 1.0
        });
        assert_end_effect(misses, lengths);
    }
}

#[test]
fn large_displacements_begin_as_small_ones_and_stiffen_as_the_curl_goes() {
    let divided = fibre(1000.0, 6);
    let tube = Tube::curled(&divided, 0.97).unwrap();
    let first = small(&tube, &glued(&tube, 1e-3)).unwrap();
    let same = large(&tube, &glued(&tube, 1e-3), &first.displacements_um).unwrap();
    let initial = force(&tube, &first.reactions_mn) / 1e-3;
    near(force(&tube, &same.reactions_mn) / 1e-3, initial, 1e-3);
    // past the 3 % of curl the wall itself is strained
    let mut before = same.displacements_um;
    let mut forces = vec![0.0];
    for step in 1..=20 {
        let rest = large(&tube, &glued(&tube, 2.0 * f64::from(step)), &before).unwrap();
        forces.push(force(&tube, &rest.reactions_mn));
        before = rest.displacements_um;
    }
    let slopes: Vec<f64> = forces
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / 2.0)
        .collect();
    assert!(
        slopes.windows(2).all(|pair| pair[1] > pair[0] * 0.999),
        "{slopes:?}"
    );
    // a stiff string: wall, and at either glue a bow of the width √(E I/T) that holds ψ²/4 of it back
    let stiffness = constants(&divided, &section())
        .unwrap()
        .bending_stiffness_mn_um2;
    let tension = 0.5 * (forces[19] + forces[20]);
    let bows = half_angle(0.97).unwrap().powi(2) / 4.0 * stiffness.sqrt() / tension.powf(1.5);
    let wall = 1000.0 / (30.0 * section().area_um2());
    near(1.0 / slopes[19], wall + bows, 0.05);
}

#[test]
fn a_turn_of_both_ends_by_a_right_angle_costs_nothing() {
    let divided = fibre(300.0, 6);
    let tube = Tube::straight(divided.segments, &divided.segment, &divided.springs);
    let mut supports = Supports::none(&tube);
    for ring in [0, tube.segments()] {
        supports.move_ring(&tube, ring, |[x, y, _]| {
            [Some(-y - x), Some(x - y), Some(0.0)]
        });
    }
    // out of the way by up to 5 µm between the ends
    let start: Vec<f64> = tube
        .places_um()
        .iter()
        .flat_map(|[x, y, _]| {
            let off = 5.0 * (PI * x / 300.0).sin();
            [off - y - x, x - y, 0.5 * off]
        })
        .collect();
    let rest = large(&tube, &supports, &start);
    let turned = rest.unwrap();
    let largest = turned
        .tensions_mn
        .iter()
        .fold(0.0_f64, |most, f| most.max(f.abs()));
    // the force of a strain of 1e-9
    assert!(largest < 30.0 * section().area_um2() * 1e-9, "{largest}");
}

#[test]
fn a_nearly_straight_fibre_pushed_between_glues_bears_four_times_the_pinned_load_and_no_more() {
    let divided = fibre(1500.0, 6);
    let tube = Tube::curled(&divided, 0.999_999).unwrap();
    let stiffness = constants(&divided, &section())
        .unwrap()
        .bending_stiffness_mn_um2;
    let critical = 4.0 * column_load_mn(stiffness, 1500.0, None);
    let buckles_at = critical * 1500.0 / (30.0 * section().area_um2());
    let mut before = vec![0.0; 3 * tube.places_um().len()];
    let mut forces = Vec::new();
    for step in 1..=20 {
        let by = -0.25 * f64::from(step) * buckles_at;
        let rest = large(&tube, &glued(&tube, by), &before).unwrap();
        forces.push(-force(&tube, &rest.reactions_mn));
        before = rest.displacements_um;
    }
    // long before: the wall's stiffness; long after: a plateau
    near(forces[0], 0.25 * critical, 0.03);
    near(forces[19], critical, 0.02);
}

#[test]
fn a_tube_that_nothing_holds_has_no_rest() {
    let divided = fibre(200.0, 6);
    let tube = Tube::straight(divided.segments, &divided.segment, &divided.springs);
    let mut supports = Supports::none(&tube);
    supports.move_point(0, 0, 1.0);
    match small(&tube, &supports) {
        Err(TubeError::Unstable { .. }) => {}
        other => panic!("{other:?}"),
    }
}
