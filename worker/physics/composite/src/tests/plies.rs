//! Stacks of plies against classical laminate theory.
use super::sections::{forces, plain};
use crate::flexure::Beam;
use crate::lattice::{BondPattern, BondStiffness, Lattice, PaperRule};
use crate::load::LoadPlace;
use crate::material::{Material, Orthotropic};
use crate::measure::{face_force_n, point_mm};
use crate::section::{Division, Ply, Section};
use crate::solve::{StaticOptions, equilibrium};
use crate::supports::{Face, FaceSupport, Supports};

/// A ply of carbon fibre and epoxy.
pub(crate) const CARBON: Material = Material::Orthotropic(Orthotropic {
    modulus_1_mpa: 140_000.0,
    modulus_2_mpa: 10_000.0,
    poisson_ratio_12: 0.30,
    shear_modulus_12_mpa: Some(5_000.0),
    modulus_3_mpa: Some(10_000.0),
    poisson_ratio_13: Some(0.30),
    poisson_ratio_23: Some(0.45),
    shear_modulus_13_mpa: Some(5_000.0),
    shear_modulus_23_mpa: Some(3_400.0),
});

/// Plies of equal thickness at the given angles, from the bottom.
pub(crate) fn stacked(length_mm: f64, height_mm: f64, angles_deg: &[f64]) -> Section {
    let mut section = plain([length_mm, height_mm], CARBON, 0.0);
    section.plies = angles_deg
        .iter()
        .map(|&angle_deg| Ply {
            material: 0,
            thickness_mm: height_mm / angles_deg.len() as f64,
            angle_deg,
            in_plane_angle_deg: 0.0,
        })
        .collect();
    section
}

#[test]
fn a_cross_ply_stretches_and_bends_as_laminate_theory_says() {
    let (length, height) = (80.0, 2.0);
    let section = stacked(length, height, &[0.0, 90.0, 90.0, 0.0]);
    let beam = Beam::of(&section).unwrap().unwrap();
    // By hand: A₁₁ and D₁₁ of moduli 140 000 in the outer quarters and 10 000 inside.
    assert!((beam.axial_n / (75_000.0 * height) - 1.0).abs() < 1e-12);
    let third = height.powi(3) / 12.0;
    let bending = (140_000.0 * (1.0 - 0.125) + 10_000.0 * 0.125) * third;
    assert!((beam.bending_n_mm2 / bending - 1.0).abs() < 1e-12);

    let graded = Division::Graded {
        cells: [160, 8],
        across: 2,
    };
    let lattice = Lattice::exact(&section.layout(graded).unwrap());
    let grid = lattice.grid();
    // Pulled by its ends, which stay straight: layers share the strain along them and none presses
    // on another, so that the lattice is exact.
    let mut supports = Supports::of_faces(
        grid,
        &[
            (Face::Left, FaceSupport::Rolling),
            (
                Face::Right,
                FaceSupport::PerAxis([Some(1e-4 * length), None]),
            ),
        ],
    )
    .unwrap();
    supports.hold(grid, grid.particle(0, 0), 1, 0.0).unwrap();
    let load = vec![0.0; lattice.displacements()];
    let rest = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
    let force = face_force_n(grid, Face::Right, &rest.reactions_n)[0];
    assert!(
        (force / (1e-4 * beam.axial_n) - 1.0).abs() < 1e-9,
        "{force}"
    );

    // A cantilever: bending and shear.
    let load = forces(&lattice, [0.0, -1.0], LoadPlace::Face(Face::Right));
    let supports = Supports::of_faces(grid, &[(Face::Left, FaceSupport::Clamped)]).unwrap();
    let rest = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
    let tip = point_mm(grid, [length, height / 2.0], &rest.displacements_mm).unwrap()[1];
    let expected = -length.powi(3) / (3.0 * beam.bending_n_mm2) - length / beam.shear_n;
    assert!((tip / expected - 1.0).abs() < 3e-3, "{tip} {expected}");
}

#[test]
fn homogenised_rows_of_a_laminate_stretch_alike() {
    // Two plies in every cell: their average carries the same force.
    let section = stacked(20.0, 2.0, &[0.0, 90.0, 90.0, 0.0]);
    let force = |division| {
        let lattice = Lattice::exact(&section.layout(division).unwrap());
        let grid = lattice.grid();
        let mut supports = Supports::of_faces(
            grid,
            &[
                (Face::Left, FaceSupport::Rolling),
                (Face::Right, FaceSupport::PerAxis([Some(2e-3), None])),
            ],
        )
        .unwrap();
        supports.hold(grid, grid.particle(0, 0), 1, 0.0).unwrap();
        let load = vec![0.0; lattice.displacements()];
        let rest = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
        face_force_n(grid, Face::Right, &rest.reactions_n)[0]
    };
    let graded = force(Division::Graded {
        cells: [40, 8],
        across: 2,
    });
    let uniform = force(Division::Uniform { cells: [40, 2] });
    assert!((uniform / graded - 1.0).abs() < 1e-9, "{uniform} {graded}");
}

#[test]
fn the_papers_lattice_has_no_plies() {
    let section = stacked(4.0, 2.0, &[0.0, 90.0]);
    let layout = section.layout(Division::Uniform { cells: [4, 2] }).unwrap();
    let rule = PaperRule {
        stiffness: BondStiffness::PWave,
        pattern: BondPattern::Cross,
    };
    let error = Lattice::paper(&section, &layout, rule).unwrap_err();
    assert!(error.to_string().contains("plies"), "{error}");
}
