//! Random fibres and the scatter of their cells.
use loadframe_harness::Uninterrupted;

use super::*;
use crate::error::CompositeError;

const RANDOM: Randomness = Randomness {
    fraction: 0.6,
    count: 30,
    diameter_mm: 0.007,
    gap_mm: 0.0002,
    seed: 1,
};

fn cell_of(random: &Randomness) -> UnitCell {
    let (fibres, size_mm) = fibre_places(random, &Uninterrupted).unwrap();
    UnitCell {
        size_mm,
        matrix: epoxy(),
        fibre: glass(),
        fibres,
    }
}

#[test]
fn random_fibres_fill_their_fraction_and_keep_their_gap() {
    for (fraction, gap_mm) in [(0.1, 0.001), (0.5, 0.0005), (0.7, 0.0), (0.7, 0.00045)] {
        for seed in [1, 2] {
            let random = Randomness {
                fraction,
                gap_mm,
                seed,
                ..RANDOM
            };
            let cell = cell_of(&random);
            assert_eq!(cell.fibres.len(), 30);
            assert!((cell.fraction() / fraction - 1.0).abs() < 1e-12);
            for (first, fibre) in cell.fibres.iter().enumerate() {
                assert!((0.0..cell.size_mm[0]).contains(&fibre.centre_mm[0]));
                for other in &cell.fibres[first + 1..] {
                    let apart = periodic(fibre.centre_mm, other.centre_mm, cell.size_mm);
                    assert!(apart >= 0.007 + gap_mm);
                }
            }
            // pixels hold as much fibre as the cell
            let effective = Pixels::new(&cell, [24; 2], [space(&epoxy()), space(&glass())]);
            let share = (0..effective.count())
                .map(|pixel| effective.fibre_share(pixel))
                .sum::<f64>()
                / effective.count() as f64;
            assert!((share / fraction - 1.0).abs() < 1e-9, "{share}");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_places_and_others_differ() {
    let places = |seed| {
        let random = Randomness { seed, ..RANDOM };
        fibre_places(&random, &Uninterrupted).unwrap().0
    };
    assert_eq!(places(3), places(3));
    assert_ne!(places(3), places(4));
}

#[test]
fn neighbours_touch_as_often_as_hard_discs_do() {
    // Contact value g = (1 - 7η/16)/(1 - η)² [Henderson1975]: at η = 1/2, 3.125. A thin ring of
    // 3 % of the diameter around a disc holds ρ 2π D 0.03 D (1 + 0.015) g̅ others, with ρ D² = 4η/π;
    // g falls by about twice its share across the ring: g̅ ≈ 0.96 g (known to a few percent).
    let mut pairs = 0.0;
    let (count, cells) = (150, 12);
    for seed in 0..cells {
        let cell = cell_of(&Randomness {
            fraction: 0.5,
            count,
            gap_mm: 0.0,
            seed,
            ..RANDOM
        });
        for (first, fibre) in cell.fibres.iter().enumerate() {
            for other in &cell.fibres[first + 1..] {
                let apart = periodic(fibre.centre_mm, other.centre_mm, cell.size_mm);
                pairs += f64::from(u8::from(apart < 1.03 * 0.007));
            }
        }
    }
    let pi = std::f64::consts::PI;
    let ring = (4.0 * 0.5 / pi) * 2.0 * pi * 0.03 * 1.015 * 0.96 * 3.125;
    let expected = 0.5 * ring * (count as f64) * (cells as f64);
    // 330 pairs: the root is 6 %
    assert!((pairs / expected - 1.0).abs() < 0.15, "{pairs} {expected}");
}

#[test]
fn fibres_that_find_no_room_are_refused() {
    let refused = |random| fibre_places(&random, &Uninterrupted).unwrap_err();
    for random in [
        Randomness {
            fraction: 0.71,
            ..RANDOM
        },
        Randomness {
            fraction: 0.0,
            ..RANDOM
        },
        Randomness { count: 0, ..RANDOM },
        Randomness {
            count: 1_001,
            ..RANDOM
        },
        Randomness {
            diameter_mm: 0.0,
            ..RANDOM
        },
        Randomness {
            gap_mm: -0.1,
            ..RANDOM
        },
        Randomness {
            gap_mm: 0.0015,
            ..RANDOM
        },
    ] {
        assert!(matches!(refused(random), CompositeError::OutOfRange { .. }));
    }
    // two in a square lie at most 1/√2 of its side apart and then fill π/4, less than 0.797
    let two = Randomness {
        fraction: 0.7,
        count: 2,
        gap_mm: 0.000_47,
        ..RANDOM
    };
    assert!(matches!(
        refused(two),
        CompositeError::NoRoom { count: 2, .. }
    ));
}
