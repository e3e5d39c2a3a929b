use loadframe_api::fibre::divide_piece;
use proptest::prelude::*;

use super::{SHEAR_RATIOS, elasticity, near, section, segment};
use crate::fibre::{
    Divided, Division, Elasticity, FibreError, OnInadmissible, Ring, Section, Window, divide,
};

fn division(segment_um: Option<f64>, on_inadmissible: OnInadmissible) -> Division {
    Division {
        points_on_ring: 6,
        ring: Ring::Gyration,
        segment_um,
        on_inadmissible,
    }
}

fn divided(
    wanted_um: f64,
    shear_ratio: f64,
    on_inadmissible: OnInadmissible,
) -> Result<Divided, FibreError> {
    let division = division(Some(wanted_um), on_inadmissible);
    divide(2000.0, &section(), &elasticity(shear_ratio), &division)
}

#[test]
fn a_wall_of_3_in_30_has_81_pi_of_area() {
    let section = section();
    near(section.area_um2(), std::f64::consts::PI * 81.0, 1e-15);
    // 30⁴ - 24⁴ = 478 224
    near(
        section.inertia_um4(),
        std::f64::consts::PI / 64.0 * 478_224.0,
        1e-14,
    );
    near(section.polar_um4(), 2.0 * section.inertia_um4(), 1e-15);
    // √((900 + 576)/2)
    near(
        section.ring_diameter_um(Ring::Gyration).unwrap(),
        738.0_f64.sqrt(),
        1e-14,
    );
    near(section.ring_diameter_um(Ring::Patent).unwrap(), 24.0, 1e-15);
    // 0.15 mg/m over 254.47 µm²
    near(section.wall_density_kg_per_m3(0.15), 589.46, 1e-5);
}

#[test]
fn coarseness_and_wall_that_contradict_one_another_are_told_with_both_numbers() {
    let sentence = section().contradiction(0.15).unwrap();
    assert!(
        sentence.contains("589 kg/m³") && sentence.contains("0.15 mg/m"),
        "{sentence}"
    );
    assert_eq!(section().contradiction(0.36), None);
}

#[test]
fn a_wall_above_half_the_width_is_refused_and_half_of_it_is_not() {
    let refused = Section::new(28.0, 14.1).unwrap_err().to_string();
    assert!(
        refused.contains("14.1") && refused.contains("14 µm"),
        "{refused}"
    );
    let solid = Section::new(28.0, 14.0).unwrap();
    near(solid.area_um2(), std::f64::consts::PI * 196.0, 1e-15);
    near(
        solid.ring_diameter_um(Ring::Gyration).unwrap(),
        28.0 / 2.0_f64.sqrt(),
        1e-14,
    );
    assert!(solid.ring_diameter_um(Ring::Patent).is_err());
}

#[test]
fn values_that_no_wall_has_are_refused_by_name() {
    for (young, poisson, shear, name) in [
        (0.0, 0.3, 2.0, "Young's modulus"),
        (f64::NAN, 0.3, 2.0, "Young's modulus"),
        (30.0, 0.0, 2.0, "Poisson's ratio"),
        (30.0, 0.51, 2.0, "Poisson's ratio"),
        (30.0, 0.3, -2.0, "shear modulus"),
        (30.0, 0.3, f64::INFINITY, "shear modulus"),
    ] {
        let refused = Elasticity::new(young, poisson, shear)
            .unwrap_err()
            .to_string();
        assert!(refused.starts_with(name), "{refused}");
    }
}

/// Axial and radial balance of one point under a strain, and torsion of a ring, written out.
#[test]
fn springs_balance_one_point_in_tension_and_torsion() {
    let (section, elasticity) = (section(), elasticity(0.08));
    let segment = segment(8, Ring::Gyration, 29.0);
    let k = segment.closed_form(&section, &elasticity);
    let (l, c, diameter): (f64, f64, f64) = (29.0, segment.chord_um(), segment.diameter_um());
    let s = (l * l + c * c).sqrt();
    let (nu, strain) = (0.3, 1e-3);
    // elongations
    let diagonal = (l * l * strain - c * c * nu * strain) / s;
    let axial = k.along * l * strain + 2.0 * k.diagonal * diagonal * l / s;
    near(axial, 30.0 * section.area_um2() * strain / 8.0, 1e-13);
    // pull of the diagonals towards the centre, against the springs of the ring, which are shortened
    let sine = (std::f64::consts::PI / 8.0).sin();
    let second = 2.0 * c * segment.projection().sqrt();
    for (is_end, segments) in [(0, 2.0), (1, 1.0)] {
        let inward = 2.0 * segments * k.diagonal * diagonal * (c / s) * sine;
        let outward = 2.0 * k.around[is_end] * c * nu * strain * sine
            + 2.0 * k.second[is_end] * second * nu * strain * second / diameter
            + k.across[is_end] * diameter * nu * strain;
        near(outward, inward, 1e-13);
    }
    // a turn of 1e-3 rad over l: torque G J 1e-3/l
    let shift = 1e-3 * diameter / 2.0;
    let cosine = segment.projection().sqrt();
    let tension = k.diagonal * shift * cosine * c / s;
    let torque = 8.0 * 2.0 * tension * (c / s) * cosine * diameter / 2.0;
    near(torque, 2.4 * section.polar_um4() * 1e-3 / l, 1e-13);
}

/// Table of the reference, r = l/c on the gyration ring: between, ends, highest.
#[test]
fn windows_are_those_of_the_reference_for_the_gyration_ring() {
    let table = [
        [[0.83, 1.02, 1.50], [0.87, 1.08, 1.59], [0.90, 1.13, 1.65]],
        [[1.11, 1.42, 2.01], [1.19, 1.53, 2.14], [1.26, 1.61, 2.23]],
        [[1.93, 2.42, 3.11], [2.10, 2.61, 3.31], [2.23, 2.75, 3.46]],
        [[3.66, 4.28, 5.03], [3.97, 4.60, 5.35], [4.20, 4.84, 5.60]],
    ];
    let diameter = section().ring_diameter_um(Ring::Gyration).unwrap();
    for (ratio, row) in SHEAR_RATIOS.into_iter().zip(table) {
        for (points, expected) in [6, 8, 12].into_iter().zip(row) {
            let window = Window::new(points, diameter, &section(), &elasticity(ratio)).unwrap();
            let chord = segment(points, Ring::Gyration, 1.0).chord_um();
            let given = [window.from_between_um, window.from_um, window.to_um];
            for (given, expected) in given.into_iter().zip(expected) {
                // the table has two decimals, some of them cut off
                assert!(
                    (given / chord - expected).abs() < 0.0125,
                    "{ratio} {points}: {given}"
                );
            }
        }
    }
}

#[test]
fn springs_change_sign_where_the_window_says() {
    let (section, elasticity) = (section(), elasticity(0.08));
    for ring in [Ring::Gyration, Ring::Patent] {
        let diameter = section.ring_diameter_um(ring).unwrap();
        let window = Window::new(6, diameter, &section, &elasticity).unwrap();
        let springs = |length: f64| segment(6, ring, length).closed_form(&section, &elasticity);
        let just = 1e-9;
        assert!(springs(window.from_between_um * (1.0 - just)).across[0] < 0.0);
        assert!(springs(window.from_between_um * (1.0 + just)).across[0] > 0.0);
        assert!(springs(window.from_um * (1.0 - just)).across[1] < 0.0);
        assert!(springs(window.from_um * (1.0 + just)).are_admissible());
        assert!(springs(window.to_um * (1.0 - just)).are_admissible());
        assert!(springs(window.to_um * (1.0 + just)).along < 0.0);
    }
}

#[test]
fn a_tenth_of_a_millimetre_needs_a_shear_ratio_below_0_014() {
    let admits = |ratio: f64| {
        let diameter = section().ring_diameter_um(Ring::Gyration).unwrap();
        Window::new(6, diameter, &section(), &elasticity(ratio))
            .unwrap()
            .to_um
            > 100.0
    };
    assert!(admits(0.0138) && !admits(0.0141));
}

#[test]
fn an_inadmissible_segment_is_refined_rejected_or_made_robust_as_asked() {
    let refined = divided(100.0, 0.08, OnInadmissible::Refine).unwrap();
    assert!(refined.is_refined && refined.springs.are_admissible());
    // 2000 µm over 32.85 µm: 60 segments of 33.33 µm
    assert_eq!(refined.segments, 60);

    let rejected = divided(100.0, 0.08, OnInadmissible::Reject).unwrap_err();
    let sentence = rejected.to_string();
    assert!(
        sentence.contains("100.0000") && sentence.contains("32.8"),
        "{sentence}"
    );
    assert!(sentence.contains("42.2"), "{sentence}");

    let robust = divided(100.0, 0.08, OnInadmissible::Robust).unwrap();
    assert_eq!(robust.segments, 20);
    assert!(robust.springs.is_robust && robust.springs.are_admissible());
    // G_eff of the reference: 15.7 % at 0.08, 3.3 % at 0.385
    near(robust.springs.shear_modulus_gpa / 2.4, 0.157, 5e-3);
    let stiff = divided(100.0, 0.385, OnInadmissible::Robust).unwrap();
    near(stiff.springs.shear_modulus_gpa / 11.55, 0.033, 0.02);
}

#[test]
fn an_admissible_segment_is_kept_whatever_would_be_done_otherwise() {
    for otherwise in [
        OnInadmissible::Refine,
        OnInadmissible::Reject,
        OnInadmissible::Robust,
    ] {
        let divided = divided(40.0, 0.08, otherwise).unwrap();
        assert_eq!(divided.segments, 50);
        assert!(!divided.is_refined && !divided.springs.is_robust);
    }
}

#[test]
fn a_fibre_too_short_for_the_window_is_refused_with_it() {
    let refused = divide(
        30.0,
        &section(),
        &elasticity(0.08),
        &division(None, OnInadmissible::Refine),
    );
    assert!(
        matches!(refused, Err(FibreError::NoWholeNumber { .. })),
        "{refused:?}"
    );
}

#[test]
fn a_piece_of_any_length_has_segments_and_keeps_its_moduli() {
    let (section, elasticity) = (section(), elasticity(0.08));
    let division = division(None, OnInadmissible::Refine);
    let window = divide(2000.0, &section, &elasticity, &division)
        .unwrap()
        .window;
    for length_um in [10.0, 30.0, 45.0, 60.0, 75.0, 90.0, 130.0, 1000.0] {
        let piece = divide_piece(length_um, &section, &elasticity, &division).unwrap();
        near(
            piece.segments as f64 * piece.segment.length_um(),
            length_um,
            1e-12,
        );
        assert!(piece.segment.length_um() <= window.to_um && piece.springs.are_admissible());
        let kept = elasticity.shear_modulus_gpa();
        near(piece.springs.shear_modulus_gpa, kept, 1e-15);
        assert_eq!(
            piece.springs.is_robust,
            !window.admits(piece.segment.length_um())
        );
    }
    // c √ν = 13.58 µm × 0.548 = 7.4 µm is the shortest
    let short = divide_piece(7.0, &section, &elasticity, &division).unwrap_err();
    assert!(matches!(short, FibreError::TooShort { .. }), "{short:?}");
    // a length of segments that is admissible is not rejected for what a whole number makes of it
    let kept = Division {
        segment_um: Some(35.0),
        on_inadmissible: OnInadmissible::Reject,
        ..division
    };
    let piece = divide_piece(60.0, &section, &elasticity, &kept).unwrap();
    assert_eq!((piece.segments, piece.springs.is_robust), (2, true));
    let wrong = Division {
        segment_um: Some(50.0),
        ..kept
    };
    let error = divide_piece(60.0, &section, &elasticity, &wrong).unwrap_err();
    assert!(
        matches!(error, FibreError::Inadmissible { given_um: 50.0, .. }),
        "{error:?}"
    );
}

#[test]
fn robust_springs_need_more_than_the_length_at_which_diagonals_shorten() {
    let refused = divided(5.0, 0.08, OnInadmissible::Robust).unwrap_err();
    assert!(matches!(refused, FibreError::TooShort { .. }), "{refused}");
}

proptest! {
    #[test]
    fn no_fibre_ever_gets_a_negative_spring(
        width in 5.0..60.0_f64, wall in 0.02..0.5_f64, ratio in 0.01..0.5_f64, nu in 0.01..0.5_f64,
        points in 2_usize..9, length in 100.0..8000.0_f64, wanted in 1.0..200.0_f64,
        is_patent: bool, way in 0..3,
    ) {
        let section = Section::new(width, wall * width).unwrap();
        let elasticity = Elasticity::new(30.0, nu, 30.0 * ratio).unwrap();
        let division = Division {
            points_on_ring: 2 * points,
            ring: if is_patent { Ring::Patent } else { Ring::Gyration },
            segment_um: (way > 0).then_some(wanted),
            on_inadmissible: if way == 2 { OnInadmissible::Robust } else { OnInadmissible::Refine },
        };
        if let Ok(divided) = divide(length, &section, &elasticity, &division) {
            prop_assert!(divided.springs.are_admissible(), "{divided:?}");
            let sum = divided.segments as f64 * divided.segment.length_um();
            prop_assert!((sum - length).abs() < 1e-9 * length);
        }
    }
}
