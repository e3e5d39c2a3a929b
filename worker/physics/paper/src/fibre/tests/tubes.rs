use nalgebra::DMatrix;

use super::{SHEAR_RATIOS, elasticity, near, section, segment};
use crate::fibre::measure::{Ends, constants_of, pull};
use crate::fibre::{Division, OnInadmissible, Ring, Sort, Springs, Tube, Window, divide};

/// Constants are read off linear equations: what is left is their round-off.
const ROUND_OFF: f64 = 1e-8;

/// Modes of the whole tube that cost no energy, from its dense stiffness matrix.
fn free_modes(tube: &Tube) -> usize {
    let mut matrix = DMatrix::<f64>::zeros(3 * tube.places_um().len(), 3 * tube.places_um().len());
    for spring in tube.springs() {
        let [low, high] = spring.points.map(|point| point as usize);
        let (from, to) = (tube.places_um()[low], tube.places_um()[high]);
        let apart: Vec<f64> = (0..3).map(|axis| to[axis] - from[axis]).collect();
        let length = apart.iter().map(|part| part * part).sum::<f64>().sqrt();
        for row in 0..3 {
            for column in 0..3 {
                let part =
                    spring.stiffness_mn_per_um * apart[row] * apart[column] / (length * length);
                for (one, other, sign) in [
                    (low, low, 1.0),
                    (high, high, 1.0),
                    (low, high, -1.0),
                    (high, low, -1.0),
                ] {
                    matrix[(3 * one + row, 3 * other + column)] += sign * part;
                }
            }
        }
    }
    let values = matrix.symmetric_eigenvalues();
    let largest = values.max();
    // floppy modes lie below 1e-15 of the largest, the softest others above 1e-6
    values
        .iter()
        .filter(|value| value.abs() < 1e-10 * largest)
        .count()
}

fn springs_at(points: usize, ring: Ring, ratio: f64, place: f64) -> (f64, Springs) {
    let (section, elasticity) = (section(), elasticity(ratio));
    let diameter = section.ring_diameter_um(ring).unwrap();
    let window = Window::new(points, diameter, &section, &elasticity).unwrap();
    let length = window.from_um + place * (window.to_um - window.from_um);
    (
        length,
        segment(points, ring, length).closed_form(&section, &elasticity),
    )
}

#[test]
fn moduli_are_what_was_put_in_wherever_the_window_allows() {
    for ring in [Ring::Gyration, Ring::Patent] {
        for ratio in SHEAR_RATIOS {
            for points in [4, 6, 8, 12, 16] {
                for place in [1e-3, 0.5, 0.99] {
                    let (length, springs) = springs_at(points, ring, ratio, place);
                    let tube = Tube::straight(12, &segment(points, ring, length), &springs);
                    let found = constants_of(&tube, &section()).unwrap();
                    near(found.axial_modulus_gpa, 30.0, ROUND_OFF);
                    near(found.poisson_ratio, 0.3, ROUND_OFF);
                    near(found.shear_modulus_gpa, 30.0 * ratio, ROUND_OFF);
                    assert!(found.residual < 1e-11);
                }
            }
        }
    }
}

#[test]
fn a_robust_tube_has_the_young_modulus_and_poisson_ratio_of_the_wall_and_the_shear_modulus_it_tells()
 {
    for ratio in [0.08, 0.385] {
        for length in [10.0, 20.0, 40.0, 100.0] {
            let segment = segment(6, Ring::Gyration, length);
            let springs = segment.robust(&section(), &elasticity(ratio)).unwrap();
            let tube = Tube::straight(24, &segment, &springs);
            let found = constants_of(&tube, &section()).unwrap();
            near(found.axial_modulus_gpa, 30.0, ROUND_OFF);
            near(found.poisson_ratio, 0.3, ROUND_OFF);
            near(
                found.shear_modulus_gpa,
                springs.shear_modulus_gpa,
                ROUND_OFF,
            );
        }
    }
}

#[test]
fn springs_between_second_neighbours_leave_just_the_six_rigid_motions() {
    for points in [4, 6, 8, 12, 16] {
        let (length, springs) = springs_at(points, Ring::Gyration, 0.08, 0.3);
        let segment = segment(points, Ring::Gyration, length);
        assert_eq!(free_modes(&Tube::straight(4, &segment, &springs)), 6);
        let patent = Springs {
            second: [0.0; 2],
            ..springs
        };
        let floppy = 6 + (points - 4);
        assert_eq!(
            free_modes(&Tube::straight(4, &segment, &patent)),
            floppy,
            "{points}"
        );
    }
}

#[test]
fn without_the_projection_of_the_chord_the_shear_modulus_is_its_square_too_small() {
    for (points, expected) in [(6, 0.75), (12, 0.933)] {
        let (length, springs) = springs_at(points, Ring::Gyration, 0.08, 0.3);
        let segment = segment(points, Ring::Gyration, length);
        // what the patent makes of q
        let weaker = Springs {
            diagonal: springs.diagonal * segment.projection(),
            ..springs
        };
        let found = constants_of(&Tube::straight(24, &segment, &weaker), &section()).unwrap();
        near(found.shear_modulus_gpa / 2.4, expected, 5e-4);
    }
}

/// With half of the radial stiffness that two segments ask for, a ring contracts by
/// ν' = 2 ν r²/(r² + ν), and E' = E (1 - (G/E) (ν' - ν)/q): 0.48 to 0.58 and 0.88 to 0.99.
#[test]
fn the_balance_of_one_segment_makes_a_fibre_contract_by_half_its_strain() {
    for (ratio, place) in [(0.385, 0.1), (0.385, 0.5), (0.08, 0.5)] {
        let (length, springs) = springs_at(6, Ring::Gyration, ratio, place);
        let patent = Springs {
            across: [springs.across[1]; 2],
            ..springs
        };
        let segment = segment(6, Ring::Gyration, length);
        let found = constants_of(&Tube::straight(40, &segment, &patent), &section()).unwrap();
        let squared = segment.slenderness().powi(2);
        let contraction = 0.6 * squared / (squared + 0.3);
        // ends that are right disturb the middle of 40 segments by some 1e-6
        near(found.poisson_ratio, contraction, 1e-5);
        let softer = 1.0 - ratio * (contraction - 0.3) / segment.projection();
        near(found.axial_modulus_gpa / 30.0, softer, 1e-5);
        assert!(contraction > 0.45);
    }
}

#[test]
fn glued_ends_make_a_tube_stiffer_and_less_so_the_longer_it_is() {
    let (length, springs) = springs_at(6, Ring::Gyration, 0.08, 0.1);
    let force = |segments: usize, ends: Ends| {
        let tube = Tube::straight(segments, &segment(6, Ring::Gyration, length), &springs);
        pull(&tube, 1e-6, ends).unwrap().0
    };
    let excess =
        |segments| force(segments, Ends::Held) / force(segments, Ends::FreeToContract) - 1.0;
    let (short, long) = (excess(10), excess(40));
    assert!(short > 0.0 && long > 0.0);
    // two ends, each of its own compliance: the excess is one over the length
    near(short / long, 4.0, 0.05);
}

#[test]
fn masses_add_up_to_coarseness_times_length_and_end_rings_have_half() {
    let (length, springs) = springs_at(6, Ring::Gyration, 0.08, 0.1);
    let tube = Tube::straight(10, &segment(6, Ring::Gyration, length), &springs);
    let masses = tube.masses_ug(0.2);
    near(masses.iter().sum(), 0.2e-3 * 10.0 * length, 1e-13);
    near(masses[0], 0.5 * masses[30], 1e-15);
}

#[test]
fn a_tube_has_the_springs_that_the_reference_counts_and_second_ones() {
    let (length, springs) = springs_at(6, Ring::Gyration, 0.08, 0.1);
    let tube = Tube::straight(20, &segment(6, Ring::Gyration, length), &springs);
    // 549 of the reference, and 6 on each of 21 rings
    assert_eq!(tube.springs().len(), 120 + 126 + 240 + 63 + 126);
}

/// Springs of two tubes are as long at rest, one by one.
fn same_springs(one: &Tube, other: &Tube) {
    assert_eq!(one.springs().len(), other.springs().len());
    for (one, other) in one.springs().iter().zip(other.springs()) {
        assert_eq!((one.points, one.sort), (other.points, other.sort));
        near(one.rest_um, other.rest_um, 1e-9);
    }
}

#[test]
fn a_tube_along_a_line_is_the_straight_and_the_curled_one() {
    let division = Division {
        points_on_ring: 6,
        ring: Ring::Gyration,
        segment_um: None,
        on_inadmissible: OnInadmissible::Refine,
    };
    let divided = divide(1000.0, &section(), &elasticity(0.08), &division).unwrap();
    let straight = Tube::straight(divided.segments, &divided.segment, &divided.springs);
    // along x the points are the same ones; along 2-3-6, out of the plane, the springs are as long
    let along = Tube::along_line(&[[0.0; 3], [1000.0, 0.0, 0.0]], &divided).unwrap();
    for (one, other) in along.places_um().iter().zip(straight.places_um()) {
        for axis in 0..3 {
            assert!((one[axis] - other[axis]).abs() < 1e-9, "{one:?} {other:?}");
        }
    }
    let slant = [[0.0; 3], [2000.0 / 7.0, 3000.0 / 7.0, 6000.0 / 7.0]];
    same_springs(&Tube::along_line(&slant, &divided).unwrap(), &straight);
    let upright = [[0.0; 3], [0.0, 0.0, 1000.0]];
    same_springs(&Tube::along_line(&upright, &divided).unwrap(), &straight);

    // along the centres of a curled tube all rings but the two at the ends, which lie across their segment here and half a
    // turn further there
    let curled = Tube::curled(&divided, 0.9).unwrap();
    let centres: Vec<[f64; 3]> = (0..=divided.segments)
        .map(|ring| curled.centre_um(ring))
        .collect();
    let along = Tube::along_line(&centres, &divided).unwrap();
    let count = divided.segment.points_on_ring() as u32;
    let inner = count..count * divided.segments as u32;
    for (one, other) in along.springs().iter().zip(curled.springs()) {
        if one.points.iter().all(|point| inner.contains(point)) {
            near(one.rest_um, other.rest_um, 1e-9);
        }
    }
}

#[test]
fn rings_along_a_helix_are_not_twisted_against_one_another() {
    // five turns of 200 µm, rising by 10 µm a radian: no shear of springs along, however the line winds
    let line: Vec<[f64; 3]> = (0..=2000)
        .map(|point| {
            let angle = f64::from(point) * std::f64::consts::PI / 200.0;
            [200.0 * angle.cos(), 200.0 * angle.sin(), 10.0 * angle]
        })
        .collect();
    let length_um = loadframe_api::fibre::line_length_um(&line);
    let division = Division {
        points_on_ring: 6,
        ring: Ring::Gyration,
        segment_um: None,
        on_inadmissible: OnInadmissible::Refine,
    };
    let divided = divide(length_um, &section(), &elasticity(0.08), &division).unwrap();
    let tube = Tube::along_line(&line, &divided).unwrap();
    let (segment, springs) = (divided.segment, tube.springs());
    let radius = 0.5 * segment.diameter_um();
    let diagonals: Vec<f64> = springs
        .iter()
        .filter(|spring| spring.sort == Sort::Diagonal)
        .map(|spring| spring.rest_um)
        .collect();
    // a twist would make those one way longer than those the other by c θ R/s for an angle θ; the curvature changes pairs
    // alike, in the mean over a ring
    let (plus, minus): (Vec<f64>, Vec<f64>) =
        diagonals.chunks(2).map(|pair| (pair[0], pair[1])).unzip();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let chord = segment.chord_um();
    let slope = chord / (segment.length_um().powi(2) + chord * chord).sqrt();
    let twist = (mean(&plus) - mean(&minus)) / (2.0 * slope * radius);
    assert!(twist.abs() < 1e-3, "{twist}");
}
