//! Rollers on sections that break.
use super::*;
use crate::flexure::{Drive, Flexure, Loading};
use crate::lattice::Lattice;
use crate::section::Refinement;
use crate::solve::{PressedRoller, StaticOptions, pressed_equilibrium};
use crate::tests::{isotropic, plain};

/// A short beam in three- or four-point bending on a grid that is fine at the rollers.
struct Bent {
    case: Case,
    pressed: Pressed,
    flexure: Flexure,
    section: Section,
}

fn bent(loading: Loading, force_n: f64, energy: f64) -> Bent {
    let section = plain([44.0, 4.0], isotropic(3_000.0, 0.3), 0.0);
    let flexure = Flexure {
        loading,
        span_mm: 36.0,
        loading_radius_mm: 3.0,
        support_radius_mm: 3.0,
    };
    let refinements: Vec<Refinement> = flexure.refinements(&section, 60.0, 1).unwrap();
    let graded = Division::Graded {
        cells: [22, 4],
        across: 1,
    };
    let layout = section
        .layout_refined(graded, &refinements, &Default::default())
        .unwrap();
    let lattice = Lattice::exact(&layout);
    let grid = layout.grid();
    let options = StaticOptions::default();
    let found = flexure
        .bend(&section, &lattice, Drive::Force(force_n), &options)
        .unwrap();
    let (kept, _) = flexure.kept(&section, &lattice).unwrap();
    let (resting, pressing) = flexure.rollers(&section);
    let mut load_n = vec![0.0; lattice.displacements()];
    for face in [Face::Bottom, Face::Top] {
        for line in 0..=grid.columns() {
            let place = 2 * face.particle(grid, line) + 1;
            load_n[place] = found.contact.equilibrium.reactions_n[place];
        }
    }
    let mut supports = kept.clone();
    for column in [0, grid.columns()] {
        supports
            .hold(grid, grid.particle(column, grid.rows() / 2), 1, 0.0)
            .unwrap();
    }
    let mut options = BreakingOptions::default();
    options.stop.force_fraction = 0.3;
    Bent {
        pressed: Pressed {
            resting: resting.to_vec(),
            pressing,
            force_n,
            kept,
        },
        case: Case {
            layout,
            supports,
            load_n,
            strengths: vec![in_tension(tough(40.0, energy))],
            options,
            between_plies: BetweenPlies::default(),
        },
        flexure,
        section,
    }
}

impl Bent {
    fn breaking(&self) -> Breaking {
        let specimen = Specimen {
            rollers: Some(&self.pressed),
            ..self.case.specimen()
        };
        Breaking::new(specimen, self.case.options).unwrap()
    }
}

#[test]
fn the_force_on_rollers_with_wide_contacts_is_the_whole_force() {
    for loading in [Loading::ThreePoint, Loading::FourPoint] {
        let bent = bent(loading, 5.0, 0.6);
        let mut breaking = bent.breaking();
        let Advance::Broke(event) = breaking.advance().unwrap() else {
            panic!("it breaks");
        };
        // the first crack is where and when the stress of the whole section reaches the strength
        let lattice = Lattice::exact(&bent.case.layout);
        let options = StaticOptions::default();
        let drive = Drive::Force(event.force_n);
        let whole = (bent.flexure)
            .bend(&bent.section, &lattice, drive, &options)
            .unwrap();
        let stress = lattice
            .stress(
                Geometry::Linear,
                event.cell,
                &whole.contact.equilibrium.displacements_mm,
            )
            .unwrap();
        assert!(
            (stress[0] / 40.0 - 1.0).abs() < 5e-3,
            "{loading:?} {stress:?} {event:?}"
        );
        // the drive's way is that of the faces under the rollers; rollers go further by the gaps of what
        // touches, d²/(2R) on average
        let rollers = bent.flexure.rollers(&bent.section);
        let rollers = rollers.0.into_iter().chain(rollers.1);
        let gaps: f64 = (whole.contact.rollers.iter().zip(rollers))
            .map(|(contact, roller)| {
                let off = contact.centre_mm - roller.at_mm;
                let square = 0.25 * contact.half_width_mm.powi(2) + off * off;
                contact.force_n / event.force_n * square / (2.0 * roller.radius_mm)
            })
            .sum();
        let missed = whole.roller_deflection_mm - gaps - event.displacement_mm;
        assert!(
            missed.abs() < 5e-3 * whole.roller_deflection_mm,
            "{missed} {gaps} {}",
            whole.roller_deflection_mm
        );
    }
}

#[test]
fn contact_stays_in_equilibrium_with_the_broken_section() {
    // given at less than a tenth of the peak, where contacts are a third as wide
    for loading in [Loading::ThreePoint, Loading::FourPoint] {
        let bent = bent(loading, 1.0, 0.6);
        let mut breaking = bent.breaking();
        let (events, reason) = broken(&mut breaking);
        assert_eq!(reason, EndReason::ForceFell);
        let totals = breaking.totals();
        assert!(
            totals.contacts > 1 && totals.contacts_kept == 0,
            "{totals:?}"
        );
        // forces on particles are those of the contact of the broken section at that force
        let last = events.last().unwrap();
        let resting: Vec<PressedRoller> = (bent.pressed.resting.iter())
            .map(|&roller| PressedRoller {
                roller,
                advance_mm: 0.0,
            })
            .collect();
        let still = vec![0.0; bent.case.load_n.len()];
        let found = pressed_equilibrium(
            &breaking.system.lattice,
            &bent.pressed.kept,
            &still,
            &resting,
            &bent.pressed.pressing,
            last.factor * bent.pressed.force_n,
            &StaticOptions::default(),
        )
        .unwrap();
        let count = bent.pressed.resting.len() + bent.pressed.pressing.len();
        let (mut forces, mut moments) = (vec![[0.0; 2]; count], vec![[0.0; 2]; count]);
        let rollers: Vec<_> = (bent.pressed.resting.iter())
            .chain(&bent.pressed.pressing)
            .copied()
            .collect();
        let points =
            crate::solve::points(bent.case.layout.grid(), &bent.pressed.kept, &rollers).unwrap();
        for point in points {
            let place = point.displacement;
            let here = [
                last.factor * breaking.system.load[place],
                found.equilibrium.reactions_n[place],
            ];
            for (way, force) in here.into_iter().enumerate() {
                forces[point.roller][way] += point.inward * force;
                moments[point.roller][way] += point.inward * force * point.at_mm;
            }
        }
        for (force, moment) in forces.iter().zip(&moments) {
            assert!(
                (force[0] - force[1]).abs() < 0.02 * last.force_n,
                "{forces:?}"
            );
            // a roller may have lost the section: one over a crack, of two that stay level
            if force[1] > 0.1 * last.force_n {
                let at = [0, 1].map(|way| moment[way] / force[way]);
                assert!((at[0] - at[1]).abs() < 0.1, "{at:?}");
            }
        }
    }
}

#[test]
fn a_state_with_rollers_goes_on_with_the_same_bytes() {
    let bent = bent(Loading::ThreePoint, 1.0, 0.6);
    let mut whole = bent.breaking();
    let (events, _) = broken(&mut whole);
    let mut first = bent.breaking();
    for _ in 0..events.len() / 2 {
        first.advance().unwrap();
    }
    let state = first.state();
    assert!(first.totals().contacts > 0);
    let mut second = bent.breaking();
    second.resume(state).unwrap();
    let (rest, _) = broken(&mut second);
    assert_eq!(rest, events[events.len() / 2..]);
    assert_eq!(second.totals(), whole.totals());
}
