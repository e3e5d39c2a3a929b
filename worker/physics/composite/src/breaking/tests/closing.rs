//! Cracks that close: what is pushed after it was pulled, and bent back.
use super::bars::{MODULUS, STRENGTH, bar, weak_bar};
use super::*;

const LENGTH: f64 = 9.0;
const HEIGHT: f64 = 2.0;

/// The cracks of another drive's test under this one.
fn after(case: &Case, state: &BreakingState) -> Breaking {
    let mut breaking = case.breaking();
    breaking.resume(state.clone()).unwrap();
    breaking.meet().unwrap();
    breaking
}

/// Force over displacement of the drive.
fn stiffness(breaking: &Breaking) -> f64 {
    let [way, force] = breaking.system.response();
    force / way
}

#[test]
fn a_bar_that_was_pulled_apart_is_whole_when_it_is_pushed() {
    let mut case = weak_bar(LENGTH, 4, 9, 0.8);
    let mut breaking = case.breaking();
    broken(&mut breaking);
    // what is left of the open column, a millionth or less, in a row with eight whole ones
    assert!(stiffness(&breaking) < 1e-4 * MODULUS * HEIGHT / LENGTH);
    let state = breaking.state();
    let grid = case.layout.grid();
    let faces = [
        (Face::Left, FaceSupport::Rolling),
        (Face::Right, FaceSupport::PerAxis([Some(-1.0), None])),
    ];
    case.supports = Supports::of_faces(grid, &faces).unwrap();
    case.supports.hold(grid, 0, 1, 0.0).unwrap();
    let mut pushed = after(&case, &state);
    // EA/L, to the last digits; it has no strength that pressure could reach
    let whole = MODULUS * HEIGHT / LENGTH;
    assert!((stiffness(&pushed) / whole - 1.0).abs() < 1e-9);
    assert_eq!(pushed.totals().closed_cells, 4);
    assert_eq!(
        pushed.advance().unwrap(),
        Advance::Ended(EndReason::NothingBreaks)
    );
    // and pulled once more it is as it was
    let pulled = weak_bar(LENGTH, 4, 9, 0.8);
    let again = after(&pulled, &pushed.state());
    assert!((stiffness(&again) / stiffness(&breaking) - 1.0).abs() < 1e-6);
    assert_eq!(again.totals().closed_cells, 0);
}

const ROWS: usize = 8;

/// A bar whose right face moves by `push` [mm] and turns by an angle, its left one sliding; a column in its
/// middle is brittle.
fn turned(push_mm: f64, angle: f64) -> Case {
    let columns = 9;
    let brittle_column = in_tension(brittle(STRENGTH));
    let section = bar(LENGTH, HEIGHT, LENGTH / columns as f64);
    let strengths = [UNBREAKABLE, brittle_column];
    let mut case = Case::pulled(&section, [columns, ROWS], 1.0, &strengths);
    let grid = case.layout.grid();
    case.supports = Supports::of_faces(grid, &[(Face::Left, FaceSupport::Rolling)]).unwrap();
    case.supports.hold(grid, 0, 1, 0.0).unwrap();
    for (line, y) in grid.y_mm().iter().enumerate() {
        let way = push_mm + angle * (y - 0.5 * HEIGHT);
        let particle = grid.particle(columns, line);
        case.supports.hold(grid, particle, 0, way).unwrap();
    }
    case.options.stop.force_fraction = 0.0;
    case
}

/// ½ (EA δ² + EI θ²)/L [N mm].
fn whole_energy(push_mm: f64, angle: f64) -> f64 {
    let axial = MODULUS * HEIGHT * push_mm.powi(2);
    let bending = MODULUS * HEIGHT.powi(3) / 12.0 * angle.powi(2);
    0.5 * (axial + bending) / LENGTH
}

#[test]
fn a_beam_bent_back_closes_the_cracks_of_its_first_bending() {
    let mut case = turned(0.0, 0.01);
    case.options.stop.events = ROWS as u64 / 2;
    let mut breaking = case.breaking();
    let whole = breaking.system.energy();
    assert!((whole / whole_energy(0.0, 0.01) - 1.0).abs() < 1e-9);
    let (events, _) = broken(&mut breaking);
    assert_eq!(events.len(), ROWS / 2);
    let left = breaking.system.energy() / whole;
    assert!(left < 0.7, "{left}");
    let state = breaking.state();
    let back = after(&turned(0.0, -0.01), &state);
    assert!((back.system.energy() / whole - 1.0).abs() < 1e-9);
    assert_eq!(back.totals().closed_cells, events.len() as u64);
    let forth = after(&case, &back.state());
    assert!((forth.system.energy() / whole / left - 1.0).abs() < 1e-6);
}

/// A joint without tension is as good as none while the force stays within the kern: with N = EA δ/L and
/// M = EI θ/L, M/N ≤ h/6 is θ h/2 ≤ δ.
#[test]
fn a_bar_in_two_pieces_is_whole_while_the_force_stays_within_its_kern() {
    let mut breaking = turned(0.1, 0.0).breaking();
    let (events, _) = broken(&mut breaking);
    assert_eq!(events.len(), ROWS);
    let state = breaking.state();
    let push = 0.02;
    let edge = 2.0 * push / HEIGHT;
    for angle in [0.0, 0.5 * edge, 0.99 * edge, -0.99 * edge] {
        let pressed = after(&turned(-push, angle), &state);
        let energy = pressed.system.energy() / whole_energy(push, angle);
        assert!((energy - 1.0).abs() < 1e-9, "{angle} {energy}");
        assert_eq!(pressed.totals().closed_cells, ROWS as u64);
    }
    // beyond it one side opens, more of it the farther
    let (mut before, mut softer) = (ROWS as u64, 1.0 - 1e-3);
    for share in [1.5, 3.0, 10.0] {
        let angle = share * edge;
        let pressed = after(&turned(-push, angle), &state);
        assert_eq!(pressed.progress.turns_left, 0);
        let closed = pressed.totals().closed_cells;
        assert!(closed > 0 && closed < before, "{share} {closed}");
        before = closed;
        let energy = pressed.system.energy() / whole_energy(push, angle);
        assert!(energy < softer, "{share} {energy}");
        softer = energy;
        let stresses = pressed.stresses_mpa(pressed.system.displacements());
        let largest = stresses.iter().map(|s| s[0].abs()).fold(0.0, f64::max);
        let pulled = |row: usize| stresses[row * 9 + 4][0] / largest;
        assert!((0..ROWS).all(|row| pulled(row) < 1e-5));
    }
}
