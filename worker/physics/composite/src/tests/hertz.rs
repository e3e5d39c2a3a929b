//! Rollers against Hertz's contact.
use super::contact::roller;
use super::plies::CARBON;
use super::sections::{isotropic, plain};

use crate::lattice::Lattice;
use crate::material::PlaneState;
use crate::section::{Division, Refinement};
use crate::solve::{ContactEquilibrium, StaticOptions, pressed_equilibrium};
use crate::supports::{Face, FaceSupport, Supports};
use loadframe_api::section::contact::hertz_half_width_mm;

/// A block on a clamped base, pressed from above in the middle, with cells of a size there.
fn indented(state: PlaneState, force_n: f64, cell_mm: f64) -> ContactEquilibrium {
    let mut section = plain([24.0, 12.0], isotropic(1_000.0, 0.3), 0.0);
    section.state = state;
    let refinement = Refinement {
        at_mm: [12.0, 12.0],
        half_width_mm: 0.3,
        cell_mm,
    };
    let graded = Division::Graded {
        cells: [12, 6],
        across: 1,
    };
    let lattice = Lattice::exact(
        &section
            .layout_refined(graded, &[refinement], &Default::default())
            .unwrap(),
    );
    let supports =
        Supports::of_faces(lattice.grid(), &[(Face::Bottom, FaceSupport::Clamped)]).unwrap();
    let load = vec![0.0; lattice.displacements()];
    pressed_equilibrium(
        &lattice,
        &supports,
        &load,
        &[],
        &[roller(Face::Top, 12.0, 5.0)],
        force_n,
        &StaticOptions::default(),
    )
    .unwrap()
}

#[test]
fn a_pressed_cylinder_touches_as_wide_as_hertz_says() {
    // b² = 4 F R / (π E*), [Johnson1985] (4.43), for a rigid cylinder on a half-space: the block is
    // sixty times as deep as b.
    let (force, radius) = (6.0, 5.0);
    for (state, modulus) in [
        (PlaneState::Stress, 1_000.0),
        (PlaneState::Strain, 1_000.0 / (1.0 - 0.09)),
    ] {
        let hertz = (4.0 * force * radius / (std::f64::consts::PI * modulus)).sqrt();
        let found = indented(state, force, 0.02);
        let contact = found.rollers[0];
        assert!((contact.force_n / force - 1.0).abs() < 1e-9);
        assert!((contact.centre_mm - 12.0).abs() < 1e-9);
        assert!(
            (contact.half_width_mm / hertz - 1.0).abs() < 0.03,
            "{contact:?} {hertz}"
        );
        let [from, to] = contact.between_mm.unwrap();
        // The last particles that touch lie within a cell of the edge.
        assert!((0.5 * (to - from) - hertz).abs() < 0.02, "{contact:?}");
        assert!(contact.particles > 12);
        assert!(found.equilibrium.residual < 1e-9);
    }
}

#[test]
fn on_fibres_along_and_across_the_face_hertz_holds_with_lekhnitskiis_modulus() {
    for angle_deg in [0.0, 90.0] {
        let section = plain([40.0, 20.0], CARBON, angle_deg);
        let lattice_of = |refinements: &[Refinement]| {
            let graded = Division::Graded {
                cells: [20, 10],
                across: 1,
            };
            section
                .layout_refined(graded, refinements, &Default::default())
                .unwrap()
        };
        let (force, radius) = (500.0, 5.0);
        let stiffness = lattice_of(&[]).stiffness()[0];
        let hertz = hertz_half_width_mm(&stiffness, 1.0, radius, force);
        let lattice = Lattice::exact(&lattice_of(&[Refinement {
            at_mm: [20.0, 20.0],
            half_width_mm: 1.3 * hertz,
            cell_mm: hertz / 12.0,
        }]));
        let supports =
            Supports::of_faces(lattice.grid(), &[(Face::Bottom, FaceSupport::Clamped)]).unwrap();
        let found = pressed_equilibrium(
            &lattice,
            &supports,
            &vec![0.0; lattice.displacements()],
            &[],
            &[roller(Face::Top, 20.0, radius)],
            force,
            &StaticOptions::default(),
        )
        .unwrap();
        let width = found.rollers[0].half_width_mm;
        assert!(
            (width / hertz - 1.0).abs() < 0.03,
            "{angle_deg} {width} {hertz}"
        );
    }
    // Isotropic it is the formula of plane stress.
    let same = isotropic(1_000.0, 0.3)
        .stiffness(PlaneState::Stress)
        .unwrap()
        .0;
    let expected = (4.0 * 6.0 * 5.0 / (std::f64::consts::PI * 1_000.0 * 2.0)).sqrt();
    assert!((hertz_half_width_mm(&same, 2.0, 5.0, 6.0) / expected - 1.0).abs() < 1e-12);
}

#[test]
fn an_indentation_does_not_depend_on_the_grid() {
    let advances: Vec<f64> = [0.08, 0.04, 0.02]
        .iter()
        .map(|&cell| indented(PlaneState::Stress, 6.0, cell).rollers[0].advance_mm)
        .collect();
    let finest = advances[2];
    assert!((advances[1] / finest - 1.0).abs() < 3e-3, "{advances:?}");
    assert!((advances[0] / finest - 1.0).abs() < 1e-2, "{advances:?}");
    // It grows nearly as the force: by the logarithm of Hertz's width a little less.
    let double = indented(PlaneState::Stress, 12.0, 0.04).rollers[0].advance_mm;
    let ratio = double / advances[1];
    assert!((1.8..2.0).contains(&ratio), "{ratio}");
}
