//! Masses, lengths, places and directions of what was laid.
use std::f64::consts::PI;

use super::*;

fn mixture() -> Vec<Pulp> {
    let log_normal = LengthDistribution::LogNormal {
        mean_um: 700.0,
        variation: 0.4,
    };
    let measured = [
        (500.0, 15.0, 3.0, 0.95),
        (900.0, 20.0, 2.5, 0.8),
        (300.0, 12.0, 3.0, 1.0),
    ];
    let measured = measured.map(
        |(length_um, width_um, wall_um, shape_factor)| MeasuredFibre {
            length_um,
            width_um,
            wall_um,
            shape_factor,
        },
    );
    vec![
        Pulp {
            mass_fraction: 0.55,
            ..softwood(log_normal)
        },
        Pulp {
            mass_fraction: 0.3,
            width_um: 18.0,
            wall_um: 3.0,
            coarseness_ug_per_um: 1e-4,
            ..softwood(LengthDistribution::Measured(measured.to_vec()))
        },
        Pulp {
            mass_fraction: 0.15,
            width_um: 20.0,
            wall_um: 4.0,
            lumen: Lumen::Open,
            ..softwood(fixed(400.0))
        },
    ]
}

#[test]
fn grammage_and_mass_fractions_are_exact() {
    for plan in [random, deposited].map(|plan| plan([1200.0, 700.0], 40.0, mixture())) {
        let sheet = lay(&plan, 3);
        let target = 40e-6 * 1200.0 * 700.0;
        for (index, pulp) in plan.pulps.iter().enumerate() {
            let of_pulp = sheet.fibres.iter().filter(|fibre| fibre.pulp == index);
            let mass: f64 = of_pulp.map(SheetFibre::mass_ug).sum();
            let off = mass / (pulp.mass_fraction * target) - 1.0;
            assert!(off.abs() < ROUNDING, "{index}: {off}");
        }
        let measured = Statistics::of(&sheet, 10).expect("there are fibres");
        assert!((measured.grammage_ug_per_um2 / 40e-6 - 1.0).abs() < ROUNDING);
    }
}

#[test]
fn pulps_are_mixed_through_the_order_of_laying() {
    let sheet = lay(&deposited([900.0, 900.0], 40.0, mixture()), 3);
    let total: f64 = sheet.fibres.iter().map(SheetFibre::mass_ug).sum();
    let half = sheet.fibres[..sheet.fibres.len() / 2].iter();
    let mass = |pulp: Option<usize>| {
        let of_pulp = half
            .clone()
            .filter(|fibre| pulp.is_none_or(|pulp| fibre.pulp == pulp));
        of_pulp.map(SheetFibre::mass_ug).sum::<f64>()
    };
    assert!(mass(None) > 0.3 * total);
    for (pulp, share) in [0.55, 0.3, 0.15].iter().enumerate() {
        // the share of the one behind is made up within one fibre
        let heaviest = sheet
            .fibres
            .iter()
            .map(SheetFibre::mass_ug)
            .fold(0.0, f64::max);
        assert!((mass(Some(pulp)) - share * mass(None)).abs() < heaviest);
    }
}

#[test]
fn every_point_is_in_the_sheet_and_cut_ends_are_on_its_edges() {
    for plan in [random, deposited].map(|plan| plan([900.0, 600.0], 30.0, mixture())) {
        let sheet = lay(&plan, 5);
        let (mut left, mut right) = (0, 0);
        for fibre in &sheet.fibres {
            for point in &fibre.centre_line_um {
                assert!((0.0..=900.0).contains(&point[0]) && (0.0..=600.0).contains(&point[1]));
            }
            let ends = [fibre.centre_line_um.first(), fibre.centre_line_um.last()];
            for end in ends.into_iter().flatten() {
                left += usize::from(end[0] <= 0.0);
                right += usize::from(end[0] >= 900.0);
            }
        }
        // Λ/(π L) fibres cross a line across a uniform sheet: about 20 on an edge of 600 µm
        assert!(left > 5 && right > 5, "{left} {right}");
    }
}

#[test]
fn a_seed_gives_the_same_sheet_on_any_number_of_threads() {
    let plan = deposited([600.0, 450.0], 30.0, mixture());
    let sheet = lay(&plan, 8);
    for threads in [2, 3] {
        let team = Team::new(threads).expect("there are threads");
        assert_eq!(plan.lay(8, &team).expect("the plan is good"), sheet);
    }
    assert_ne!(lay(&plan, 9).fibres, sheet.fibres);
}

#[test]
fn whole_fibres_have_their_length_and_their_shape_factor() {
    for plan in
        [random, deposited].map(|plan| plan([3000.0; 2], 10.0, vec![softwood(fixed(600.0))]))
    {
        let fibres = plan
            .lay_fibres(1, &Uninterrupted)
            .expect("the plan is good");
        let mut whole = 0;
        // the last two end where the mass does
        for fibre in &fibres[..fibres.len() - 2] {
            let line = &fibre.centre_line_um;
            let [first, last] = [line[0], line[line.len() - 1]];
            let is_cut = [first, last]
                .iter()
                .any(|end| (0..2).any(|axis| end[axis] <= 0.0 || end[axis] >= 3000.0));
            if is_cut {
                continue;
            }
            whole += 1;
            // both ends may be joined across a bend, a tenth of a segment of 28 or 7 µm that is not
            // climbed at a slope of 0.3: 2 · 0.7 · (√1.09 − 1) = 0.06 µm
            let off = fibre.length_um() - 600.0;
            assert!(off.abs() < 0.07, "{off}");
            if matches!(plan.placement, Placement::Random3d { .. }) {
                let chord = polyline::distance(first, last);
                // ψ²/(6 N²) of 22 segments is 1.7e-4
                assert!(
                    (chord / 600.0 / 0.92 - 1.0).abs() < 2e-4,
                    "{}",
                    chord / 600.0
                );
            }
        }
        assert!(whole > 300, "{whole}");
    }
}

/// The sheet is a window on an endless one: its edges are as dense as its middle.
#[test]
fn fibres_are_as_dense_at_the_edges_as_in_the_middle() {
    let plan = SheetPlan {
        segment_um: Some(20.0),
        ..random([1000.0, 1000.0], 10.0, vec![softwood(fixed(800.0))])
    };
    let (mut edge, mut corner) = (Vec::new(), Vec::new());
    for seed in 0..24 {
        let sheet = lay(&plan, seed);
        let whole: f64 = sheet.fibres.iter().map(SheetFibre::length_um).sum();
        let share = |from: [f64; 2], size: [f64; 2]| {
            let lengths = sheet.fibres.iter().flat_map(|fibre| {
                let moved = fibre.centre_line_um.iter();
                let moved: Vec<[f64; 3]> = moved
                    .map(|[x, y, z]| [x - from[0], y - from[1], *z])
                    .collect();
                polyline::cut(&moved, size)
            });
            let lengths = lengths.map(|piece| polyline::length(&piece.points));
            lengths.sum::<f64>() / whole
        };
        edge.push(share([0.0, 0.0], [100.0, 1000.0]) + share([900.0, 0.0], [100.0, 1000.0]));
        corner.push(share([0.0, 0.0], [300.0, 300.0]));
    }
    // pieces shorter than a fibre is wide were left out: a fifth of a per cent of an edge's length,
    // W²/(2 π L) of its 100 µm
    assert_mean(&edge, 0.2);
    assert_mean(&corner, 0.09);
}

#[test]
fn directions_have_the_moments_of_their_distribution_however_edges_cut() {
    let straight = Pulp {
        shape_factor: 1.0,
        ..softwood(fixed(1000.0))
    };
    // I₁(κ)/I₀(κ)
    for (kappa, expected) in [(0.0, 0.0), (1.0, 0.446_389_965), (3.0, 0.809_985_3)] {
        let plan = SheetPlan {
            orientation: Orientation::VonMises { kappa },
            segment_um: Some(100.0),
            ..random([1500.0, 800.0], 20.0, vec![straight.clone()])
        };
        let anisotropies: Vec<f64> = (0..10)
            .map(|seed| {
                Statistics::of(&lay(&plan, seed), 10)
                    .expect("fibres")
                    .anisotropy
            })
            .collect();
        assert_mean(&anisotropies, expected);
    }
}

#[test]
fn log_normal_lengths_have_the_mean_and_nearly_the_variation_asked_for() {
    use loadframe_harness::rng::{Purpose, Streams};
    let pulp = softwood(LengthDistribution::LogNormal {
        mean_um: 2000.0,
        variation: 0.4,
    });
    pulp.validate(0).expect("the pulp is good");
    let streams = Streams::new(1, Purpose::FibreSizes);
    let lengths: Vec<f64> = (0..40_000)
        .map(|index| pulp.draw(&mut streams.of(index)).length_um)
        .collect();
    assert_mean(&lengths, 2000.0);
    let variation = Sample::of(&lengths)
        .and_then(|sample| sample.deviation)
        .map(|s| s / 2000.0);
    // the cut at 3 σ takes away 3 % of it
    assert!((0.38..0.4).contains(&variation.expect("there are several")));
    assert!(lengths.iter().all(|length| *length <= pulp.longest_um()));
}

#[test]
fn measured_fibres_keep_their_width_and_the_density_of_the_wall() {
    let sheet = lay(&random([1500.0, 1500.0], 20.0, mixture()), 2);
    let density = |section: FibreSection| {
        section.coarseness_ug_per_um / wall_area_um2(section.width_um, section.wall_um)
    };
    let nominal = 1e-4 / wall_area_um2(18.0, 3.0);
    let mut widths = [0; 3];
    for fibre in sheet.fibres.iter().filter(|fibre| fibre.pulp == 1) {
        assert!((density(fibre.section) / nominal - 1.0).abs() < ROUNDING);
        let width = fibre.section.width_um;
        let known = [15.0, 20.0, 12.0]
            .iter()
            .position(|known: &f64| (known - width).abs() < 1e-9);
        widths[known.expect("it is one of the three")] += 1;
    }
    assert!(widths.iter().all(|count| *count > 20), "{widths:?}");
}

#[test]
fn a_collapsed_fibre_has_the_area_of_its_wall() {
    let pulp = softwood(fixed(1000.0));
    assert!((pulp.section().thickness_um - PI * 52.0 / 28.0).abs() < 1e-12);
    let tube = Pulp {
        lumen: Lumen::Open,
        ..pulp
    };
    assert!((tube.section().thickness_um - 28.0).abs() < 1e-12);
}

#[test]
fn what_is_expected_is_what_is_laid() {
    let plan = random([4000.0, 2500.0], 20.0, vec![softwood(fixed(1000.0))]);
    let expected = plan.expected();
    let sheet = lay(&plan, 4);
    let off = sheet.fibres.len() as f64 / expected.fibres - 1.0;
    // curled fibres are a little shorter across, and sliver pieces are left out
    assert!(off.abs() < 0.05, "{off}");
    let points: usize = sheet
        .fibres
        .iter()
        .map(|fibre| fibre.centre_line_um.len())
        .sum();
    assert!((points as f64 / expected.points - 1.0).abs() < 0.05);
}
