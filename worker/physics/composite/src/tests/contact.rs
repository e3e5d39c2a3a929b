//! Rollers against beams on several supports, and the inequalities themselves.
use super::plies::stacked;
use super::sections::{forces, isotropic, plain, uniform};
use proptest::prelude::*;

use crate::error::CompositeError;
use crate::lattice::{Geometry, Lattice};
use crate::load::LoadPlace;
use crate::measure::point_mm;
use crate::section::Division;
use crate::solve::{
    PressedRoller, Roller, StaticOptions, contact_equilibrium, pressed_equilibrium,
};
use crate::supports::{Face, FaceSupport, Supports};

pub(super) fn roller(face: Face, at_mm: f64, radius_mm: f64) -> Roller {
    Roller {
        face,
        at_mm,
        radius_mm,
    }
}

/// Rollers at rest under the bottom face.
fn under(places: &[f64]) -> Vec<PressedRoller> {
    places
        .iter()
        .map(|&at_mm| PressedRoller {
            roller: roller(Face::Bottom, at_mm, 2.0),
            advance_mm: 0.0,
        })
        .collect()
}

/// Held along x in the middle of the left face only.
fn kept_from_sliding(lattice: &Lattice) -> Supports {
    let grid = lattice.grid();
    let mut supports = Supports::none(grid);
    let particle = grid.particle(0, grid.rows() / 2);
    supports.hold(grid, particle, 0, 0.0).unwrap();
    supports
}

#[test]
fn rollers_carry_what_presses_and_the_force_found_is_that_of_the_advance() {
    let section = stacked(60.0, 2.0, &[0.0, 90.0, 90.0, 0.0]);
    let lattice = Lattice::exact(
        &section
            .layout(Division::Graded {
                cells: [120, 8],
                across: 2,
            })
            .unwrap(),
    );
    let supports = kept_from_sliding(&lattice);
    let load = vec![0.0; lattice.displacements()];
    let options = StaticOptions::default();
    let resting = under(&[10.0, 50.0]);
    let pressing = roller(Face::Top, 30.0, 5.0);
    let driven = pressed_equilibrium(
        &lattice,
        &supports,
        &load,
        &resting,
        &[pressing],
        20.0,
        &options,
    )
    .unwrap();
    let [left, right, above] = [0, 1, 2].map(|place| driven.rollers[place]);
    assert!((left.force_n - 10.0).abs() < 1e-8 && (right.force_n - 10.0).abs() < 1e-8);
    assert!((above.force_n - 20.0).abs() < 1e-8);
    assert!(driven.equilibrium.reaction_error < 1e-10);
    // Symmetric, and nothing pushes along x.
    assert!((left.half_width_mm - right.half_width_mm).abs() < 1e-6);
    let held = lattice.grid().particle(0, lattice.grid().rows() / 2);
    assert!(driven.equilibrium.reactions_n[2 * held].abs() < 1e-9);

    let mut rollers = resting;
    rollers.push(PressedRoller {
        roller: pressing,
        advance_mm: above.advance_mm,
    });
    let moved = contact_equilibrium(&lattice, &supports, &load, &rollers, &options).unwrap();
    assert!((moved.rollers[2].force_n / 20.0 - 1.0).abs() < 1e-8);
    let apart = driven
        .equilibrium
        .displacements_mm
        .iter()
        .zip(&moved.equilibrium.displacements_mm)
        .fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(apart < 1e-9);
}

#[test]
fn a_roller_that_would_pull_lets_go_and_touches_again_when_pressed() {
    let lattice = uniform(&plain([100.0, 2.0], isotropic(1_000.0, 0.3), 0.0), [200, 4]);
    let supports = kept_from_sliding(&lattice);
    let none = vec![0.0; lattice.displacements()];
    let options = StaticOptions::default();
    let resting = under(&[20.0, 50.0, 80.0]);
    // In the middle of the first span: a bonded third support would pull.
    let one = pressed_equilibrium(
        &lattice,
        &supports,
        &none,
        &resting,
        &[roller(Face::Top, 35.0, 5.0)],
        1.0,
        &options,
    )
    .unwrap();
    let carried: Vec<f64> = one.rollers.iter().map(|roller| roller.force_n).collect();
    assert!((carried[0] - 0.5).abs() < 1e-6 && (carried[1] - 0.5).abs() < 1e-6);
    assert!(carried[2] == 0.0);
    assert_eq!(
        (one.rollers[2].particles, one.rollers[2].between_mm),
        (0, None)
    );
    // Loaded in both spans it is a beam on three supports: 5/16, 11/8 and 5/16 of each force.
    let both = pressed_equilibrium(
        &lattice,
        &supports,
        &none,
        &resting,
        &[roller(Face::Top, 35.0, 5.0), roller(Face::Top, 65.0, 5.0)],
        2.0,
        &options,
    )
    .unwrap();
    for (place, expected) in [(0, 0.3125), (1, 1.375), (2, 0.3125)] {
        let found = both.rollers[place].force_n;
        assert!((found - expected).abs() < 0.01, "{place} {found}");
    }
    // The free end rises by F L²/(16 EI) times its length; a roller raised beyond touches again and
    // bends it back by c² (L + c) / (3 EI) for each of its newtons.
    let bending = 1_000.0 * 8.0 / 12.0;
    let rise = 0.1 * 30.0_f64.powi(2) / (16.0 * bending) * 30.0;
    let flexible = 30.0_f64.powi(2) * 60.0 / (3.0 * bending);
    let mut raised = resting.clone();
    raised[2].advance_mm = 0.4;
    let again = pressed_equilibrium(
        &lattice,
        &supports,
        &none,
        &raised,
        &[roller(Face::Top, 35.0, 5.0)],
        0.1,
        &options,
    )
    .unwrap();
    let expected = (0.4 - rise) / flexible;
    let found = again.rollers[2].force_n;
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    // And one that has drawn back never does.
    let mut lowered = under(&[20.0, 50.0, 80.0]);
    lowered[2].advance_mm = -30.0;
    let load = forces(&lattice, [0.0, -1.0], LoadPlace::Point([35.0, 2.0]));
    let far = contact_equilibrium(&lattice, &supports, &load, &lowered, &options).unwrap();
    assert_eq!(far.rollers[2].particles, 0);
    assert!((far.rollers[0].force_n + far.rollers[1].force_n - 1.0).abs() < 1e-9);
}

/// A strip bent as sharply as the roller leaves it in the middle and lies on two lines: with the
/// moment EI/R where it lets go, F/2 (L/2 - c) = EI/R.
#[test]
fn a_thin_strip_wraps_around_a_roller_and_leaves_its_crown() {
    let (e, length, height, radius, span) = (1_000.0, 110.0, 1.0, 200.0, 100.0);
    let lattice = uniform(&plain([length, height], isotropic(e, 0.3), 0.0), [440, 4]);
    let supports = kept_from_sliding(&lattice);
    let load = vec![0.0; lattice.displacements()];
    let bending = e * height.powi(3) / 12.0;
    let half = 10.0;
    let force = 2.0 * bending / (radius * (span / 2.0 - half));
    let found = pressed_equilibrium(
        &lattice,
        &supports,
        &load,
        &under(&[5.0, 105.0]),
        &[roller(Face::Top, 55.0, radius)],
        force,
        &StaticOptions::default(),
    )
    .unwrap();
    let contact = found.rollers[2];
    let [from, to] = contact.between_mm.unwrap();
    // The lattice's pitch, and the height over which a force on a line spreads.
    assert!(
        (0.5 * (to - from) - half).abs() < 0.25 + 0.5 * height,
        "{contact:?}"
    );
    let crown = point_mm(
        lattice.grid(),
        [55.0, height],
        &found.equilibrium.displacements_mm,
    )
    .unwrap()[1];
    assert!(-crown > contact.advance_mm, "the strip leaves the crown");
    let in_reach = (2.0 * half / 0.25) as usize;
    assert!(contact.particles < in_reach / 2, "{contact:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the heights of the rollers and the places of the loads: as long as the resultant falls
    /// between the outermost ones the beam comes to rest, and what holds it is what it bears.
    #[test]
    fn a_beam_laid_on_uneven_rollers_comes_to_rest(
        heights in prop::collection::vec(-1.0..1.0_f64, 2..6),
        loads in prop::collection::vec((25.0..75.0_f64, 0.01..1.0_f64), 1..4),
    ) {
        let lattice = uniform(&plain([100.0, 2.0], isotropic(1_000.0, 0.3), 0.0), [50, 2]);
        let supports = kept_from_sliding(&lattice);
        let step = 60.0 / (heights.len() - 1) as f64;
        let rollers: Vec<PressedRoller> = heights
            .iter()
            .enumerate()
            .map(|(place, &advance_mm)| PressedRoller {
                roller: roller(Face::Bottom, 20.0 + step * place as f64, 3.0),
                advance_mm,
            })
            .collect();
        let mut load = vec![0.0; lattice.displacements()];
        for &(at, force) in &loads {
            let part = forces(&lattice, [0.0, -force], LoadPlace::Point([at, 2.0]));
            for (sum, part) in load.iter_mut().zip(part) {
                *sum += part;
            }
        }
        let found =
            contact_equilibrium(&lattice, &supports, &load, &rollers, &StaticOptions::default());
        let found = found.map_err(|error| TestCaseError::fail(error.to_string()))?;
        let total: f64 = loads.iter().map(|(_, force)| force).sum();
        let moment: f64 = loads.iter().map(|(at, force)| at * force).sum();
        let carried: f64 = found.rollers.iter().map(|r| r.force_n).sum();
        let turned: f64 = found.rollers.iter().map(|r| r.force_n * r.centre_mm).sum();
        prop_assert!((carried / total - 1.0).abs() < 1e-7);
        prop_assert!((turned / moment - 1.0).abs() < 1e-7);
        prop_assert!(found.rollers.iter().all(|r| r.force_n > -1e-7 * total));

        // The first load by a roller that presses as hard. Alone on one particle right above another
        // that bears all, it would leave the beam in balance and free to turn.
        let (at, force) = loads[0];
        let balanced = rollers.iter().any(|r| (r.roller.at_mm - at).abs() < 4.0);
        prop_assume!(loads.len() > 1 || !balanced);
        for (sum, part) in load
            .iter_mut()
            .zip(forces(&lattice, [0.0, force], LoadPlace::Point([at, 2.0])))
        {
            *sum += part;
        }
        let pressing = [roller(Face::Top, at, 5.0)];
        let options = StaticOptions::default();
        let found =
            pressed_equilibrium(&lattice, &supports, &load, &rollers, &pressing, force, &options);
        let found = found.map_err(|error| TestCaseError::fail(error.to_string()))?;
        let (above, below) = found.rollers.split_last().unwrap();
        let carried: f64 = below.iter().map(|r| r.force_n).sum();
        let turned: f64 = below.iter().map(|r| r.force_n * r.centre_mm).sum();
        prop_assert!((above.force_n / force - 1.0).abs() < 1e-7);
        prop_assert!((carried / total - 1.0).abs() < 1e-7);
        let moment = moment + force * (above.centre_mm - at);
        prop_assert!((turned / moment - 1.0).abs() < 1e-7);
    }
}

#[test]
fn a_roller_on_the_side_is_one_on_the_top_of_the_section_turned() {
    let lattice = uniform(&plain([12.0, 12.0], isotropic(1_000.0, 0.3), 0.0), [24, 24]);
    let load = vec![0.0; lattice.displacements()];
    let found = [
        (Face::Top, Face::Bottom),
        (Face::Bottom, Face::Top),
        (Face::Left, Face::Right),
        (Face::Right, Face::Left),
    ]
    .map(|(pressed, clamped)| {
        let supports =
            Supports::of_faces(lattice.grid(), &[(clamped, FaceSupport::Clamped)]).unwrap();
        pressed_equilibrium(
            &lattice,
            &supports,
            &load,
            &[],
            &[roller(pressed, 5.0, 50.0)],
            60.0,
            &StaticOptions::default(),
        )
        .unwrap()
        .rollers[0]
    });
    assert!(found[0].particles > 4, "{found:?}");
    for other in &found[1..] {
        assert_eq!(other.particles, found[0].particles);
        assert!((other.advance_mm / found[0].advance_mm - 1.0).abs() < 1e-9);
        assert!((other.centre_mm - found[0].centre_mm).abs() < 1e-9);
        assert!((other.force_n - 60.0).abs() < 1e-7);
    }
}

#[test]
fn rollers_that_cannot_be_are_refused() {
    let lattice = uniform(&plain([40.0, 4.0], isotropic(1_000.0, 0.3), 0.0), [40, 4]);
    let supports = kept_from_sliding(&lattice);
    let load = forces(&lattice, [0.0, -1.0], LoadPlace::Point([20.0, 4.0]));
    let pressed = |rollers: &[PressedRoller], supports: &Supports, options: &StaticOptions| {
        contact_equilibrium(&lattice, supports, &load, rollers, options).unwrap_err()
    };
    let linear = StaticOptions::default();
    let two = under(&[10.0, 30.0]);
    let large = StaticOptions {
        geometry: Geometry::Large,
        ..linear
    };
    assert_eq!(
        pressed(&two, &supports, &large),
        CompositeError::LargeContact
    );
    assert!(matches!(
        pressed(&under(&[10.0, 13.9]), &supports, &linear),
        CompositeError::RollersOverlap { first: 0, second: 1, least_mm, .. } if (least_mm - 4.0).abs() < 1e-12
    ));
    assert!(matches!(
        pressed(&under(&[10.0, 41.0]), &supports, &linear),
        CompositeError::OutsideSection { what: "a roller", x_mm, .. } if (x_mm - 41.0).abs() < 1e-12
    ));
    let clamped =
        Supports::of_faces(lattice.grid(), &[(Face::Bottom, FaceSupport::Clamped)]).unwrap();
    assert!(matches!(
        pressed(&two, &clamped, &linear),
        CompositeError::RollerOnSupport { roller: 0, .. }
    ));
    let mut thin = two.clone();
    thin[1].roller = roller(Face::Bottom, 30.5, 0.1);
    assert!(
        pressed(&thin, &supports, &linear)
            .to_string()
            .contains("refine")
    );
    thin[1].roller.radius_mm = -1.0;
    assert!(
        pressed(&thin, &supports, &linear)
            .to_string()
            .contains("radius")
    );
    let pushed = pressed_equilibrium(&lattice, &supports, &load, &two, &[], 1.0, &linear);
    assert!(
        pushed
            .unwrap_err()
            .to_string()
            .contains("rollers that press")
    );
    // One roller does not keep a beam from turning.
    assert!(matches!(
        pressed(&two[..1], &supports, &linear),
        CompositeError::Unsupported { .. }
    ));
    // Pulled off its rollers the beam is loose.
    let upward = forces(&lattice, [0.0, 1.0], LoadPlace::Point([20.0, 4.0]));
    assert!(matches!(
        contact_equilibrium(&lattice, &supports, &upward, &two, &linear),
        Err(CompositeError::Unsupported { .. })
    ));
}
