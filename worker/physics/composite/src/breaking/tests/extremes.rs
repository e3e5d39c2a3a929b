//! What is refused, what ends, what repeats.
use super::*;
use crate::load::{Load, LoadPlace};
use crate::section::Fibre;
use crate::tests::{isotropic, plain};

/// A plate with a fibre across, a weak face and scatter: many events of every kind.
fn scattered(seed: u64) -> Case {
    let mut section = plain([8.0, 4.0], isotropic(3_000.0, 0.35), 0.0);
    let mut second = section.materials[0];
    second.material = isotropic(70_000.0, 0.2);
    section.materials.push(second);
    let fibre = |x, angle_deg| Fibre {
        material: 1,
        through_mm: [x, 2.0],
        angle_deg,
        thickness_mm: 0.5,
        length_mm: Some(3.0),
    };
    section.fibres = vec![fibre(2.0, 90.0), fibre(5.5, 30.0)];
    let matrix = MaterialStrength {
        bulk: Strength {
            tension: tough(60.0, 0.5),
            compression: tough(150.0, 5.0),
            ..Strength::default()
        },
        interface: None,
    };
    let fibre = MaterialStrength {
        bulk: Strength {
            tension: brittle(900.0),
            ..Strength::default()
        },
        interface: Some(InterfaceStrength {
            normal: tough(25.0, 0.1).unwrap(),
            shear: tough(40.0, 0.6).unwrap(),
        }),
    };
    let mut case = Case::pulled(&section, [16, 8], 1.0, &[matrix, fibre]);
    case.options.seed = seed;
    case.options.scatter = Some(Scatter {
        law: ScatterLaw::Weibull { modulus: 8.0 },
        reference_volume_mm3: Some(0.25),
    });
    case
}

#[test]
fn low_rank_corrections_and_new_factors_give_the_same_events() {
    let case = scattered(3);
    let (carried, _) = broken(&mut case.breaking());
    let mut fresh = case.carrying(0);
    let (factored, _) = broken(&mut fresh);
    assert_eq!(fresh.factors() as usize, factored.len() + 1);
    assert_eq!(carried.len(), factored.len());
    assert!(carried.len() >= 100, "{}", carried.len());
    let is_face = |event: &&Event| matches!(event.part, BrokenPart::Interface(_));
    let faces = carried.iter().filter(is_face).count();
    assert!((20..carried.len() - 20).contains(&faces), "{faces}");
    for (a, b) in carried.iter().zip(&factored) {
        assert_eq!((a.cell, a.part, a.tooth), (b.cell, b.part, b.tooth));
        assert!((a.factor / b.factor - 1.0).abs() < 1e-8, "{a:?} {b:?}");
    }
    assert!(imbalance(&carried) < BALANCE, "{}", imbalance(&carried));
}

#[test]
fn a_state_goes_on_with_the_same_bytes() {
    let case = scattered(4);
    let mut whole = case.breaking();
    let (events, _) = broken(&mut whole);
    let total = events.len();
    for stop in [0, 1, total / 3, total / 2, total - 1] {
        let mut begun = case.breaking();
        for _ in 0..stop {
            begun.advance().unwrap();
        }
        let bytes = postcard::to_stdvec(&begun.state()).unwrap();
        let state: BreakingState = postcard::from_bytes(&bytes).unwrap();
        // into one that has gone elsewhere meanwhile
        let mut resumed = case.breaking();
        for _ in 0..7 {
            resumed.advance().unwrap();
        }
        resumed.resume(state).unwrap();
        assert_eq!(resumed.displacements_mm(), begun.displacements_mm());
        assert_eq!(resumed.damage(), begun.damage());
        let (rest, _) = broken(&mut resumed);
        let text = |events: &[Event]| format!("{events:?}");
        assert_eq!(text(&rest), text(&events[stop..]));
        assert_eq!(resumed.totals(), whole.totals());
    }
    let other = Case::pulled(
        &plain([1.0, 1.0], isotropic(1.0, 0.0), 0.0),
        [1, 1],
        1.0,
        &[in_tension(brittle(1.0))],
    );
    assert!(other.breaking().resume(whole.state()).is_err());
}

#[test]
fn the_same_seed_draws_the_same_and_another_one_differently() {
    let run = |seed| broken(&mut scattered(seed).breaking()).0;
    let (first, again, other) = (run(5), run(5), run(6));
    assert_eq!(format!("{first:?}"), format!("{again:?}"));
    assert_ne!(first[0].factor.to_bits(), other[0].factor.to_bits());
}

fn plate(strength: MaterialStrength, cells: [usize; 2]) -> Case {
    let section = plain([2.0, 1.0], isotropic(1_000.0, 0.0), 0.0);
    Case::pulled(&section, cells, 1.0, &[strength])
}

#[test]
fn what_has_no_meaning_is_refused_by_name() {
    for (limit, energy) in [
        (0.0, None),
        (-1.0, None),
        (f64::NAN, None),
        (1.0, Some(0.0)),
    ] {
        let case = plate(
            in_tension(Some(Limit {
                limit,
                fracture_energy_n_per_mm: energy,
            })),
            [2, 1],
        );
        let refused = case.refused();
        assert!(refused.contains("tens"), "{refused}");
    }
    let mut case = plate(UNBREAKABLE, [2, 1]);
    case.strengths[0].bulk.shear = brittle(3.0);
    assert!(case.refused().contains("isotropic"));
    // 2 E G / f² = 2 · 1000 · 0.01 / 10² = 0.2 mm
    let case = plate(in_tension(tough(10.0, 0.01)), [4, 2]);
    let refused = case.refused();
    assert!(
        refused.contains("0.5 mm wide") && refused.contains("at most 0.2"),
        "{refused}"
    );
    assert!(
        Breaking::new(
            plate(in_tension(tough(10.0, 0.01)), [10, 5]).specimen(),
            BreakingOptions::default()
        )
        .is_ok()
    );

    let good = || plate(in_tension(brittle(1.0)), [2, 1]);
    let refused = |change: fn(&mut Case)| {
        let mut case = good();
        change(&mut case);
        case.refused()
    };
    assert!(refused(|case| case.strengths.clear()).contains("strengths"));
    assert!(refused(|case| case.options.teeth = 0).contains("teeth"));
    assert!(refused(|case| case.options.teeth = 1_001).contains("teeth"));
    assert!(refused(|case| case.options.stop.force_fraction = 1.0).contains("peak"));
    assert!(refused(|case| case.options.stop.displacement_mm = Some(0.0)).contains("displacement"));
    assert!(refused(|case| case.load_n[4] = f64::INFINITY).contains("load"));
    assert!(refused(|case| case.load_n[5] = 1.0).contains("one factor"));
    assert!(refused(|case| case.supports = Supports::none(case.layout.grid())).contains("neither"));
    assert!(
        refused(|case| {
            case.supports = Supports::none(case.layout.grid());
            case.load_n[5] = 1.0;
        })
        .contains("supports let")
    );
    assert!(refused(|case| case.load_n.push(0.0)).contains("another lattice"));
    let other = || plate(UNBREAKABLE, [3, 1]).supports;
    let mut case = good();
    case.supports = other();
    assert!(case.refused().contains("another lattice"));
    let scatter = |law, reference_volume_mm3| {
        let mut case = good();
        case.options.scatter = Some(Scatter {
            law,
            reference_volume_mm3,
        });
        case.refused()
    };
    assert!(scatter(ScatterLaw::Weibull { modulus: 0.1 }, None).contains("0.5 to 1000"));
    assert!(scatter(ScatterLaw::Weibull { modulus: 9.0 }, Some(0.0)).contains("volume"));
    assert!(scatter(ScatterLaw::LogNormal { sigma: -1.0 }, None).contains("deviation"));
    assert!(scatter(ScatterLaw::LogNormal { sigma: 0.1 }, Some(1.0)).contains("absent"));
}

#[test]
fn the_unbreakable_ends_with_a_reason() {
    let case = plate(UNBREAKABLE, [3, 2]);
    let mut breaking = case.breaking();
    for _ in 0..2 {
        let advance = breaking.advance().unwrap();
        assert_eq!(advance, Advance::Ended(EndReason::NothingBreaks));
    }
    assert_eq!(breaking.totals().events, 0);
    assert!(breaking.displacements_mm().iter().all(|u| *u == 0.0));
    // what bears tension only is not broken by pressure
    let section = plain([2.0, 1.0], isotropic(1_000.0, 0.0), 0.0);
    let case = Case::pulled(&section, [3, 2], -1.0, &[in_tension(brittle(5.0))]);
    let advance = case.breaking().advance().unwrap();
    assert_eq!(advance, Advance::Ended(EndReason::NothingBreaks));
}

#[test]
fn one_cell_breaks_once_and_wholly() {
    let case = plate(in_tension(brittle(10.0)), [1, 1]);
    let mut breaking = case.breaking();
    let (events, reason) = broken(&mut breaking);
    assert_eq!(reason, EndReason::NothingBreaks);
    assert_eq!(events.len(), 1);
    assert!((events[0].force_n - 10.0).abs() < 1e-9);
    assert!((events[0].displacement_mm - 10.0 / 1_000.0 * 2.0).abs() < 1e-12);
    // all that it held: ½ · 10² / 1000 · 2 mm³
    assert!((events[0].energy_released_n_mm - 0.1).abs() < 1e-6);
    let totals = breaking.totals();
    assert!(totals.energy_follows_grid);
    assert_eq!(totals.broken_cells, 1);
    assert!((totals.crack_area_mm2 - 1.0).abs() < 1e-12);
    assert_eq!(breaking.damage(), [1.0]);
}

#[test]
fn forces_break_as_displacements_do() {
    let strength = in_tension(tough(10.0, 0.4));
    let driven = plate(strength, [4, 2]);
    let mut pushed = plate(strength, [4, 2]);
    let grid = pushed.layout.grid();
    let mut supports = Supports::of_faces(grid, &[(Face::Left, FaceSupport::Rolling)]).unwrap();
    supports.hold(grid, 0, 1, 0.0).unwrap();
    pushed.supports = supports;
    let load = Load {
        force_n: [3.0, 0.0],
        on: LoadPlace::Face(Face::Right),
    };
    let lattice = Lattice::exact(&pushed.layout);
    load.add_to(&lattice, &mut pushed.load_n).unwrap();
    pushed.options.stop.events = 1;
    let (by_force, reason) = broken(&mut pushed.breaking());
    assert_eq!(reason, EndReason::Events);
    let event = by_force[0];
    assert!((event.force_n - 10.0).abs() < 1e-9 && (event.factor - 10.0 / 3.0).abs() < 1e-9);
    let other = broken(&mut driven.breaking()).0[0];
    assert!((event.displacement_mm - other.displacement_mm).abs() < 1e-12);
    assert!((event.elastic_n_mm - other.elastic_n_mm).abs() < 1e-12);
    // to the end, where little is left to hold the force
    pushed.options.stop.events = 1_000;
    let (events, _) = broken(&mut pushed.breaking());
    assert!(imbalance(&events) < BALANCE, "{}", imbalance(&events));
}

#[test]
fn a_huge_scatter_and_a_cap_of_events_end() {
    let section = plain([2.0, 1.0], isotropic(1_000.0, 0.2), 0.0);
    // the mean square is 6 and 8100 times the mean's: so much more energy keeps the cells fine enough
    for (law, energy) in [
        (ScatterLaw::Weibull { modulus: 0.5 }, 0.1),
        (ScatterLaw::LogNormal { sigma: 3.0 }, 100.0),
    ] {
        let mut case = Case::pulled(&section, [12, 6], 1.0, &[in_tension(tough(5.0, energy))]);
        case.options.scatter = Some(Scatter {
            law,
            reference_volume_mm3: None,
        });
        case.options.stop.force_fraction = 0.0;
        let mut breaking = case.breaking();
        let (events, reason) = broken(&mut breaking);
        // the weakest first, then far stronger ones, until nothing is left
        assert!(matches!(
            reason,
            EndReason::NothingBreaks | EndReason::ForceFell
        ));
        assert!(events.len() > 100 && peak(&events) > 3.0 * events[0].force_n);
        assert!(imbalance(&events) < BALANCE, "{}", imbalance(&events));
    }
    let mut case = Case::pulled(&section, [12, 6], 1.0, &[in_tension(tough(5.0, 10.0))]);
    case.options.stop.events = 25;
    let (events, reason) = broken(&mut case.breaking());
    assert_eq!((events.len(), reason), (25, EndReason::Events));
}
