//! Sections the tests share.
use crate::lattice::Lattice;
use crate::load::{Load, LoadPlace};
use crate::material::{Material, Orthotropic, PlaneState};
use crate::section::{Division, Fibre, Section, Substance};
use crate::solve::{Equilibrium, StaticOptions, equilibrium};
use crate::supports::{Face, FaceSupport, Supports};

pub(crate) fn isotropic(youngs_modulus_mpa: f64, poisson_ratio: f64) -> Material {
    Material::Isotropic {
        youngs_modulus_mpa,
        poisson_ratio,
    }
}

pub(crate) fn orthotropic(e1: f64, e2: f64, nu12: f64, g12: Option<f64>) -> Material {
    Material::Orthotropic(Orthotropic {
        modulus_1_mpa: e1,
        modulus_2_mpa: e2,
        poisson_ratio_12: nu12,
        shear_modulus_12_mpa: g12,
        modulus_3_mpa: None,
        poisson_ratio_13: None,
        poisson_ratio_23: None,
        shear_modulus_13_mpa: None,
        shear_modulus_23_mpa: None,
    })
}

/// A section of one material, turned.
pub(crate) fn plain(sides: [f64; 2], material: Material, angle_deg: f64) -> Section {
    Section {
        length_mm: sides[0],
        height_mm: sides[1],
        thickness_mm: 1.0,
        state: PlaneState::Stress,
        materials: vec![Substance {
            material,
            density_kg_per_m3: 1_200.0,
        }],
        matrix: 0,
        matrix_angle_deg: angle_deg,
        plies: Vec::new(),
        fibres: Vec::new(),
    }
}

/// The paper's section: fibres of 0.7 mm every 15 mm in a filler of 70 mm by 70 mm.
pub(crate) fn papers(angle_deg: f64) -> Section {
    let mut section = plain([70.0, 70.0], isotropic(85.0, 0.3), 0.0);
    section.materials.push(Substance {
        material: orthotropic(11_500.0, 6_430.0, 0.28, None),
        density_kg_per_m3: 1_800.0,
    });
    section.fibres = (0..5)
        .map(|place| {
            let at = 5.0 + 15.0 * f64::from(place);
            Fibre {
                material: 1,
                through_mm: if angle_deg == 0.0 {
                    [35.0, at]
                } else {
                    [at, 35.0]
                },
                angle_deg,
                thickness_mm: 0.7,
                length_mm: None,
            }
        })
        .collect();
    section
}

pub(crate) fn uniform(section: &Section, cells: [usize; 2]) -> Lattice {
    Lattice::exact(&section.layout(Division::Uniform { cells }).unwrap())
}

pub(crate) fn clamped_sides(lattice: &Lattice) -> Supports {
    Supports::of_faces(
        lattice.grid(),
        &[
            (Face::Left, FaceSupport::Clamped),
            (Face::Right, FaceSupport::Clamped),
        ],
    )
    .unwrap()
}

pub(crate) fn forces(lattice: &Lattice, force_n: [f64; 2], on: LoadPlace) -> Vec<f64> {
    let mut forces = vec![0.0; lattice.displacements()];
    Load { force_n, on }.add_to(lattice, &mut forces).unwrap();
    forces
}

/// The paper's test: sides clamped, a force on top.
pub(crate) fn pressed(lattice: &Lattice, options: &StaticOptions) -> Equilibrium {
    let load = forces(lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
    equilibrium(lattice, &clamped_sides(lattice), &load, options).unwrap()
}
