//! Plies that part, against the energy release rate of beams.
use super::beams::{ARM_MM, ENERGY, LENGTH_MM, MODULUS, NOTCH_MM, STRENGTH, release_rate};
use super::*;
use crate::section::Ply;
use crate::tests::{isotropic, plain};

/// Two plies of equal height, apart from the left end to a notch, with so many columns and rows.
fn two_plies(cells: [usize; 2], notch_mm: f64, energy: [f64; 2]) -> Case {
    let mut section = plain([LENGTH_MM, 2.0 * ARM_MM], isotropic(MODULUS, 0.3), 0.0);
    section.plies = vec![
        Ply {
            material: 0,
            thickness_mm: ARM_MM,
            angle_deg: 0.0,
            in_plane_angle_deg: 0.0,
        };
        2
    ];
    let layout = section
        .layout_parting(Division::Fitted { cells }, &[], &Default::default())
        .unwrap();
    let grid = layout.grid();
    // a thin row above the face
    assert_eq!([grid.columns(), grid.rows()], [cells[0], cells[1] + 1]);
    let supports = Supports::of_faces(grid, &[(Face::Right, FaceSupport::Clamped)]).unwrap();
    let load_n = vec![0.0; 2 * grid.particles()];
    let [normal, shear] = energy.map(|energy| tough(STRENGTH, energy).unwrap());
    Case {
        supports,
        load_n,
        strengths: vec![UNBREAKABLE],
        options: BreakingOptions::default(),
        between_plies: BetweenPlies {
            interface: Some(InterfaceStrength { normal, shear }),
            open: vec![OpenFace {
                above_ply: 0,
                between_mm: [0.0, notch_mm],
            }],
        },
        layout,
    }
}

/// Moves the middles of both arms' left ends.
fn drive(case: &mut Case, ways: [f64; 2]) {
    let grid = case.layout.grid();
    let heights = [0.5 * ARM_MM, 1.5 * ARM_MM];
    for (way, height) in ways.into_iter().zip(heights) {
        let lines = grid.y_mm().iter().enumerate();
        let nearest = lines.min_by(|a, b| (a.1 - height).abs().total_cmp(&(b.1 - height).abs()));
        let particle = grid.particle(0, nearest.unwrap().0);
        case.supports.hold(grid, particle, 1, way).unwrap();
    }
}

/// Energy per area that the crack between plies took while it grew, from its open faces alone.
fn taken_per_area(events: &[Event]) -> f64 {
    let opened: Vec<&Event> = (events.iter())
        .filter(|event| event.crack_area_mm2 > 0.0)
        .collect();
    let (first, last) = (opened[opened.len() / 4], opened[3 * opened.len() / 4]);
    let area: f64 = events
        .iter()
        .filter(|event| event.number > first.number && event.number <= last.number)
        .map(|event| event.crack_area_mm2)
        .sum();
    (last.dissipated_n_mm - first.dissipated_n_mm) / area
}

/// The process zone is l = E G / f² = 2.2 mm long. Measured, release rate over fracture energy with 36, 48,
/// 72 and 96 columns: 1.327, 1.171, 1.057, 1.002, for cells of l/3.3 to l/8.9. What coarse cells add is that
/// of the double cantilever beam with one breaking row, see there; the thin row adds none of its own.
#[test]
fn plies_peel_apart_at_their_fracture_energy_on_three_grids() {
    let mut found = Vec::new();
    for cells in [[36, 6], [48, 8], [72, 12]] {
        let mut case = two_plies(cells, NOTCH_MM, [ENERGY; 2]);
        drive(&mut case, [-1.0, 1.0]);
        case.options.stop.displacement_mm = Some(0.9);
        let mut breaking = case.breaking();
        let (events, reason) = broken(&mut breaking);
        assert_eq!(reason, EndReason::Displacement);
        let is_face = |event: &Event| event.part == BrokenPart::PlyFace(0);
        assert!(events.iter().all(is_face));
        let rates: Vec<f64> = events
            .iter()
            .map(release_rate)
            .filter(|[length, _]| (13.0..19.0).contains(length))
            .map(|[_, rate]| rate / ENERGY)
            .collect();
        let mean = rates.iter().sum::<f64>() / rates.len() as f64;
        let totals = breaking.totals();
        let taken = taken_per_area(&events) / ENERGY;
        let zone_mm = MODULUS * ENERGY / STRENGTH.powi(2);
        let coarse = LENGTH_MM / cells[0] as f64 / zone_mm;
        assert!((mean - 1.0).abs() < 1.2 * coarse, "{cells:?} {mean}");
        assert!(
            (mean / taken - 1.0).abs() < 0.05,
            "{cells:?} {mean} {taken}"
        );
        assert!(imbalance(&events) < BALANCE, "{}", imbalance(&events));
        let between = totals.dissipated.ply_faces_n_mm / totals.dissipated.total_n_mm();
        assert!((between - 1.0).abs() < 1e-12);
        assert!(totals.overlap_share < 0.01, "{}", totals.overlap_share);
        found.push(mean);
    }
    // nearer with every grid
    assert!(
        found
            .windows(2)
            .all(|pair| (pair[1] - 1.0).abs() < (pair[0] - 1.0).abs())
    );
}

/// Energy release rate [N/mm] of an end-loaded split, G = 9 P² a² / (4 E b² h³) with the load P on both
/// arms of height h [Williams1989], and the length of the crack by its compliance, (3 a³ + L³) / (2 E b h³)
/// and shear L / (κ G b 2 h).
fn split_rate(event: &Event) -> [f64; 2] {
    let (load, way) = (event.force_n, event.displacement_mm);
    let shear = LENGTH_MM / (5.0 / 6.0 * MODULUS / 2.6 * 2.0 * ARM_MM);
    let bending = 2.0 * MODULUS * ARM_MM.powi(3);
    let cube = ((way / load - shear) * bending - LENGTH_MM.powi(3)) / 3.0;
    let length = cube.max(0.0).cbrt();
    [
        length,
        9.0 * (load * length).powi(2) / (4.0 * MODULUS * ARM_MM.powi(3)),
    ]
}

/// Ten teeth know the energy within [`Totals::saw_error`]; what the crack took for its area is known, and
/// is the rate at which the beams release it. Measured on 48, 72 and 96 columns: taken 0.94, 0.89, 0.91 of
/// the fracture energy, released 0.91, 0.89, 0.85.
#[test]
fn plies_slide_apart_at_their_fracture_energy_on_three_grids() {
    // in shear the process zone is shorter than in tension by G/E: the tougher face makes it as long
    let energy = 2.6 * ENERGY;
    let mut found = Vec::new();
    for cells in [[36, 6], [48, 8], [72, 12]] {
        let mut case = two_plies(cells, 14.0, [ENERGY, energy]);
        drive(&mut case, [-1.0, -1.0]);
        case.options.stop.displacement_mm = Some(1.4);
        let mut breaking = case.breaking();
        let (events, _) = broken(&mut breaking);
        assert!(events.iter().all(|event| event.mode == Mode::Shear));
        let rates: Vec<f64> = (events.iter().map(split_rate))
            .filter(|[length, _]| (17.0..20.0).contains(length))
            .map(|[_, rate]| rate / energy)
            .collect();
        let mean = rates.iter().sum::<f64>() / rates.len() as f64;
        let totals = breaking.totals();
        let taken = taken_per_area(&events) / energy;
        assert!((taken - 1.0).abs() < totals.saw_error, "{cells:?} {taken}");
        assert!(
            (mean / taken - 1.0).abs() < 0.08,
            "{cells:?} {mean} {taken}"
        );
        assert!(imbalance(&events) < BALANCE, "{}", imbalance(&events));
        found.push(mean);
    }
    let (low, high) = (found.iter()).fold((f64::INFINITY, 0.0_f64), |(low, high), &rate| {
        (low.min(rate), high.max(rate))
    });
    assert!(high / low < 1.1, "{found:?}");
}

#[test]
fn a_notch_makes_the_arms_as_soft_as_beams_that_are_not_joined() {
    // before anything breaks: 2 (a³/(3 E I) + a/(κ G A)) for the opening, root rotation left out
    let mut case = two_plies([96, 16], NOTCH_MM, [ENERGY; 2]);
    drive(&mut case, [-1.0, 1.0]);
    let mut breaking = case.breaking();
    let Advance::Broke(event) = breaking.advance().unwrap() else {
        panic!("it breaks");
    };
    let [length, _] = release_rate(&event);
    // the root turns as if the arms were longer by about 0.64 of their height [Williams1989]
    let root = (length - NOTCH_MM) / ARM_MM;
    assert!((0.4..0.9).contains(&root), "{root}");
}

#[test]
fn faces_that_are_none_are_refused() {
    let mut case = two_plies([24, 4], NOTCH_MM, [ENERGY; 2]);
    drive(&mut case, [-1.0, 1.0]);
    let mut open = case.between_plies.open[0];
    open.above_ply = 1;
    case.between_plies.open = vec![open];
    assert!(case.refused().contains("ply beneath"));
    open.above_ply = 0;
    open.between_mm = [3.1, 3.2];
    case.between_plies.open = vec![open];
    assert!(case.refused().contains("at least a cell"));
    case.between_plies.interface = None;
    assert!(case.refused().contains("ply beneath"));
}

/// End-notched flexure: three-point bending of a beam with a notch over one support, whose arms lie on each
/// other and slide. G = 9 P² a² / (16 E b² h³) [Williams1989], h the height of an arm.
#[test]
fn notched_plies_on_rollers_press_on_each_other_and_slide_apart() {
    use crate::flexure::{Drive, Flexure, Loading};
    use crate::solve::StaticOptions;
    let (arm, length, span, notch) = (1.5, 44.0, 40.0, 14.0);
    let (modulus, strength, energy) = (MODULUS, 40.0, 0.5);
    let mut section = plain([length, 2.0 * arm], isotropic(modulus, 0.3), 0.0);
    let ply = Ply {
        material: 0,
        thickness_mm: arm,
        angle_deg: 0.0,
        in_plane_angle_deg: 0.0,
    };
    section.plies = vec![ply; 2];
    let mut found = Vec::new();
    for cells in [[66, 6], [88, 8], [110, 10]] {
        let layout = section
            .layout_parting(Division::Fitted { cells }, &[], &Default::default())
            .unwrap();
        let strengths = [UNBREAKABLE];
        let limit = tough(strength, energy).unwrap();
        let between_plies = BetweenPlies {
            interface: Some(InterfaceStrength {
                normal: limit,
                shear: limit,
            }),
            open: vec![OpenFace {
                above_ply: 0,
                between_mm: [0.0, 2.0 + notch],
            }],
        };
        let options = BreakingOptions {
            // where the crack comes near the roller in the middle
            stop: Stop {
                displacement_mm: Some(1.25),
                ..Stop::default()
            },
            ..BreakingOptions::default()
        };
        let lattice = opened_lattice(&layout, &strengths, &between_plies, &options).unwrap();
        let flexure = Flexure {
            loading: Loading::ThreePoint,
            span_mm: span,
            loading_radius_mm: 3.0,
            support_radius_mm: 3.0,
        };
        let given = Drive::Force(1.0);
        let bent = flexure
            .bend(&section, &lattice, given, &StaticOptions::default())
            .unwrap();
        // C = (2 L³ + 3 a³)/(8 E b h³) + shear, with L half of the span: softer than the whole beam
        let half = 0.5 * span;
        let shear = span / (4.0 * 5.0 / 6.0 * modulus / 2.6 * 2.0 * arm);
        let compliance =
            |a: f64| (2.0 * half.powi(3) + 3.0 * a.powi(3)) / (8.0 * modulus * arm.powi(3)) + shear;
        let ratio = bent.roller_deflection_mm / compliance(notch);
        let grid = layout.grid();
        let (kept, load_n) = flexure.kept(&section, &lattice).unwrap();
        let mut load_n = load_n;
        for face in [Face::Bottom, Face::Top] {
            for line in 0..=grid.columns() {
                let place = 2 * face.particle(grid, line) + 1;
                load_n[place] = bent.contact.equilibrium.reactions_n[place];
            }
        }
        let (resting, pressing) = flexure.rollers(&section);
        let pressed = Pressed {
            resting: resting.to_vec(),
            pressing,
            force_n: 1.0,
            kept: kept.clone(),
        };
        let mut supports = kept;
        for column in [0, grid.columns()] {
            let particle = grid.particle(column, grid.rows() / 4);
            supports.hold(grid, particle, 1, 0.0).unwrap();
        }
        let specimen = Specimen {
            layout: &layout,
            supports: &supports,
            load_n: &load_n,
            strengths: &strengths,
            between_plies: &between_plies,
            rollers: Some(&pressed),
        };
        let mut breaking = Breaking::new(specimen, options).unwrap();
        let (events, _) = broken(&mut breaking);
        let totals = breaking.totals();
        // the crack's length by the compliance as it is measured: of the whole beam with this notch
        let rates: Vec<f64> = (events.iter())
            .map(|event| {
                let measured = event.displacement_mm / event.force_n / ratio - shear;
                let cube = (8.0 * modulus * arm.powi(3) * measured - 2.0 * half.powi(3)) / 3.0;
                let a = cube.max(0.0).cbrt();
                (
                    a,
                    9.0 * (event.force_n * a).powi(2) / (16.0 * modulus * arm.powi(3)),
                )
            })
            .filter(|(a, _)| (notch + 1.5..18.0).contains(a))
            .map(|(_, rate)| rate / energy)
            .collect();
        let mean = rates.iter().sum::<f64>() / rates.len() as f64;
        assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
        assert!((mean - 1.0).abs() < totals.saw_error, "{mean}");
        let shear = totals.dissipated.shear_n_mm / totals.dissipated.total_n_mm();
        assert!(shear > 0.99, "{shear}");
        found.push(mean);
    }
    let (low, high) = (found.iter()).fold((f64::INFINITY, 0.0_f64), |(low, high), &rate| {
        (low.min(rate), high.max(rate))
    });
    assert!(high / low < 1.1, "{found:?}");
}
