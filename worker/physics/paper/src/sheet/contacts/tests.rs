//! The search against brute force and against statistics.
use super::bounds::Aligned;
use super::*;
use crate::sheet::tests::{assert_mean, deposited, fixed, lay, random, softwood};
use crate::sheet::{FibreSection, Pulp, SheetPlan};

fn fibre(points: &[[f64; 3]]) -> SheetFibre {
    SheetFibre {
        pulp: 0,
        section: FibreSection {
            width_um: 20.0,
            wall_um: 2.0,
            thickness_um: 6.0,
            coarseness_ug_per_um: 1e-4,
        },
        centre_line_um: points.to_vec(),
    }
}

fn of(fibres: &[SheetFibre], gap_um: f64) -> Vec<Contact> {
    contacts(fibres, gap_um, &Team::alone())
}

/// All segments against all.
fn by_brute_force(fibres: &[SheetFibre], gap_um: f64) -> Vec<Contact> {
    let mut found = Vec::new();
    let mut regions = Regions::default();
    let arcs: Vec<Vec<f64>> = fibres
        .iter()
        .map(|fibre| polyline::arc_lengths(&fibre.centre_line_um))
        .collect();
    for first in 0..fibres.len() {
        for second in first + 1..fibres.len() {
            let pair = [first, second];
            let metric = Metric::new(pair.map(|index| fibres[index].section), gap_um);
            let points = pair.map(|index| &fibres[index].centre_line_um[..]);
            let mut touches = Vec::new();
            for one in 0..points[0].len() - 1 {
                for other in 0..points[1].len() - 1 {
                    touches.extend(metric.touch(points, [one, other]));
                }
            }
            let lines = pair.map(|index| Line {
                fibre: &fibres[index],
                arcs_um: &arcs[index],
            });
            let start = found.len();
            regions.join(&mut touches, lines, |region| {
                found.extend(region::contact(
                    pair.map(|index| index as u32),
                    lines,
                    region,
                ));
            });
            found[start..].sort_by(|one: &Contact, other| one.at_um[0].total_cmp(&other.at_um[0]));
        }
    }
    found
}

#[test]
fn both_kinds_of_boxes_find_what_brute_force_finds() {
    let mixed = vec![
        Pulp {
            mass_fraction: 0.7,
            ..softwood(fixed(400.0))
        },
        Pulp {
            mass_fraction: 0.3,
            width_um: 15.0,
            shape_factor: 0.5,
            coarseness_ug_per_um: 1e-4,
            ..softwood(fixed(300.0))
        },
    ];
    for plan in [
        random([260.0, 200.0], 40.0, mixed.clone()),
        deposited([260.0, 200.0], 40.0, mixed),
    ] {
        let sheet = lay(&plan, 7);
        let expected = by_brute_force(&sheet.fibres, plan.gap());
        assert!(expected.len() > 50, "{}", expected.len());
        assert_eq!(sheet.contacts, expected);
        let aligned = search::<Aligned>(&sheet.fibres, plan.gap(), &Team::alone());
        assert_eq!(aligned, expected);
    }
}

/// Pairs of boxes looked at, and pairs of leaves that they led to.
fn looked_at<B: Bound>(fibres: &[SheetFibre], gap_um: f64) -> [u64; 2] {
    let candidates = Candidates::new(fibres, gap_um);
    let trees: Vec<Tree<B>> = fibres
        .iter()
        .map(|fibre| Tree::new(fibre, gap_um))
        .collect();
    let (mut walk, mut others, mut leaves) = (Walk::default(), Vec::new(), 0);
    for first in 0..fibres.len() {
        candidates.of(first, &mut others);
        for second in &others {
            walk.leaves([&trees[first], &trees[*second as usize]], |_| leaves += 1);
        }
    }
    [walk.compared, leaves]
}

#[test]
fn turned_boxes_need_fewer_looks_than_those_along_the_axes() {
    let sheet = lay(
        &deposited([600.0; 2], 60.0, vec![softwood(fixed(1500.0))]),
        1,
    );
    let [turned, turned_leaves] = looked_at::<Oriented>(&sheet.fibres, 2.0);
    let [aligned, aligned_leaves] = looked_at::<Aligned>(&sheet.fibres, 2.0);
    assert!(turned_leaves < aligned_leaves);
    assert!(turned < aligned, "{turned} {aligned}");
}

#[test]
fn two_crossing_fibres_touch_once_at_the_crossing() {
    let one = fibre(&[[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [100.0, 0.0, 0.0]]);
    // across at 30, the second half of the way up
    let other = fibre(&[[30.0, -100.0, 6.5], [30.0, 100.0, 6.5]]);
    let fibres = [one, other];
    assert!(of(&fibres, 0.4).is_empty());
    let [contact] = of(&fibres, 0.6)[..] else {
        panic!("one contact");
    };
    assert_eq!(contact.fibres, [0, 1]);
    assert!((contact.at_um[0] - 30.0).abs() < 1e-9 && (contact.at_um[1] - 100.0).abs() < 1e-9);
    assert!(
        (contact.area_um2 - 400.0).abs() < 1e-9,
        "{}",
        contact.area_um2
    );
}

#[test]
fn a_crossing_at_an_angle_has_the_area_over_the_sine() {
    for degrees in [60.0_f64, 30.0, 12.0, 8.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let along = |x: f64, y: f64, z: f64| -> Vec<[f64; 3]> {
            (-40..=40)
                .map(|index| [x * f64::from(index) * 10.0, y * f64::from(index) * 10.0, z])
                .collect()
        };
        let fibres = [
            fibre(&along(1.0, 0.0, 0.0)),
            fibre(&along(cosine, sine, 5.9)),
        ];
        let found = of(&fibres, 0.0);
        assert_eq!(found.len(), 1);
        // at 8 degrees only what lies within 100 µm of the crossing counts
        let share = found[0].area_um2 * sine / 400.0;
        let is_cut = degrees < 11.5 && share > 0.8 && share < 1.0;
        assert!((share - 1.0).abs() < 1e-9 || is_cut, "{degrees}: {share}");
        assert!(found[0].at_um.iter().all(|at| (at - 400.0).abs() < 1e-6));
    }
}

#[test]
fn fibres_on_one_another_are_joined_in_the_middle_over_their_whole_common_length() {
    let points = |from: i32, to: i32, z: f64| -> Vec<[f64; 3]> {
        (from..=to)
            .map(|index| [f64::from(index) * 10.0, 0.0, z])
            .collect()
    };
    let found = of(
        &[fibre(&points(0, 30, 0.0)), fibre(&points(10, 50, 6.0))],
        0.0,
    );
    assert_eq!(found.len(), 1);
    // 100 to 300 µm of the first
    assert!(
        (found[0].area_um2 - 200.0 * 20.0).abs() < 1e-6,
        "{}",
        found[0].area_um2
    );
    assert!(
        (found[0].at_um[0] - 200.0).abs() <= 10.0,
        "{}",
        found[0].at_um[0]
    );
    assert!((found[0].at_um[0] - 100.0 - found[0].at_um[1]).abs() < 1e-6);
}

#[test]
fn fibres_side_by_side_have_no_area_in_common_and_no_contact() {
    let fibres = [20.0, 0.0].map(|y| fibre(&[[0.0, y, 0.0], [100.0, y, 0.0]]));
    assert!(of(&fibres, 1.0).is_empty());
}

#[test]
fn curled_fibres_that_meet_twice_have_two_contacts() {
    let bow = |sign: f64| -> Vec<[f64; 3]> {
        (0..=40)
            .map(|index| f64::from(index) / 20.0 - 1.0)
            .map(|x| [500.0 * x, sign * 200.0 * (x * x - 0.25), 0.0])
            .collect()
    };
    let found = of(&[fibre(&bow(1.0)), fibre(&bow(-1.0))], 0.0);
    assert_eq!(found.len(), 2);
    for contact in &found {
        assert!((contact.at_um[0] - contact.at_um[1]).abs() < 1e-6);
    }
}

/// Λ²/(π A) − ∑ ℓ²/(π A) pairs of uniformly directed straight fibres cross on an area A, edges and
/// all, when a window is opened on an endless sheet: each of two pieces of lengths ℓ₁, ℓ₂ crosses the
/// other with 2 ℓ₁ ℓ₂/(π A). Of N whole lines this is N² L²/(π A), but for N (N − 1) instead of N².
#[test]
fn projected_crossings_are_those_of_poisson() {
    let thread = Pulp {
        width_um: 0.01,
        wall_um: 0.002,
        coarseness_ug_per_um: 1e-6,
        shape_factor: 1.0,
        ..softwood(fixed(1000.0))
    };
    let plan = SheetPlan {
        segment_um: Some(125.0),
        // so wide that heights do not count
        gap_um: Some(1e6),
        // 200 mm of fibre on 6 mm²
        ..random([3000.0, 2000.0], 2e5 * 1e-6 / 6e6 * 1e6, vec![thread])
    };
    let ratios: Vec<f64> = (0..20)
        .map(|seed| {
            let sheet = lay(&plan, seed);
            let lengths: Vec<f64> = sheet.fibres.iter().map(SheetFibre::length_um).collect();
            let total: f64 = lengths.iter().sum();
            let squares: f64 = lengths.iter().map(|length| length * length).sum();
            let expected = (total * total - squares) / (std::f64::consts::PI * 6e6);
            assert!((expected - 2110.0).abs() < 20.0, "{expected}");
            sheet.contacts.len() as f64 / expected
        })
        .collect();
    assert_mean(&ratios, 1.0);
}
